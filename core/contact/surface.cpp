#include "core/contact/surface.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/math/stop_request.hpp"

namespace bb {

namespace {

/// Exact for equal values.
double mean(const double* values, int n) {
  double excess = 0;
  for (int i = 1; i < n; ++i) excess += values[i] - values[0];
  return values[0] + excess / n;
}

template <int N>
void add(Primitives<N>& out, const Scene& scene, const std::vector<std::uint8_t>& vertex_free,
         const std::array<int, N>& vertices) {
  double d_hat[N], offset[N];
  bool any_free = false;
  for (int i = 0; i < N; ++i) {
    const std::size_t v = static_cast<std::size_t>(vertices[static_cast<std::size_t>(i)]);
    d_hat[i] = scene.d_hat[v];
    offset[i] = scene.offset[v];
    any_free = any_free || vertex_free[v] != 0;
  }
  out.vertices.push_back(vertices);
  out.side.push_back({mean(d_hat, N), mean(offset, N)});
  out.free.push_back(any_free ? 1 : 0);
}

std::array<int, 2> ascending(int a, int b) { return a < b ? std::array{a, b} : std::array{b, a}; }

template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

void add_sides(std::vector<std::array<int, 2>>& edges, const std::vector<std::array<int, 3>>& triangles) {
  for (const auto& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(ascending(t[k], t[(k + 1) % 3]));
  }
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// See Surface::element_size.
double element_size(const Scene& scene, const Surface& surface) {
  std::vector<double> lengths, reaches;
  for (const auto& e : surface.edges.vertices) {
    lengths.push_back((scene.rest.col(e[1]) - scene.rest.col(e[0])).norm());
  }
  for (const Side& side : surface.points.side) reaches.push_back(side.d_hat + 2 * side.offset);
  return 16 * (median(std::move(lengths)) + median(std::move(reaches)));
}

}  // namespace

void check_primitive_count(const char* kind, std::size_t n, std::size_t most) {
  if (n <= most) return;
  throw std::length_error("contact: " + std::to_string(n) + " " + kind + " in the surface; at most " +
                          std::to_string(most));
}

Surface::Surface(const Scene& scene, RestRule rule)
    : vertex_free(static_cast<std::size_t>(scene.n_vertices()), 1),
      body(scene.body),
      n_bodies(static_cast<int>(scene.bodies.size())),
      collisions(scene.collisions),
      rest(scene.rest),
      planar(scene.planar),
      planar_pairs(scene.planar_pairs),
      rest_rule(rule) {
  heed_stop();
  for (const Pin& pin : scene.pins) {
    if (pin.span.always()) vertex_free[static_cast<std::size_t>(pin.vertex)] = 0;
  }

  std::vector<int> vertices = scene.surface_vertices;
  sort_unique(vertices);
  for (int v : vertices) add<1>(points, scene, vertex_free, {v});

  std::vector<std::array<int, 2>> all_edges;
  if (!planar || planar_pairs == PlanarPairs::point_edge) {
    for (const auto& e : scene.surface_edges) all_edges.push_back(ascending(e[0], e[1]));
  }
  if (!planar) {
    add_sides(all_edges, scene.surface_triangles);
    for (const auto& t : scene.surface_triangles) add<3>(triangles, scene, vertex_free, t);
  }
  sort_unique(all_edges);
  check_primitive_count("vertices", vertices.size());
  check_primitive_count("edges", all_edges.size());
  check_primitive_count("triangles", scene.surface_triangles.size());
  for (const auto& e : all_edges) add<2>(edges, scene, vertex_free, e);
  find_filled(scene);
  find_lone();
  if (planar) connect(scene);
  for (std::size_t e = 0; e < edges.size() && !planar; ++e) {
    if (edges.lone[e] != 0) lone_edges.push_back(static_cast<int>(e));
  }
  element_size = bb::element_size(scene, *this);
}

void Surface::find_filled(const Scene& scene) {
  std::vector<std::array<int, 3>> all = scene.surface_triangles;
  if (planar) {
    const auto elastic = parts::filled_triangles(scene);
    all.insert(all.end(), elastic.begin(), elastic.end());
    sort_unique(all);
  }
  for (const auto& t : all) {
    const bool any_free = std::any_of(
        t.begin(), t.end(), [this](int v) { return vertex_free[static_cast<std::size_t>(v)] != 0; });
    if (any_free) filled.push_back(t);
  }
}

void Surface::find_lone() {
  std::vector<std::uint8_t> in_edge(vertex_free.size(), 0);
  std::vector<std::array<int, 2>> sides;
  add_sides(sides, triangles.vertices);
  sort_unique(sides);
  for (const auto& e : edges.vertices) {
    for (const int v : e) in_edge[static_cast<std::size_t>(v)] = 1;
    edges.lone.push_back(std::binary_search(sides.begin(), sides.end(), e) ? 0 : 1);
  }
  for (const auto& p : points.vertices) {
    points.lone.push_back(in_edge[static_cast<std::size_t>(p[0])] != 0 ? 0 : 1);
  }
  triangles.lone.assign(triangles.size(), 1);
}

void Surface::connect(const Scene& scene) {
  if (planar_pairs == PlanarPairs::vertex_vertex) {
    for (const auto& e : scene.surface_edges) connected_.push_back(ascending(e[0], e[1]));
    add_sides(connected_, parts::filled_triangles(scene));
    add_sides(connected_, scene.surface_triangles);
    for (const auto& e : parts::joined_edges(scene)) {  // what joins two bodies is a stitch, not a mesh edge
      const std::size_t a = static_cast<std::size_t>(e[0]), b = static_cast<std::size_t>(e[1]);
      if (scene.body[a] == scene.body[b]) connected_.push_back(ascending(e[0], e[1]));
    }
    sort_unique(connected_);
    return;
  }
  const std::vector<std::array<int, 3>> elastic = parts::filled_triangles(scene);
  for (const auto* list : {&elastic, &scene.surface_triangles}) {
    for (const auto& t : *list) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto e = ascending(t[k], t[(k + 1) % 3]);
        opposite_.push_back({e[0], e[1], t[(k + 2) % 3]});
      }
    }
  }
  sort_unique(opposite_);
}

bool Surface::connected(int vertex, int other) const {
  return std::binary_search(connected_.begin(), connected_.end(), ascending(vertex, other));
}

bool Surface::adjacent(int vertex, const std::array<int, 2>& edge) const {
  return vertex == edge[0] || vertex == edge[1] ||
         std::binary_search(opposite_.begin(), opposite_.end(), std::array{edge[0], edge[1], vertex});
}

}  // namespace bb
