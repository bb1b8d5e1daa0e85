// Stitches that draw together, and that break.
#include <cmath>

#include "tests/features/feature.hpp"

namespace bb::features {
namespace {

using nlohmann::json;

constexpr double apart = 0.05, stitch = 25;  // m, N/m

json stitched(const Method& method) {
  json config = bare(method, 1e-3, 50);
  config["scene"]["bodies"] = {plate("plate", 0), plate("other", apart)};
  config["scene"]["stitches"] = {{{"a", "plate"},
                                  {"b", "other"},
                                  {"a_vertices", {0, 1, 2, 3}},
                                  {"b_vertices", {0, 1, 2, 3}},
                                  {"stiffness_N_per_m", stitch}}};
  ground(method, config, 25);
  return config;
}

/// Where a solver has no energies its stitches are as stiff as it makes them: their ends meet.
std::string is_drawn_together(const Method& method, const Track& run) {
  for (int v = 0; v < 4; ++v) {
    const double m = run.scene.mass[static_cast<std::size_t>(v)],
                 left = run.end()(2, v + 4) - run.end()(2, v);
    double expected = apart * std::cos(std::sqrt(2 * stitch / m) * run.t_end());
    if (method.still()) expected = apart * 25 / (25 + 2 * stitch);
    if (method.solver.name == "projection") expected = 0;
    const auto wrong = differs("distance", left, expected, 0.03 * apart);
    if (!wrong.empty()) return wrong;
  }
  return {};
}

constexpr double seam = 20000, strength = 1, ramp = 0.3;  // N/m, N, s

/// A plate of four equal vertices hangs on four stitches while gravity grows. Their strength is set to twice as much, with a
/// weight of a half.
json torn(const Method& method) {
  json config = bare(method, 1e-3, 300);
  json held = {{"name", "held"}, {"kind", "rigid"}}, below = plate("plate", -apart);
  for (const char* key : {"mesh", "transform"}) held[key] = plate("held", 0)[key];
  below["weights"] = {{{"name", "half"}, {"formula", "0.5"}}};
  if (method.still()) below["pins"] = {{{"all", true}, {"pull_N_per_m", 25}}};
  config["scene"].erase("gravity_m_per_s2");
  config["scene"]["gravity_schedule"] = {{{"time_s", 0.0}, {"gravity_m_per_s2", {0, 0, 0}}},
                                         {{"time_s", ramp}, {"gravity_m_per_s2", {0, 0, -g}}}};
  config["scene"]["bodies"] = {below, held};
  config["scene"]["stitches"] = {{{"a", "plate"},
                                  {"b", "held"},
                                  {"a_vertices", {0, 1, 2, 3}},
                                  {"b_vertices", {0, 1, 2, 3}},
                                  {"stiffness_N_per_m", seam},
                                  {"rest_length_m", apart},
                                  {"strength_N", 2 * strength},
                                  {"weights", "half"}}};
  return config;
}

/// Where the vertex is at the end once its stitch has broken at that step end.
double way_of_the_loose(const Method& method, const Track& run, std::size_t broken, int v) {
  const double m = run.scene.mass[static_cast<std::size_t>(v)], weight = g * method.weight();
  if (method.still()) return -m * weight / 25;
  const double t = run.t[broken], left = run.t_end() - t;
  const double fall = weight / ramp * (t * left * left / 2 + left * left * left / 6);
  return run.x[broken](2, v) - run.x[0](2, v) + run.v[broken](2, v) * left - fall;
}

std::string breaks_at_its_strength(const Method& method, const Track& run) {
  for (int v = 0; v < 4; ++v) {
    const double m = run.scene.mass[static_cast<std::size_t>(v)], full = m * g * method.weight();
    const auto tension = [&](std::size_t i) { return seam * (run.x[0](2, v) - run.x[i](2, v)); };
    std::size_t broken = 0;
    while (broken + 1 < run.x.size() && !(tension(broken) > strength)) ++broken;
    const double part = method.still() ? strength * (seam + 25) / seam / full : strength / full;
    const double expected = ramp * (method.still() ? std::sqrt(part) : part);
    if (auto wrong = differs("time of the break", run.t[broken], expected, 0.05 * ramp); !wrong.empty())
      return wrong;
    const double way = way_of_the_loose(method, run, broken, v);
    if (auto wrong = differs("way", run.end()(2, v) - run.x[0](2, v), way, 0.03 * std::abs(way));
        !wrong.empty())
      return wrong;
  }
  return {};
}

}  // namespace

std::vector<Feature> stitch_features() {
  return {{"stitches", "two plates swing towards each other", {"stitch"}, false, stitched, is_drawn_together},
          {"stitches that break",
           "a plate falls from when the tension of its stitches is beyond their strength",
           {"stitch"},
           false,
           torn,
           breaks_at_its_strength}};
}

}  // namespace bb::features
