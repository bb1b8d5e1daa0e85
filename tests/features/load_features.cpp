// Forces on vertices, and what acts on velocities.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

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

/// Both triangles of the plate are right: a half at the right angle, quarters at the ends of the diagonal.
json braked_as_its_mass(const Method& method) {
  json config = braked(method);
  config["scene"]["bodies"][0]["material"]["lumping"] = "mixed_voronoi";
  config["scene"]["bodies"][0]["material"]["springs_N_per_m"] = 1e-3;
  return config;
}

std::string every_vertex_slows_alike(const Method&, const Track& run) {
  for (int v = 0; v < 4; ++v) {
    const double vz = run.v.back()(2, v);
    if (auto wrong = differs("speed of a vertex", vz, std::exp(-10 * run.t_end()), 0.02); !wrong.empty())
      return wrong;
  }
  return {};
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

/// On springs of k (N/m) times the weight of each vertex.
std::string swings(const Method& method, const Track& run, double k,
                   const std::function<double(const Vec3d&)>& weight) {
  for (int v = 0; v < 4; ++v) {
    const double own = k * weight(run.x[0].col(v));
    const double m = run.scene.mass[static_cast<std::size_t>(v)], rest = m * g * method.weight() / own;
    const double part = method.still() ? 1 : 1 - std::cos(std::sqrt(own / m) * run.t_end());
    const auto wrong = differs("height", run.end()(2, v) - run.x[0](2, v), -rest * part, 0.03 * rest);
    if (!wrong.empty()) return wrong;
  }
  return {};
}
std::string swings_on_its_springs(const Method& method, const Track& run) {
  return swings(method, run, 25, [](const Vec3d&) { return 1; });
}

/// A weight that rises along x from 0.25 at one side of the plate to 1 at the other, of two groups.
json weights_along_x() {
  return {{{"name", "along x"}, {"from_m", -0.05}, {"to_m", 0.05}},
          {{"name", "all"}, {"boxes", {{{"box_m", {{-9, -9, -9}, {9, 9, 9}}}}}}}};
}
json mix_along_x() {
  return {{{"group", "along x"}, {"influence", 0.75}}, {{"group", "all"}, {"influence", 0.25}}};
}

json pulled_by_weights(const Method& method) {
  json config = pulled(method);
  json& body = config["scene"]["bodies"][0];
  body["material"]["springs_N_per_m"] = 1e-3;
  body["weights"] = weights_along_x();
  body["pins"][0].update({{"pull_N_per_m", 50}, {"mix", mix_along_x()}});
  return config;
}

std::string swings_as_it_weighs(const Method& method, const Track& run) {
  return swings(method, run, 50, [](const Vec3d& x) { return x[0] > 0 ? 1 : 0.25; });
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

json inflated_by_weights(const Method& method) {
  json config = inflated(method);
  json& ball = config["scene"]["bodies"][0];
  ball["weights"] = weights_along_x();
  ball["pressure_mix"] = mix_along_x();
  return config;
}
double weight_along_x(const Vec3d& x) { return 0.25 + 0.75 * std::clamp(x[0] / 0.1 + 0.5, 0.0, 1.0); }

/// The force of the pressure on each vertex: p times the gradient of the volume within. weight: on the pressure.
Positions pressure_force(const Track& run, const std::function<double(const Vec3d&)>& weight) {
  Positions out = Positions::Zero(3, run.x[0].cols());
  for (const auto& [a, b, c] : run.scene.surface_triangles) {
    const Vec3d x = run.x[0].col(a), y = run.x[0].col(b), z = run.x[0].col(c);
    const double own = pressure * (weight(x) + weight(y) + weight(z)) / 3;
    const Vec3d force = own / 6 * (y - x).cross(z - x);  // a third of the area
    for (const int v : {a, b, c}) out.col(v) += force;
  }
  return out;
}

std::string goes_with_its_force(const Method& method, const Track& run, const Positions& force) {
  for (Eigen::Index v = 0; v < force.cols(); ++v) {
    const double m = run.scene.mass[static_cast<std::size_t>(v)], t = run.t_end();
    const double expected = force.col(v).norm() * (method.still() ? 1 / 25.0 : t * t / 2 / m);
    const double way = (run.end() - run.x[0]).col(v).dot(force.col(v).normalized());
    const auto wrong = differs("way", way, expected, 0.12 * expected);
    if (!wrong.empty()) return wrong;
  }
  return {};
}

std::string swells(const Method& method, const Track& run) {
  return goes_with_its_force(method, run, pressure_force(run, [](const Vec3d&) { return 1; }));
}
std::string swells_as_it_weighs(const Method& method, const Track& run) {
  return goes_with_its_force(method, run, pressure_force(run, weight_along_x));
}

}  // namespace

std::vector<Feature> load_features() {
  return {{"gravity over time",
           "the speed is the sum of the acceleration so far",
           {"external_force"},
           false,
           scheduled,
           has_the_sum_of_its_weight},
          {"pull", "every vertex swings on its spring", {"pull"}, false, pulled, swings_on_its_springs},
          {"pull by weights",
           "every vertex swings on its share of the stiffness",
           {"pull"},
           false,
           pulled_by_weights,
           swings_as_it_weighs},
          {"drag split as mass",
           "the speed of every vertex falls as exp(-C A t/m)",
           {"air_drag"},
           true,
           braked_as_its_mass,
           every_vertex_slows_alike},
          {"drag", "the speed falls as exp(-C A t/m)", {"air_drag"}, true, braked, slows_by_the_air},
          {"velocity damping", "the speed falls by its factor", {"inertia"}, true, damped, keeps_its_part},
          {"inflation",
           "every vertex goes p dV/dx t^2/(2 m), on springs p dV/dx /k",
           {"inflation"},
           false,
           inflated,
           swells},
          {"inflation by weights",
           "the same with the mean weight of each triangle",
           {"inflation"},
           false,
           inflated_by_weights,
           swells_as_it_weighs}};
}

}  // namespace bb::features
