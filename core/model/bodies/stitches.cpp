// What joins bodies of a scene, and what presses on one from within.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/bodies/lumping.hpp"
#include "core/model/bodies/scene_builder.hpp"
#include "core/model/bodies/weights.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

/// Index of the body of that name; their number: there is none.
std::size_t place_of(const std::vector<Body>& bodies, const std::string& name) {
  const auto found =
      std::find_if(bodies.begin(), bodies.end(), [&name](const Body& b) { return b.name == name; });
  return static_cast<std::size_t>(found - bodies.begin());
}

}  // namespace

/// Scene vertices of some of a body's own; empty after a violation.
std::vector<int> SceneBuilder::stitched(const std::string& body, const std::vector<int>& own,
                                        const std::string& where) {
  const std::size_t place = place_of(scene_.bodies, body);
  if (place == scene_.bodies.size()) {
    std::string names;
    for (const Body& b : scene_.bodies) names += (names.empty() ? "" : ", ") + b.name;
    violations_.push_back({where, '"' + body + '"', "the name of a body: " + names});
    return {};
  }
  const Body& found = scene_.bodies[place];
  std::vector<int> out;
  for (const int v : own) {
    if (v < 0 || v >= found.n_vertices) {
      violations_.push_back({where + "_vertices", fmt::format("vertex {}", v),
                             fmt::format("0 to {} of body \"{}\"", found.n_vertices - 1, body)});
      return {};
    }
    out.push_back(found.first_vertex + v);
  }
  return out;
}

/// Of each of them, N; infinite where none breaks. The bodies are there.
std::vector<double> SceneBuilder::strengths(const StitchSpec& stitch, const std::string& where) {
  const Complaints report{where, violations_};
  std::vector<double> out(stitch.a_vertices.size(),
                          stitch.strength.value_or(std::numeric_limits<double>::infinity()));
  if (stitch.strength)
    report.number("/strength", *stitch.strength, *stitch.strength > 0, "a number > 0; without: none breaks");
  if (stitch.weights.empty()) return out;
  if (!stitch.strength) report("/weights", "weights of stitches that do not break", "strength_N beside them");
  const WeightGroup* const group =
      require_group(report, weights_[place_of(scene_.bodies, stitch.a)], "/weights", stitch.weights);
  for (std::size_t i = 0; group && i < out.size(); ++i) {
    const double weight = group->weight[static_cast<std::size_t>(stitch.a_vertices[i])];
    out[i] *= weight;
    if (weight > 0) continue;
    report(fmt::format("/a_vertices/{}", i),
           fmt::format("vertex {} with a weight of 0 in \"{}\"", stitch.a_vertices[i], stitch.weights),
           "weights > 0: a stitch without strength breaks at rest");
  }
  return out;
}

void SceneBuilder::add_stitch(const StitchSpec& stitch, const std::string& below) {
  const std::string where = where_ + below;
  if (!violations_.empty()) return;  // bodies were left out: what follows would mislead
  if (!(stitch.stiffness > 0) || !std::isfinite(stitch.stiffness)) {
    violations_.push_back({where + "/stiffness", fmt::format("{:g}", stitch.stiffness), "a number > 0"});
  }
  if (!(stitch.rest_length >= 0) || !std::isfinite(stitch.rest_length)) {
    violations_.push_back({where + "/rest_length", fmt::format("{:g}", stitch.rest_length), "a number >= 0"});
  }
  const std::vector<int> a = stitched(stitch.a, stitch.a_vertices, where + "/a");
  const std::vector<int> b = stitched(stitch.b, stitch.b_vertices, where + "/b");
  if (!violations_.empty()) return;
  if (a.empty() || a.size() != b.size()) {
    violations_.push_back({where + "/b_vertices", fmt::format("{} vertices", b.size()),
                           fmt::format("as many as a_vertices, {}, and at least one", a.size())});
    return;
  }
  const std::vector<double> strength = strengths(stitch, where);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool held =
        held_[static_cast<std::size_t>(a[i])] >= 0 && held_[static_cast<std::size_t>(b[i])] >= 0;
    if (a[i] == b[i] || held) {
      violations_.push_back(
          {fmt::format("{}/b_vertices/{}", where, i), fmt::format("{}", stitch.b_vertices[i]),
           held ? "a stitch with a vertex that is not prescribed" : "another vertex than that of a"});
      continue;
    }
    scene_.stitches.pairs.push_back({a[i], b[i]});
    scene_.stitches.stiffness.push_back(stitch.stiffness);
    scene_.stitches.rest_length.push_back(stitch.rest_length);
    scene_.stitches.strength.push_back(strength[i]);
  }
}

/// A volume is enclosed where there is no open side.
void SceneBuilder::append_pressure(const BodySpec& spec, std::span<const std::array<int, 3>> surface,
                                   int first) {
  const std::string what = "body \"" + spec.name + "\"/pressure";
  const bool finite = std::all_of(spec.pressure_keys.begin(), spec.pressure_keys.end(),
                                  [](const PressureKey& key) { return std::isfinite(key.value); });
  if (!std::isfinite(spec.pressure) || !finite)
    return complain(what, "a non-finite pressure", "a finite number");
  if (const auto side = open_side(surface)) {
    return complain(
        what,
        fmt::format("a surface that does not close at the edge of vertices {} and {}", (*side)[0],
                    (*side)[1]),
        "a surface each of whose edges belongs to two triangles that run through it in opposite directions");
  }
  if (surface.empty()) return complain(what, "no surface", "a body with triangles");
  const Positions& x = spec.mesh.vertices;
  double volume = 0;
  for (const auto& [a, b, c] : surface) {
    const Vec3d o = x.col(surface.front()[0]);
    volume += (x.col(a) - o).dot((x.col(b) - o).cross(x.col(c) - o)) / 6;
  }
  if (volume == 0) return complain(what, "a surface that encloses no volume", "a volume other than 0");
  Inflation& inflation = scene_.inflation;
  const int keys = spec.pressure_keys.empty() ? -1 : static_cast<int>(inflation.key_lists.size());
  if (keys >= 0) inflation.key_lists.push_back(spec.pressure_keys);
  const double pressure = keys >= 0 ? 1 : spec.pressure;
  append_load_parts(spec, surface, inflation.triangles.size(), inflation.parts);
  if (!spec.pressure_mix.empty()) {
    inflation.weights.push_back({first, static_cast<int>(inflation.triangles.size()),
                                 static_cast<int>(surface.size()), mix_of(spec, spec.pressure_mix)});
  }
  for (const auto& [a, b, c] : surface) {
    inflation.triangles.push_back({first + a, first + b, first + c});
    inflation.pressure.push_back(volume > 0 ? pressure : -pressure);
    inflation.keys.push_back(keys);
  }
}

}  // namespace bb
