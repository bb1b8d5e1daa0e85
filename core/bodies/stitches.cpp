// What joins bodies of a scene, and what presses on one from within.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/bodies/scene_builder.hpp"
#include "core/mesh/topology.hpp"

namespace bb {

/// Scene vertices of some of a body's own; empty after a violation.
std::vector<int> SceneBuilder::stitched(const std::string& body, const std::vector<int>& own,
                                        const std::string& where) {
  const auto found = std::find_if(scene_.bodies.begin(), scene_.bodies.end(),
                                  [&body](const Body& b) { return b.name == body; });
  if (found == scene_.bodies.end()) {
    std::string names;
    for (const Body& b : scene_.bodies) names += (names.empty() ? "" : ", ") + b.name;
    violations_.push_back({where, '"' + body + '"', "the name of a body: " + names});
    return {};
  }
  std::vector<int> out;
  for (const int v : own) {
    if (v < 0 || v >= found->n_vertices) {
      violations_.push_back({where + "_vertices", fmt::format("vertex {}", v),
                             fmt::format("0 to {} of body \"{}\"", found->n_vertices - 1, body)});
      return {};
    }
    out.push_back(found->first_vertex + v);
  }
  return out;
}

void SceneBuilder::add_stitch(const StitchSpec& stitch, const std::string& below) {
  const std::string where = where_ + below;
  if (!violations_.empty()) return;  // bodies were left out: what follows would mislead
  if (!(stitch.stiffness > 0) || !std::isfinite(stitch.stiffness)) {
    violations_.push_back({where + "/stiffness", fmt::format("{:g}", stitch.stiffness), "a number > 0"});
  }
  const std::vector<int> a = stitched(stitch.a, stitch.a_vertices, where + "/a");
  const std::vector<int> b = stitched(stitch.b, stitch.b_vertices, where + "/b");
  if (!violations_.empty()) return;
  if (a.empty() || a.size() != b.size()) {
    violations_.push_back({where + "/b_vertices", fmt::format("{} vertices", b.size()),
                           fmt::format("as many as a_vertices, {}, and at least one", a.size())});
    return;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool held =
        pin_of_[static_cast<std::size_t>(a[i])] >= 0 && pin_of_[static_cast<std::size_t>(b[i])] >= 0;
    if (a[i] == b[i] || held) {
      violations_.push_back(
          {fmt::format("{}/b_vertices/{}", where, i), fmt::format("{}", stitch.b_vertices[i]),
           held ? "a stitch with a vertex that is not prescribed" : "another vertex than that of a"});
      continue;
    }
    scene_.stitches.pairs.push_back({a[i], b[i]});
    scene_.stitches.stiffness.push_back(stitch.stiffness);
  }
}

/// A volume is enclosed where every edge is run through once in each direction.
void SceneBuilder::append_pressure(const BodySpec& spec, std::span<const std::array<int, 3>> surface,
                                   int first) {
  const std::string what = "body \"" + spec.name + "\"/pressure";
  if (!std::isfinite(spec.pressure)) return complain(what, "a non-finite pressure", "a finite number");
  std::vector<std::array<int, 2>> sides;
  for (const auto& t : surface) {
    for (std::size_t k = 0; k < 3; ++k) sides.push_back({t[k], t[(k + 1) % 3]});
  }
  std::sort(sides.begin(), sides.end());
  const auto run = [&sides](const std::array<int, 2>& side) {
    const auto [from, to] = std::equal_range(sides.begin(), sides.end(), side);
    return to - from;
  };
  for (const auto& side : sides) {
    if (run(side) == 1 && run({side[1], side[0]}) == 1) continue;
    return complain(
        what,
        fmt::format("a surface that does not close at the edge of vertices {} and {}", side[0], side[1]),
        "a surface each of whose edges belongs to two triangles that run through it in opposite directions");
  }
  if (sides.empty()) return complain(what, "no surface", "a body with triangles");
  const Positions& x = spec.mesh.vertices;
  double volume = 0;
  for (const auto& [a, b, c] : surface) {
    const Vec3d o = x.col(surface.front()[0]);
    volume += (x.col(a) - o).dot((x.col(b) - o).cross(x.col(c) - o)) / 6;
  }
  if (volume == 0) return complain(what, "a surface that encloses no volume", "a volume other than 0");
  for (const auto& [a, b, c] : surface) {
    scene_.inflation.triangles.push_back({first + a, first + b, first + c});
    scene_.inflation.pressure.push_back(volume > 0 ? spec.pressure : -spec.pressure);
  }
}

}  // namespace bb
