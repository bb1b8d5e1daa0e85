// Forces on vertices, and what acts on velocities.
#include <fmt/format.h>

#include <cmath>

#include "tests/features/feature.hpp"

namespace bb::features {
namespace {

using nlohmann::json;

double speed(const Track& run) { return run.velocity(run.t.size() - 1).z(); }

json scheduled(const Method& method) {
  json config = bare(method, 1e-3, 100);
  config["scene"].erase("gravity_m_per_s2");
  config["scene"]["gravity_schedule"] = {{{"time_s", 0.0}, {"gravity_m_per_s2", {0, 0, 0}}},
                                         {{"time_s", 0.1}, {"gravity_m_per_s2", {0, 0, -g}}}};
  ground(method, config, 25);
  return config;
}

std::string has_the_sum_of_its_weight(const Method& method, const Track& run) {
  const double t = run.t_end();
  if (method.still()) {
    for (int v = 0; v < 4; ++v) {
      const double way = -run.scene.mass[static_cast<std::size_t>(v)] * g / 25;
      if (auto wrong = differs("height", run.end()(2, v) - run.x[0](2, v), way, 1e-3 * std::abs(way));
          !wrong.empty())
        return wrong;
    }
    return {};
  }
  const double expected = -method.weight() * g / 0.1 * t * t / 2;
  return differs("speed", speed(run), expected, 0.03 * std::abs(expected));
}

json flying(const Method& method, double velocity) {
  json config = bare(method, 1e-3, 100);
  config["scene"]["bodies"][0] = plate("plate", 0, velocity);
  return config;
}

json braked(const Method& method) {
  json config = flying(method, 1);
  config["scene"]["bodies"][0]["material"]["lumping"] = "barycentric";  // as the drag of the triangles
  config["scene"]["air"]["normal_N_s_per_m3"] = 1000;                   // over the area that is 10 kg/s
  return config;
}

std::string slows_by_the_air(const Method&, const Track& run) {
  return differs("speed", speed(run), std::exp(-10 * run.t_end()), 0.02);
}

json damped(const Method& method) {
  json config = flying(method, 1);
  config["scene"]["velocity_damping"]["factor_per_s"] = 1e-3;
  return config;
}

std::string keeps_its_part(const Method&, const Track& run) {
  return differs("speed", speed(run), std::pow(1e-3, run.t_end()), 0.01);
}

json pulled(const Method& method) {
  json config = bare(method, 1e-3, 100);
  config["scene"]["gravity_m_per_s2"] = {0, 0, -g};
  config["scene"]["bodies"][0]["pins"] = {{{"all", true}, {"pull_N_per_m", 25}}};
  return config;
}

std::string swings_on_its_springs(const Method& method, const Track& run) {
  for (int v = 0; v < 4; ++v) {
    const double m = run.scene.mass[static_cast<std::size_t>(v)], rest = m * g * method.weight() / 25;
    const double part = method.still() ? 1 : 1 - std::cos(std::sqrt(25 / m) * run.t_end());
    const auto wrong = differs("height", run.end()(2, v) - run.x[0](2, v), -rest * part, 0.03 * rest);
    if (!wrong.empty()) return wrong;
  }
  return {};
}

constexpr double pressure = 10;  // Pa

json inflated(const Method& method) {
  json config = bare(method, 1e-3, 20);
  json& ball = config["scene"]["bodies"][0];
  ball["mesh"] = {{"generator", "icosphere"}, {"level", 1}, {"radius_m", 0.1}};
  ball["material"] = {{"model", "none"}, {"springs_N_per_m", 1e-3}, {"density_kg_per_m2", 1}};
  ball["pressure_Pa"] = pressure;
  ground(method, config, 25);
  return config;
}

/// The force of the pressure on each vertex: p times the gradient of the volume within.
Positions pressure_force(const Track& run) {
  Positions out = Positions::Zero(3, run.x[0].cols());
  for (const auto& [a, b, c] : run.scene.surface_triangles) {
    const Vec3d x = run.x[0].col(a), y = run.x[0].col(b), z = run.x[0].col(c);
    const Vec3d force = pressure / 6 * (y - x).cross(z - x);  // a third of the area
    for (const int v : {a, b, c}) out.col(v) += force;
  }
  return out;
}

std::string swells(const Method& method, const Track& run) {
  const Positions force = pressure_force(run);
  for (Eigen::Index v = 0; v < force.cols(); ++v) {
    const double m = run.scene.mass[static_cast<std::size_t>(v)], t = run.t_end();
    const double expected = force.col(v).norm() * (method.still() ? 1 / 25.0 : t * t / 2 / m);
    const double way = (run.end() - run.x[0]).col(v).dot(force.col(v).normalized());
    const auto wrong = differs("way", way, expected, 0.12 * expected);
    if (!wrong.empty()) return wrong;
  }
  return {};
}

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

}  // namespace

std::vector<Feature> load_features() {
  return {
      {"gravity over time",
       "the speed is the sum of the acceleration so far",
       {"external_force"},
       false,
       scheduled,
       has_the_sum_of_its_weight},
      {"pull", "every vertex swings on its spring", {"pull"}, false, pulled, swings_on_its_springs},
      {"drag", "the speed falls as exp(-C A t/m)", {"air_drag"}, true, braked, slows_by_the_air},
      {"velocity damping", "the speed falls by its factor", {"inertia"}, true, damped, keeps_its_part},
      {"inflation",
       "every vertex goes p dV/dx t^2/(2 m), on springs p dV/dx /k",
       {"inflation"},
       false,
       inflated,
       swells},
      {"stitches", "two plates swing towards each other", {"stitch"}, false, stitched, is_drawn_together}};
}

}  // namespace bb::features
