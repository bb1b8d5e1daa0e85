#include "core/linear/node_blocks.hpp"

#include <metis.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>

#include "core/math/at.hpp"

namespace bb {
namespace {

constexpr int morton_cells = 1024;  // a side, as in GIPC: 10 bits a coordinate

/// Ten bits, each followed by two zeros.
std::uint32_t spread(std::uint32_t v) {
  std::uint32_t out = 0;
  for (unsigned bit = 0; bit < 10; ++bit) out |= (v >> bit & 1u) << 3 * bit;
  return out;
}

struct Cube {
  Vec3d corner = Vec3d::Zero();
  double side = 0;
};

Cube cube_round(std::span<const Vec3d> points) {
  Vec3d low = Vec3d::Constant(HUGE_VAL), high = -low;
  for (const Vec3d& x : points) {
    if (!x.allFinite()) continue;
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  if (low[0] > high[0]) return {};
  return {low, (high - low).maxCoeff()};
}

std::uint32_t morton_code(const Vec3d& x, const Cube& cube) {
  if (!x.allFinite() || !(cube.side > 0)) return 0;
  std::uint32_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = (x[axis] - cube.corner[axis]) / cube.side * morton_cells;
    code |= spread(static_cast<std::uint32_t>(std::clamp(cell, 0.0, morton_cells - 1.0))) << (2 - axis);
  }
  return code;
}

/// Nodes in the order of `member`, cut at `size`.
VertexClusters cut(std::vector<int> member, int size) {
  VertexClusters out;
  out.member = std::move(member);
  out.of.resize(out.member.size());
  out.start.assign(1, 0);
  const int n = static_cast<int>(out.member.size());
  for (int begin = 0; begin < n; begin += size) {
    const int end = std::min(begin + size, n);
    for (int m = begin; m < end; ++m) out.of[at(out.member[at(m)])] = out.size();
    out.start.push_back(end);
  }
  return out;
}

/// Connected components in the order of their first nodes, and the place of a node in its component.
std::vector<std::vector<int>> components(std::span<const int> row_start, std::span<const int> neighbour,
                                         std::vector<int>& place) {
  std::vector<std::vector<int>> out;
  place.assign(row_start.size() - 1, -1);
  for (int seed = 0; seed + 1 < static_cast<int>(row_start.size()); ++seed) {
    if (place[at(seed)] >= 0) continue;
    std::vector<int>& found = out.emplace_back(1, seed);
    place[at(seed)] = 0;
    for (std::size_t next = 0; next < found.size(); ++next) {
      const int v = found[next];
      for (int k = row_start[at(v)]; k < row_start[at(v) + 1]; ++k) {
        const int u = neighbour[at(k)];
        if (place[at(u)] >= 0) continue;
        place[at(u)] = static_cast<int>(found.size());
        found.push_back(u);
      }
    }
  }
  return out;
}

/// The part of every node of a component, by its place.
std::vector<idx_t> parts_of(const std::vector<int>& nodes, const std::vector<int>& place,
                            std::span<const int> row_start, std::span<const int> neighbour, idx_t n_parts) {
  std::vector<idx_t> part(nodes.size(), 0), start(1, 0), list;
  if (n_parts < 2) return part;
  for (const int v : nodes) {
    for (int k = row_start[at(v)]; k < row_start[at(v) + 1]; ++k) list.push_back(place[at(neighbour[at(k)])]);
    start.push_back(static_cast<idx_t>(list.size()));
  }
  idx_t n = static_cast<idx_t>(nodes.size()), n_constraints = 1, cut_edges = 0;
  const int status =
      METIS_PartGraphKway(&n, &n_constraints, start.data(), list.data(), nullptr, nullptr, nullptr, &n_parts,
                          nullptr, nullptr, nullptr, &cut_edges, part.data());
  if (status != METIS_OK) throw std::runtime_error("METIS_PartGraphKway: status " + std::to_string(status));
  return part;
}

}  // namespace

VertexClusters consecutive_blocks(int n, int size) {
  std::vector<int> member(at(n));
  std::iota(member.begin(), member.end(), 0);
  return cut(std::move(member), size);
}

VertexClusters morton_blocks(std::span<const Vec3d> points, int size) {
  const Cube cube = cube_round(points);
  std::vector<std::uint32_t> code;
  for (const Vec3d& x : points) code.push_back(morton_code(x, cube));
  std::vector<int> member(points.size());
  std::iota(member.begin(), member.end(), 0);
  std::stable_sort(member.begin(), member.end(), [&code](int a, int b) { return code[at(a)] < code[at(b)]; });
  return cut(std::move(member), size);
}

VertexClusters partitioned_blocks(std::span<const int> row_start, std::span<const int> neighbour, int size) {
  std::vector<int> place;
  VertexClusters out;
  out.of.resize(row_start.size() - 1);
  out.start.assign(1, 0);
  for (const std::vector<int>& nodes : components(row_start, neighbour, place)) {
    const int n_parts = (static_cast<int>(nodes.size()) + size - 2) / (size - 1);
    const std::vector<idx_t> part = parts_of(nodes, place, row_start, neighbour, n_parts);
    std::vector<std::vector<int>> members(at(n_parts));
    for (std::size_t i = 0; i < nodes.size(); ++i) members[at(part[i])].push_back(nodes[i]);
    for (const std::vector<int>& of_part : members) {
      for (std::size_t m = 0; m < of_part.size(); ++m) {
        if (m > 0 && m % at(size) == 0) out.start.push_back(static_cast<int>(out.member.size()));
        out.of[at(of_part[m])] = out.size();
        out.member.push_back(of_part[m]);
      }
      if (!of_part.empty()) out.start.push_back(static_cast<int>(out.member.size()));
    }
  }
  return out;
}

}  // namespace bb
