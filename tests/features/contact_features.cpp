// Contact, and what reads its loads.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/features/feature.hpp"

namespace bb::features {
namespace {

using nlohmann::json;

/// A plate comes down with 1 m/s where nothing else acts.
json impact(const Method& method, double dt) {
  json config = bare(method, dt, static_cast<int>(std::lround(0.02 / dt)));
  add_floor(config);
  config["scene"]["bodies"] = {plate("plate", 0.003, -1)};
  config["formulation"]["d_hat_m"] = 2e-3;
  config["formulation"]["stiffness_policy"]["kappa_N_per_m"] = 1e5;
  return config;
}

std::string leaves_with_no_more(const Method&, const Track& run) {
  double lowest = run.end()(2, 0), fastest = 0;
  for (std::size_t k = 0; k < run.t.size(); ++k) {
    lowest = std::min(lowest, run.x[k].row(2).minCoeff());
    fastest = std::max(fastest, std::abs(run.velocity(k).z()));
  }
  if (lowest > 2.5e-3) return fmt::format("the plate stays at {:.3g} m and meets nothing", lowest);
  if (fastest > 1.02) return fmt::format("a plate that came with 1 m/s gets {:.3g} m/s", fastest);
  const double end = run.velocity(run.t.size() - 1).z();
  return end < -0.02 ? fmt::format("the plate still falls with {:.3g} m/s", end) : "";
}

Feature impact_in_steps_of(const char* name, double dt) {
  return {name, "a plate that comes with 1 m/s leaves with 1 m/s at most", {"inertia", "contact"},
          true, [dt](const Method& method) { return impact(method, dt); }, leaves_with_no_more};
}

/// A plate that comes down past a ball, which is between its vertices.
json past_a_ball(const Method& method) {
  json config = impact(method, 1e-4);
  config["time"]["steps"] = 600;
  config["scene"]["bodies"] = {plate("plate", 0.035, -1)};
  config["scene"]["obstacles"].push_back(
      {{"name", "ball"}, {"kind", "sphere"}, {"point_m", {0, 0, 0.02}}, {"radius_m", 0.01}});
  config["contact"]["model"] = "points";
  return config;
}

json resting(const Method& method) {
  json config = on_the_floor(method, 1e-3, 140);
  config["scene"]["obstacles"][0]["restitution"] = 0.0;
  config["scene"].erase("gravity_m_per_s2");
  config["scene"]["gravity_schedule"] = json::array();
  for (const auto& [time, value] : {std::pair(0.0, -g), {0.1, -g}, {0.1001, 20.0}})
    config["scene"]["gravity_schedule"].push_back({{"time_s", time}, {"gravity_m_per_s2", {0, 0, value}}});
  return config;
}

std::string leaves_freely(const Method& method, const Track& run) {
  const double free = 20 * method.weight() * (run.t_end() - 0.1);
  // held back for a step at most; what the barrier had stored it may give
  const double speed = run.velocity(run.t.size() - 1).z();
  if (speed < free - 2 * g * run.dt) return fmt::format("speed is {:.4g}, less than {:.4g} m/s", speed, free);
  return speed > free + 0.2 ? fmt::format("speed is {:.4g}, more than {:.4g} m/s", speed, free) : "";
}

json bouncing(const Method& method) {
  json config = impact(method, 1e-4);
  config["scene"]["obstacles"][0]["restitution"] = 0.5;
  return config;
}

std::string keeps_no_more_than_half(const Method& method, const Track& run) {
  if (const std::string wrong = leaves_with_no_more(method, run); !wrong.empty()) return wrong;
  const double end = run.velocity(run.t.size() - 1).z();
  return end > 0.55 ? fmt::format("a plate of restitution 0.5 leaves with {:.3g} of its speed", end) : "";
}

/// A plate is thrown at a sheet that stands still, farther in a step than contact reaches.
json thrown_at_a_sheet(const Method& method) {
  json config = bare(method, 1e-3, 4);
  config["scene"]["bodies"] = {plate("plate", 0.015, -10), plate("sheet", 0)};
  config["scene"]["bodies"][0]["transform"]["translate_m"] = {0.011, 0.007, 0.015};
  config["scene"]["bodies"][1]["pins"] = {{{"all", true}}};
  config["scene"]["bodies"][1]["transform"]["scale"] = 2;
  if (!method.solver.needs.overlap) config["formulation"]["shape"] = "log";  // a bounded one cannot carry it
  config["scene"]["collisions"] = {{{"a", "plate"}, {"b", "sheet"}, {"kind", "audited"}}};
  config["formulation"]["d_hat_m"] = 2e-3;
  config["formulation"]["stiffness_policy"]["kappa_N_per_m"] = 1e5;
  return config;
}

std::string stays_above(const Method&, const Track& run) {
  double lowest = run.x[0](2, 0);
  for (const Positions& x : run.x) lowest = std::min(lowest, x.leftCols(4).row(2).minCoeff());
  if (lowest <= 0) return fmt::format("the plate gets to {:.3g} m, below the sheet", lowest);
  return lowest > 2.5e-3 ? fmt::format("the plate stays at {:.3g} m and meets nothing", lowest) : "";
}

}  // namespace

std::vector<Feature> contact_features() {
  return {impact_in_steps_of("contact", 1e-4),
          impact_in_steps_of("contact in short steps", 1e-5),
          {"contact of points",
           "a plate passes a ball between its vertices, comes to the floor with 1 m/s and leaves with 1 m/s "
           "at most",
           {"inertia", "contact"},
           true,
           past_a_ball,
           leaves_with_no_more},
          {"audited pairs",
           "a plate that is thrown at a sheet, 10 mm a step, does not pass through it",
           {"inertia", "contact"},
           true,
           thrown_at_a_sheet,
           stays_above},
          {"restitution 0 and a force that lifts",
           "a plate at rest leaves with the acceleration of the force",
           {"contact", "restitution"},
           true,
           resting,
           leaves_freely},
          {"restitution 0.5",
           "a plate leaves with half of its speed at most",
           {"contact", "restitution"},
           true,
           bouncing,
           keeps_no_more_than_half}};
}

}  // namespace bb::features
