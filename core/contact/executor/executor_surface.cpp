#include "core/contact/executor/executor_surface.hpp"

#include <numeric>
#include <string>

namespace bb::exec {

template <int N>
ExecutorPrimitives<N>::ExecutorPrimitives(Executor& executor, const char* name, const Primitives<N>& from)
    : vertex(executor, std::string(name) + " vertices"),
      d_hat(executor, std::string(name) + " d_hat"),
      offset(executor, std::string(name) + " offset"),
      free(executor, std::string(name) + " free"),
      lone(executor, std::string(name) + " lone") {
  std::vector<double> column(from.size());
  vertex.upload({from.vertices.empty() ? nullptr : from.vertices[0].data(), N * from.size()});
  for (std::size_t i = 0; i < column.size(); ++i) column[i] = from.side[i].d_hat;
  d_hat.upload(column);
  for (std::size_t i = 0; i < column.size(); ++i) column[i] = from.side[i].offset;
  offset.upload(column);
  free.upload(from.free);
  lone.upload(from.lone);
}

namespace {

std::vector<PlainObstacle> plain_obstacles(const std::vector<Obstacle>& obstacles) {
  std::vector<PlainObstacle> out;
  out.reserve(obstacles.size());
  for (const Obstacle& o : obstacles) {
    out.push_back({{o.point[0], o.point[1], o.point[2]},
                   {o.axis[0], o.axis[1], o.axis[2]},
                   o.radius,
                   o.kind,
                   o.inside,
                   o.vertex});
  }
  return out;
}

}  // namespace

ExecutorSurface::ExecutorSurface(Executor& executor, const Scene& scene, const Surface& surface)
    : points_(executor, "surface points", surface.points),
      edges_(executor, "surface edges", surface.edges),
      triangles_(executor, "surface triangles", surface.triangles),
      vertex_free_(executor, "surface vertex free"),
      body_(executor, "surface body"),
      apart_(executor, "surface vertices without the rest rule"),
      rest_(executor, "surface rest positions"),
      obstacles_(executor, "obstacles"),
      planar_(surface.planar),
      element_size_(surface.element_size) {
  vertex_free_.upload(surface.vertex_free);
  body_.upload(scene.body);
  if (surface.rest_rule == RestRule::off) {
    std::vector<int> each(scene.body.size());
    std::iota(each.begin(), each.end(), 0);
    apart_.upload(each);
  }
  rest_.upload({scene.rest.data(), static_cast<std::size_t>(scene.rest.size())});
  obstacles_.upload(plain_obstacles(scene.obstacles));
}

SurfaceView ExecutorSurface::view() const {
  return {points_.view(),    edges_.view(),
          triangles_.view(), vertex_free_.data(),
          body_.data(),      rest_.data(),
          obstacles_.data(), static_cast<int>(obstacles_.size()),
          planar_,           apart_.size() > 0 ? apart_.data() : body_.data()};
}

template struct ExecutorPrimitives<1>;
template struct ExecutorPrimitives<2>;
template struct ExecutorPrimitives<3>;

}  // namespace bb::exec
