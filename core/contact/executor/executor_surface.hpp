// The collision primitives of a scene in an executor's memory: core/contact/surface.hpp as columns. Constant over a run.
#pragma once

#include <cstdint>
#include <vector>

#include "core/contact/obstacle.hpp"
#include "core/contact/surface.hpp"
#include "core/exec/buffer.hpp"

namespace bb::exec {

/// Columns `vertex` of x [3n].
template <int N>
BB_HD Mat<double, 3, N> points_of(const double* x, const int* vertex) {
  Mat<double, 3, N> out;
  for (int k = 0; k < N; ++k) {
    for (int c = 0; c < 3; ++c) out(c, k) = x[3 * static_cast<Index>(vertex[k]) + c];
  }
  return out;
}

/// What a kernel reads of primitives with N vertices each.
template <int N>
struct PrimitiveView {
  const int* vertex;                // [N n] global ids; edges ascending
  const double *d_hat, *offset;     // [n] m
  const std::uint8_t *free, *lone;  // [n] 1 when at least one vertex is free; no part of a larger primitive
  Index n;
};

template <int N>
struct ExecutorPrimitives {
  ExecutorPrimitives(Executor& executor, const char* name, const Primitives<N>& from);
  PrimitiveView<N> view() const {
    return {vertex.data(), d_hat.data(), offset.data(), free.data(), lone.data(), free.size()};
  }

  Buffer<int> vertex;
  Buffer<double> d_hat, offset;
  Buffer<std::uint8_t> free, lone;
};

/// An obstacle as plain numbers.
struct PlainObstacle {
  double point[3], axis[3], radius;
  ObstacleKind kind;
  bool inside;
  int vertex;  // where its point is; -1: it stands still
  /// Where it is in the state x [3 n_vertices], m: posed() of core/contact/obstacle.hpp.
  BB_HD AnalyticSurface<double> surface(const double* x) const {
    const double* const at = vertex < 0 ? point : x + 3 * static_cast<Index>(vertex);
    return {kind, Vec3d(at[0], at[1], at[2]), Vec3d(axis[0], axis[1], axis[2]), radius, inside, vertex};
  }
};

/// Everything that finding and evaluating pairs reads of the surface, by value in kernels.
struct SurfaceView {
  PrimitiveView<1> points;
  PrimitiveView<2> edges;
  PrimitiveView<3> triangles;
  const std::uint8_t* vertex_free;  // [n_vertices]
  const int* body;                  // [n_vertices]
  const double* rest;               // [3 n_vertices] m
  const PlainObstacle* obstacles;
  int n_obstacles;
  bool planar;
  const int*
      rest_body;  // [n_vertices] vertices of one number are ruled at rest: `body`, or with the rule off one each

  // what row_rule.hpp calls
  BB_HD bool is_free(int v) const { return vertex_free[v] != 0; }
  BB_HD bool ruled_at_rest(int v, int w) const { return rest_body[v] == rest_body[w]; }
  template <int N>
  BB_HD Mat<double, 3, N> rest_points(const int* of) const {
    return points_of<N>(rest, of);
  }

  template <int N>
  BB_HD const PrimitiveView<N>& primitives() const {
    if constexpr (N == 1) return points;
    if constexpr (N == 2) return edges;
    if constexpr (N == 3) return triangles;
  }
};

/// The scene and the surface are read in the constructor only. Errors: OutOfMemory.
class ExecutorSurface {
 public:
  ExecutorSurface(Executor& executor, const Scene& scene, const Surface& surface);
  SurfaceView view() const;
  /// See Surface.
  double element_size() const { return element_size_; }

 private:
  ExecutorPrimitives<1> points_;
  ExecutorPrimitives<2> edges_;
  ExecutorPrimitives<3> triangles_;
  Buffer<std::uint8_t> vertex_free_;
  Buffer<int> body_;
  Buffer<int> apart_;  // empty with the rest rule on
  Buffer<double> rest_;
  Buffer<PlainObstacle> obstacles_;
  const bool planar_;
  double element_size_;  // m
};

/// Candidate pairs: first << 32 | second, indices into the primitives of the surface, each list ascending; obstacle:
/// (point, obstacle), obstacle_edge and obstacle_triangle likewise. The lists are those of BroadPhase::update, or hold them.
struct ExecutorCandidates {
  explicit ExecutorCandidates(Executor& executor)
      : point_point(executor, "candidates point-point"),
        point_edge(executor, "candidates point-edge"),
        point_triangle(executor, "candidates point-triangle"),
        edge_edge(executor, "candidates edge-edge"),
        obstacle(executor, "candidates obstacle"),
        obstacle_edge(executor, "candidates obstacle-edge"),
        obstacle_triangle(executor, "candidates obstacle-triangle") {}
  /// Gives all memory back.
  void free() {
    for (auto* list : {&point_point, &point_edge, &point_triangle, &edge_edge, &obstacle, &obstacle_edge,
                       &obstacle_triangle}) {
      list->free();
    }
  }
  std::size_t bytes() const {
    return point_point.bytes() + point_edge.bytes() + point_triangle.bytes() + edge_edge.bytes() +
           obstacle.bytes() + obstacle_edge.bytes() + obstacle_triangle.bytes();
  }
  /// Of primitives with N vertices and obstacles.
  template <int N>
  Buffer<Key>& of_obstacles() {
    return N == 1 ? obstacle : N == 2 ? obstacle_edge : obstacle_triangle;
  }
  template <int N>
  const Buffer<Key>& of_obstacles() const {
    return N == 1 ? obstacle : N == 2 ? obstacle_edge : obstacle_triangle;
  }
  Buffer<Key> point_point, point_edge, point_triangle, edge_edge, obstacle, obstacle_edge, obstacle_triangle;
};

}  // namespace bb::exec
