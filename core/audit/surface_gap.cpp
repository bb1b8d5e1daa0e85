#include "core/audit/surface_gap.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/audit/box_tree.hpp"
#include "core/audit/closest_point.hpp"
#include "core/audit/quadric.hpp"
#include "core/audit/tally.hpp"
#include "core/math/parallel.hpp"

namespace bb::audit {
namespace {

struct Least {
  double gap = std::numeric_limits<double>::infinity();
  void take(double other) { gap = std::min(gap, other); }
  void merge(const Least& other) { take(other.gap); }
};

class GapMeasure {
 public:
  GapMeasure(const AuditMesh& mesh, const std::vector<int>& vertices, const Positions& x, double reach)
      : mesh_(mesh), vertices_(vertices), x_(x), reach_(reach) {}

  /// only_points: of the vertices alone.
  double to_obstacles(const ObstaclePrimitives& primitives, bool only_points = false) const {
    Least out;
    for (const AuditObstacle& given : mesh_.obstacles) {
      const AuditObstacle o = given.in(x_);
      const PrimitiveLists& p = primitives.of(given);
      if (only_points || o.allows_a_convex_set()) {
        out.merge(over(p.vertices, [&](int v) { return vertex_to(o, v); }));
        continue;
      }
      out.merge(over(p.lone_vertices, [&](int v) { return vertex_to(o, v); }));
      out.merge(over(p.lone_edges, [&](int e) {
        const auto ids = mesh_.edges.col(e);
        return simplex_to(o, std::array{ids[0], ids[1]});
      }));
      out.merge(over(p.triangles, [&](int t) {
        const auto ids = mesh_.triangles.col(t);
        return simplex_to(o, std::array{ids[0], ids[1], ids[2]});
      }));
    }
    return out.gap;
  }

  /// Smallest of the vertices' gaps and, in space, of those between edges.
  double between(const std::vector<double>& of_vertices) const {
    Least out;
    for (const double gap : of_vertices) out.take(gap);
    if (!mesh_.planar) out.merge(edge_to_edge());
    return out.gap;
  }

  /// SurfaceGap::of_vertices.
  std::vector<double> of_vertices() const {
    if (mesh_.planar) {
      return vertex_to_all(mesh_.edges, [this](const Vec3d& p, const auto& e) {
        return closest_to_origin(at(e[0]) - p, at(e[1]) - p).norm();
      });
    }
    return vertex_to_all(mesh_.triangles, [this](const Vec3d& p, const auto& t) {
      return closest_to_origin(at(t[0]) - p, at(t[1]) - p, at(t[2]) - p).norm();
    });
  }

 private:
  template <class F>
  static Least over(const std::vector<int>& list, F&& gap_of) {
    return tally_over<Least>(list.size(), [&](std::size_t i, Least& sum) { sum.take(gap_of(list[i])); });
  }

  double vertex_to(const AuditObstacle& o, int v) const {
    if (mesh_.is_prescribed(v)) return std::numeric_limits<double>::infinity();
    const Vec3d x = at(v);
    const double gap = o.kind == ObstacleKind::plane
                           ? o.axis.dot(x - o.point) / o.axis.norm()
                           : (o.inside ? -1.0 : 1.0) * (arm_length(o, x) - o.radius);
    return gap - thickness(std::array{v});
  }
  static double arm_length(const AuditObstacle& o, const Vec3d& x) {
    const FloatArms arm(o);
    return arm(x).norm() / arm.stretch;
  }
  template <std::size_t N>
  double simplex_to(const AuditObstacle& o, const std::array<int, N>& ids) const {
    if (mesh_.all_prescribed(ids)) return std::numeric_limits<double>::infinity();
    const FloatArms arm(o);
    std::array<Vec3d, N> w;
    for (std::size_t k = 0; k < N; ++k) w[k] = arm(at(ids[k]));
    return closest_to_origin(w).norm() / arm.stretch - o.radius - thickness(ids);
  }

  template <class A, class B>
  bool left_out(const A& a, const B& b) const {
    for (const int v : a) {
      if (std::find(b.begin(), b.end(), v) != b.end()) return true;
    }
    return mesh_.all_prescribed(a) && mesh_.all_prescribed(b);
  }

  template <class Ids, class F>
  std::vector<double> vertex_to_all(const Ids& primitives, F&& distance) const {
    const BoxTree tree(boxes(primitives));
    std::vector<double> out(vertices_.size());
    parallel_items(out.size(), 1, [&](std::size_t i) {
      const int v = vertices_[i];
      Least least;
      const Eigen::Matrix<int, 1, 1> alone(v);
      tree.query(box(alone), [&](int f) {
        const auto ids = primitives.col(f);
        const bool own =
            mesh_.planar && !mesh_.opposite.empty() && mesh_.opposite[static_cast<std::size_t>(f)] == v;
        if (own || left_out(alone, ids)) return;
        take(distance(at(v), ids) - thickness(alone) - thickness(ids), least);
      });
      out[i] = least.gap;
    });
    return out;
  }
  Least edge_to_edge() const {
    const BoxTree tree(boxes(mesh_.edges));
    return tally_over<Least>(static_cast<std::size_t>(mesh_.edges.cols()), [&](std::size_t i, Least& sum) {
      const auto a = mesh_.edges.col(static_cast<Eigen::Index>(i));
      tree.query(box(a), [&](int f) {
        const auto b = mesh_.edges.col(f);
        if (f <= static_cast<int>(i) || left_out(a, b)) return;
        take(segment_distance(at(a[0]), at(a[1]), at(b[0]), at(b[1])) - thickness(a) - thickness(b), sum);
      });
    });
  }
  void take(double gap, Least& sum) const {
    if (gap < reach_) sum.take(gap);
  }

  template <class Ids>
  double thickness(const Ids& ids) const {
    if (mesh_.thickness.empty()) return 0.0;
    double sum = 0.0;
    for (const int v : ids) sum += mesh_.thickness[static_cast<std::size_t>(v)];
    return sum / static_cast<double>(ids.size());
  }
  Vec3d at(int v) const { return {x_(0, v), x_(1, v), mesh_.planar ? 0.0 : x_(2, v)}; }
  template <class Column>
  Box box(const Column& ids) const {
    Box b;
    for (const int v : ids) b.add(at(v));
    const double wider = reach_ / 2 + thickness(ids);
    b.lo.array() -= wider, b.hi.array() += wider;
    return b;
  }
  template <class Ids>
  std::vector<Box> boxes(const Ids& primitives) const {
    std::vector<Box> out(static_cast<std::size_t>(primitives.cols()));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = box(primitives.col(static_cast<Eigen::Index>(i)));
    return out;
  }

  const AuditMesh& mesh_;
  const std::vector<int>& vertices_;
  const Positions& x_;
  double reach_;
};

}  // namespace

SurfaceGap surface_gap(const AuditMesh& mesh, const std::vector<int>& vertices,
                       const ObstaclePrimitives& primitives, const Positions& x, double reach) {
  const GapMeasure measure(mesh, vertices, x, reach);
  std::vector<double> of_vertices = measure.of_vertices();
  const double between = measure.between(of_vertices);
  return {measure.to_obstacles(primitives), between, std::move(of_vertices)};
}

double judged_obstacle_gap(const AuditMesh& mesh, const ObstaclePrimitives& primitives, const Positions& x) {
  return GapMeasure(mesh, {}, x, 0).to_obstacles(primitives, mesh.only_points);
}

}  // namespace bb::audit
