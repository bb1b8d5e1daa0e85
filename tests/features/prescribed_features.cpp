// Vertices and obstacles that are led.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/features/feature.hpp"

namespace bb::features {
namespace {

using nlohmann::json;

/// A plate that falls, with a pin on two of its vertices.
json pinned(const Method& method, const json& pin, int steps) {
  json config = bare(method, 1e-3, steps);
  config["scene"]["gravity_m_per_s2"] = {0, 0, -g};
  config["scene"]["bodies"][0]["pins"] = {pin};
  return config;
}

std::string is_where_it_belongs(const Track& run, const Vec3d& way) {
  const double moved = std::abs((run.end() - run.x[0])(2, 3));
  if (moved < 1e-4) return fmt::format("nothing moves: {:.3g} m", moved);
  for (const int v : {0, 1}) {
    const Vec3d off = run.end().col(v) - run.x[0].col(v) - way;
    if (off.norm() > 1e-9) return fmt::format("vertex {} is {:.3g} m off its place", v, off.norm());
  }
  return {};
}

json late(const Method& method) { return pinned(method, {{"indices", {0, 1}}, {"hold_s", 0.03}}, 60); }

json driven(const Method& method) {
  json config = pinned(method, {{"indices", {0, 1}}, {"motion", {{"velocity_m_per_s", {0, 0, 0.5}}}}}, 60);
  if (method.still())
    config["scene"]["bodies"][0]["pins"].push_back({{"indices", {2, 3}}, {"pull_N_per_m", 25}});
  return config;
}

/// Turned by half a radian about the z axis, by a film.
json filmed(const Method& method) {
  json config = pinned(method,
                       {{"indices", {0, 1}},
                        {"motion",
                         {{"film",
                           {{"generator", "twist"},
                            {"turn_rad_per_m", 0.5},
                            {"from_m", -1},
                            {"period_s", 0.12},
                            {"n_frames", 61},
                            {"duration_s", 0.06}}}}}},
                       60);
  if (method.still())
    config["scene"]["bodies"][0]["pins"].push_back({{"indices", {2, 3}}, {"pull_N_per_m", 25}});
  return config;
}

std::string is_in_the_last_frame(const Method&, const Track& run) {
  for (const int v : {0, 1}) {
    const Vec3d x = run.x[0].col(v), c(std::cos(0.5), std::sin(0.5), 0);
    const Vec3d there(c[0] * x[0] - c[1] * x[1], c[1] * x[0] + c[0] * x[1], x[2]);
    if ((there - x).norm() < 0.01) return "the film does not move";
    const double off = (run.end().col(v) - there).norm();
    if (off > 1e-9) return fmt::format("vertex {} is {:.3g} m off its place", v, off);
  }
  return {};
}

json released(const Method& method) {
  json config = pinned(method, {{"all", true}, {"release_s", 0.03}}, 80);
  config["scene"]["bodies"].push_back(plate("free", 1));
  return config;
}

std::string falls_when_let_go(const Method& method, const Track& run) {
  const double t = run.t_end() - 0.03, fallen = 0.5 * g * method.weight() * t * t;
  return differs("height", (run.end() - run.x[0]).leftCols(4).row(2).mean(), -fallen,
                 1.5 * g * method.weight() * t * run.dt);
}

/// A floor that comes up with 0.5 m/s against a plate that falls on it.
json lifted(const Method& method) {
  json config = bare(method, 1e-3, 100);
  config["scene"]["gravity_m_per_s2"] = {0, 0, -g};
  config["scene"]["bodies"] = {plate("plate", 7e-4)};
  config["scene"]["obstacles"] = {
      {{"name", "floor"}, {"kind", "plane"}, {"motion", {{"velocity_m_per_s", {0, 0, 0.5}}}}}};
  config["formulation"]["stiffness_policy"]["kappa_N_per_m"] = 2e5;
  return config;
}

std::string goes_with_the_floor(const Method&, const Track& run) {
  const double floor = 0.5 * run.t_end(), lowest = run.end().row(2).minCoeff();
  if (lowest < floor - 2e-4) return fmt::format("the plate is {:.3g} m below the floor", floor - lowest);
  return lowest > floor + 0.06 ? fmt::format("the plate flies {:.3g} m above the floor", lowest - floor) : "";
}

}  // namespace

std::vector<Feature> prescribed_features() {
  return {{"late pin",
           "vertices that have fallen are where they started once the pin holds",
           {},
           true,
           late,
           [](const Method&, const Track& run) { return is_where_it_belongs(run, Vec3d::Zero()); }},
          {"driven pin",
           "vertices are where the motion takes them",
           {},
           false,
           driven,
           [](const Method&, const Track& run) {
             return is_where_it_belongs(run, Vec3d(0, 0, 0.5 * run.t_end()));
           }},
          {"pin on a film", "vertices are in the last frame", {}, false, filmed, is_in_the_last_frame},
          {"pin that lets go",
           "the plate falls by g t^2/2 from then on",
           {"inertia", "external_force"},
           true,
           released,
           falls_when_let_go},
          {"moving obstacle",
           "the plate goes up with the floor",
           {"contact"},
           true,
           lifted,
           goes_with_the_floor}};
}

}  // namespace bb::features
