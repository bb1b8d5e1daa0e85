// The scene of a config as numpy arrays.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstdint>

#include "core/model/scene/scene.hpp"
#include "experiments/config/parse.hpp"
#include "python/src/bindings.hpp"

namespace bb::python {
namespace {

auto array_of_columns(const Positions& x) {
  return array_of(std::vector<double>(x.data(), x.data() + x.size()), x.cols(), 3);
}

template <std::size_t n>
auto array_of_corners(const std::vector<std::array<int, n>>& list) {
  std::vector<std::int32_t> out;
  for (const auto& corners : list) out.insert(out.end(), corners.begin(), corners.end());
  return array_of(std::move(out), list.size(), n);
}

template <class T>
auto array_of_list(const std::vector<T>& list) {
  return array_of(std::vector<T>(list), list.size());
}

}  // namespace

nb::dict arrays_of(const Scene& scene) {
  nb::dict out;
  out["name"] = scene.name;
  out["rest"] = array_of_columns(scene.rest);
  out["x0"] = array_of_columns(scene.x0);
  out["v0"] = array_of_columns(scene.v0);
  out["mass"] = array_of_list(scene.mass);
  out["body"] = array_of_list(scene.body);
  out["faces"] = array_of_corners(scene.surface_triangles);
  out["edges"] = array_of_corners(scene.surface_edges);
  out["d_hat"] = array_of_list(scene.d_hat);
  out["offset"] = array_of_list(scene.offset);
  std::vector<std::int32_t> pinned;
  for (const Pin& pin : scene.pins) pinned.push_back(pin.vertex);
  out["pinned"] = array_of_list(pinned);
  std::vector<std::string> bodies, obstacles;
  for (const Body& body : scene.bodies) bodies.push_back(body.name);
  for (const Obstacle& obstacle : scene.obstacles) obstacles.push_back(obstacle.name);
  out["bodies"] = bodies;
  out["obstacles"] = obstacles;
  return out;
}

void bind_scene(nb::module_& m) {
  m.def(
      "build_scene",
      [](const std::string& text, const std::string& source, const std::string& folder,
         const std::vector<std::string>& overrides) {
        return arrays_of(build_scene(parse_config(text, source, folder, overrides)));
      },
      nb::arg("text"), nb::arg("source"), nb::arg("folder"), nb::arg("overrides"));
}

}  // namespace bb::python
