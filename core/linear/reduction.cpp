#include "core/linear/reduction.hpp"

#include <limits>
#include <string>

#include "core/linear/parallel.hpp"
#include "core/math/at.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

/// One round of a 64-bit multiply-and-shift mixer (constants of SplitMix64, Steele et al. 2014).
std::uint64_t mix(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0xbf58476d1ce4e5b9ull;
  return hash ^ (hash >> 29);
}

std::uint64_t hash_indices(std::uint64_t hash, const int* data, std::size_t n) {
  hash = mix(hash, n);
  for (std::size_t i = 0; i + 1 < n; i += 2) {
    hash = mix(hash, static_cast<std::uint64_t>(data[i]) << 32 | static_cast<std::uint32_t>(data[i + 1]));
  }
  return n % 2 ? mix(hash, static_cast<std::uint64_t>(data[n - 1])) : hash;
}

}  // namespace

Reduction::Reduction(int n_vertices, const std::vector<std::uint8_t>& fixed) {
  if (n_vertices < 0 || fixed.size() != 3 * at(n_vertices)) {
    throw ConfigError("BlockSystem fixed", std::to_string(fixed.size()) + " flags",
                      "3 * " + std::to_string(n_vertices));
  }
  dof_.resize(fixed.size() + 1);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    dof_[i] = n_free();
    if (!fixed[i]) free_.push_back(static_cast<int>(i));
  }
  dof_.back() = n_free();
  system_.block_start.push_back(0);
  for (int v = 0; v < n_vertices; ++v) {
    if (n_free_of(v) == 0) continue;
    system_.block_start.push_back(dof_[3 * at(v) + 3]);
    system_.block_vertex.push_back(v);
  }
  system_.lower.resize(n_free(), n_free());
}

int Reduction::n_free_of(int vertex) const { return dof_[3 * at(vertex) + 3] - dof_[3 * at(vertex)]; }

void Reduction::build(const BlockPattern& pattern) {
  if (pattern.row.size() > at(std::numeric_limits<int>::max()) / 9) {
    throw ConfigError("BlockSystem", std::to_string(pattern.row.size()) + " blocks", "2^31 / 9");
  }
  const int n_vertices = pattern.n_vertices();
  auto& lower = system_.lower;
  int* outer = lower.outerIndexPtr();
  parallel_items(n_vertices, 512, [&](int v) {
    int below = 0;
    for (int b = pattern.column_start[at(v)] + 1; b < pattern.column_start[at(v) + 1]; ++b) {
      below += n_free_of(pattern.row[at(b)]);
    }
    const int begin = dof_[3 * at(v)], end = dof_[3 * at(v) + 3];
    for (int j = begin; j < end; ++j) outer[j + 1] = below + (end - j);
  });
  outer[0] = 0;
  for (int j = 0; j < n_free(); ++j) outer[j + 1] += outer[j];
  const int n_nonzeros = outer[n_free()];
  lower.data().resize(n_nonzeros, 0.5);
  map_.resize(at(n_nonzeros));
  int* inner = lower.innerIndexPtr();
  parallel_items(n_vertices, 512, [&](int v) {
    const int begin = dof_[3 * at(v)], end = dof_[3 * at(v) + 3];
    for (int j = begin; j < end; ++j) {
      int k = outer[j];
      for (int b = pattern.column_start[at(v)]; b < pattern.column_start[at(v) + 1]; ++b) {
        const int u = pattern.row[at(b)];
        for (int i = u == v ? j : dof_[3 * at(u)]; i < dof_[3 * at(u) + 3]; ++i, ++k) {
          inner[k] = i;
          map_[at(k)] = 9 * b + 3 * (free_[at(j)] - 3 * v) + (free_[at(i)] - 3 * u);
        }
      }
    }
  });
  std::uint64_t hash = hash_indices(0x9e3779b97f4a7c15ull, outer, at(n_free()) + 1);
  hash = hash_indices(hash, inner, at(n_nonzeros));
  system_.pattern_id = hash == 0 ? 1 : hash;  // 0 is kept for "unknown"
}

void Reduction::set_mesh(const BlockPattern& elements, const PositionsView& x) {
  const std::vector<int>& vertices = system_.block_vertex;
  std::vector<int> block_of(at(elements.n_vertices()), -1);
  for (std::size_t b = 0; b < vertices.size(); ++b) block_of[at(vertices[b])] = static_cast<int>(b);
  std::vector<std::vector<int>> joined(vertices.size());
  for (int v = 0; v < elements.n_vertices(); ++v) {
    for (int k = elements.column_start[at(v)] + 1; k < elements.column_start[at(v) + 1]; ++k) {
      const int a = block_of[at(v)], b = block_of[at(elements.row[at(k)])];
      if (a < 0 || b < 0) continue;
      joined[at(a)].push_back(b);
      joined[at(b)].push_back(a);  // ascending: columns come in order, and rows below their column
    }
  }
  auto mesh = std::make_shared<BlockMesh>();
  mesh->row_start.push_back(0);
  for (std::size_t b = 0; b < vertices.size(); ++b) {
    mesh->point.push_back(x.col(vertices[b]));
    mesh->neighbour.insert(mesh->neighbour.end(), joined[b].begin(), joined[b].end());
    mesh->row_start.push_back(static_cast<int>(mesh->neighbour.size()));
  }
  system_.mesh = std::move(mesh);
}

const ReducedSystem& Reduction::fill(const std::vector<double>& values) {
  double* out = system_.lower.valuePtr();
  parallel_items(static_cast<int>(map_.size()), 16384, [&](int k) { out[k] = values[at(map_[at(k)])]; });
  return system_;
}

void Reduction::restrict_vector(const PositionsView& full, VecXd& reduced) const {
  reduced.resize(n_free());
  for (int i = 0; i < n_free(); ++i) reduced[i] = full.data()[free_[at(i)]];
}

void Reduction::expand_vector(const VecXd& reduced, PositionsSpan full) const {
  for (int i = 0; i < n_free(); ++i) full.data()[free_[at(i)]] = reduced[i];
}

}  // namespace bb
