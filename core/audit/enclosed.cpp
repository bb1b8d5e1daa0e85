#include "core/audit/enclosed.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <map>
#include <optional>

#include "core/audit/box_tree.hpp"
#include "core/audit/closest_point.hpp"
#include "core/audit/segment_triangle.hpp"
#include "core/math/parallel.hpp"

namespace bb::audit {
namespace {

using Corners = std::array<Vec3d, 3>;

Corners corners_of(const AuditMesh& mesh, int triangle, const Positions& x) {
  const auto v = mesh.triangles.col(triangle);
  return {x.col(v[0]), x.col(v[1]), x.col(v[2])};
}

/// Every edge has an even number of triangles, so that a ray that touches none of them crosses the surface an odd
/// number of times from inside.
bool is_closed(const AuditMesh& mesh, const std::vector<int>& triangles) {
  std::map<std::pair<int, int>, int> sharers;
  for (const int t : triangles) {
    const auto v = mesh.triangles.col(t);
    for (int k = 0; k < 3; ++k) ++sharers[std::minmax(int{v[k]}, int{v[(k + 1) % 3]})];
  }
  return !triangles.empty() &&
         std::all_of(sharers.begin(), sharers.end(), [](const auto& edge) { return edge.second % 2 == 0; });
}

/// Along the axes, where the boxes on the way are few, then skew: of a regular mesh an axis may meet edges.
const std::array<Vec3d, 9>& directions() {
  static const std::array<Vec3d, 9> all{
      Vec3d(0, 0, 1),          Vec3d(1, 0, 0),           Vec3d(0, 1, 0),
      Vec3d(0, 0, -1),         Vec3d(-1, 0, 0),          Vec3d(0, -1, 0),
      Vec3d(0.41, 0.73, 0.55), Vec3d(-0.62, 0.29, 0.73), Vec3d(0.37, -0.83, -0.41)};
  return all;
}

/// The triangles of a body in one state.
class BodyInState {
 public:
  BodyInState(const AuditMesh& mesh, const std::vector<int>& triangles, const Positions& x) {
    std::vector<Box> boxes;
    for (const int t : triangles) {
      corners_.push_back(corners_of(mesh, t, x));
      Box box;
      for (const Vec3d& p : corners_.back()) box.add(p);
      all_.add(box);
      boxes.push_back(box);
    }
    tree_.emplace(std::move(boxes));
  }

  bool may_hold(const Vec3d& p) const {
    Box point;
    point.add(p);
    return all_.meets(point);
  }

  /// Nothing where every direction meets an edge, a corner or the point itself.
  std::optional<bool> holds(const Vec3d& p) const {
    for (const Vec3d& direction : directions()) {
      if (const auto odd = odd_crossings(p, p + direction * (2.0 * (all_.hi - all_.lo).norm()))) return odd;
    }
    return std::nullopt;
  }

  double distance(const Vec3d& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (double reach = std::max((all_.hi - all_.lo).norm(), 1e-12) / 64; least > reach; reach *= 2) {
      Box near;
      near.add(p);
      near.lo.array() -= reach, near.hi.array() += reach;
      tree_->query(near, [&](int t) {
        const Corners& c = corners_[static_cast<std::size_t>(t)];
        least = std::min(least, closest_to_origin(c[0] - p, c[1] - p, c[2] - p).norm());
      });
    }
    return least;
  }

 private:
  std::optional<bool> odd_crossings(const Vec3d& p, const Vec3d& far) const {
    Box way;
    way.add(p), way.add(far);
    bool odd = false, touched = false;
    tree_->query(way, [&](int t) {
      const Corners& c = corners_[static_cast<std::size_t>(t)];
      const Crossing found = segment_triangle(p, far, c[0], c[1], c[2]);
      odd ^= found == Crossing::crossing;
      touched = touched || found == Crossing::touch;
    });
    return touched ? std::nullopt : std::optional(odd);
  }

  std::vector<Corners> corners_;
  Box all_;
  std::optional<BoxTree> tree_;
};

}  // namespace

bool Enclosed::undecides(const Pair& pair) const {
  return std::binary_search(undecided.begin(), undecided.end(), pair);
}

void Enclosed::settle(const Enclosed& before) {
  const auto was_decided = [&before](const Pair& pair) { return !before.undecides(pair); };
  for (const Pair& pair : undecided) {
    if (was_decided(pair) && std::binary_search(before.inside.begin(), before.inside.end(), pair))
      inside.push_back(pair);
  }
  std::sort(inside.begin(), inside.end());
  std::erase_if(undecided, was_decided);
}

std::vector<Enclosed::Pair> changed_sides(const Enclosed& a, const Enclosed& b) {
  std::vector<Enclosed::Pair> out;
  std::set_symmetric_difference(a.inside.begin(), a.inside.end(), b.inside.begin(), b.inside.end(),
                                std::back_inserter(out));
  std::erase_if(out, [&](const auto& pair) { return a.undecides(pair) || b.undecides(pair); });
  return out;
}

ClosedBodies::ClosedBodies(const AuditMesh& mesh, std::vector<int> first_vertex, std::vector<int> vertices)
    : mesh_(mesh), first_vertex_(std::move(first_vertex)), vertices_(std::move(vertices)) {
  if (mesh.planar) return;
  std::vector<std::vector<int>> triangles(first_vertex_.size());
  for (int t = 0; t < static_cast<int>(mesh.triangles.cols()); ++t) {
    const auto after = std::upper_bound(first_vertex_.begin(), first_vertex_.end(), mesh.triangles(0, t));
    triangles[static_cast<std::size_t>(after - first_vertex_.begin()) - 1].push_back(t);
  }
  for (std::size_t b = 0; b < triangles.size(); ++b) {
    if (is_closed(mesh, triangles[b])) closed_.push_back({static_cast<int>(b), std::move(triangles[b])});
  }
}

std::vector<int> ClosedBodies::bodies() const {
  std::vector<int> out;
  for (const Body& body : closed_) out.push_back(body.number);
  return out;
}

bool ClosedBodies::owns(int body, int vertex) const {
  const auto b = static_cast<std::size_t>(body);
  return vertex >= first_vertex_[b] && (b + 1 == first_vertex_.size() || vertex < first_vertex_[b + 1]);
}

Enclosed ClosedBodies::enclosed(const Positions& x) const {
  Enclosed out;
  for (const Body& body : closed_) {
    const BodyInState there(mesh_, body.triangles, x);
    enum class Side : char { outside, inside, unknown };
    std::vector<Side> side(vertices_.size(), Side::outside);
    parallel_items(side.size(), 1, [&](std::size_t i) {
      const int v = vertices_[i];
      if (owns(body.number, v) || !there.may_hold(x.col(v))) return;
      const std::optional<bool> in = there.holds(x.col(v));
      side[i] = !in ? Side::unknown : *in ? Side::inside : Side::outside;
    });
    for (std::size_t i = 0; i < side.size(); ++i) {
      out.asked += !owns(body.number, vertices_[i]);
      if (side[i] == Side::inside) out.inside.emplace_back(body.number, vertices_[i]);
      if (side[i] == Side::unknown) out.undecided.emplace_back(body.number, vertices_[i]);
    }
  }
  return out;
}

std::vector<double> ClosedBodies::depths(const std::vector<Enclosed::Pair>& pairs, const Positions& x) const {
  std::vector<double> out(pairs.size());
  for (const Body& body : closed_) {
    const auto is_here = [&body](const Enclosed::Pair& pair) { return pair.first == body.number; };
    if (std::none_of(pairs.begin(), pairs.end(), is_here)) continue;
    const BodyInState there(mesh_, body.triangles, x);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (is_here(pairs[i])) out[i] = there.distance(x.col(pairs[i].second));
    }
  }
  return out;
}

}  // namespace bb::audit
