// Friction against Coulomb's law: what slides, what sticks, and what begins to slide under a force that grows.
#include <fmt/format.h>

#include "tests/features/feature.hpp"

namespace bb::features {
namespace {

using nlohmann::json;

/// A plate that slides at 1 m/s; without inertia one that springs hold on a slope of 0.6.
json sliding(const Method& method, json friction) {
  json config = on_the_floor(method, 1e-3, method.still() ? 50 : 200);
  config["scene"]["gravity_m_per_s2"] = {method.still() ? 0.6 * g : 0.0, 0, -g};
  config["scene"]["bodies"][0]["velocity_m_per_s"] = {1, 0, 0};
  config["friction"] = std::move(friction);
  ground(method, config, 25);
  return config;
}

/// Half as much of the weight for some integrators, at the gap at which a barrier carries it from the start.
void rest(const Method& method, json& config) {
  const double load = g * method.weight() / 4, kappa = 4000;  // of each of four corners
  config["scene"]["bodies"][0]["transform"]["translate_m"] = {0, 0, 1e-3 - load / (2 * kappa)};
}

constexpr double ramp_end = 0.1, hold_end = 0.12, slip_end = 0.2, end = 0.3;  // s

/// A plate at rest under a force that grows to 0.99 of what its friction bears, stays for 20 ms, goes to 1.01 of it, then to 0.8 m g.
json slipping(const Method& method, json friction, double at_rest) {
  if (method.still()) return sliding(method, std::move(friction));
  json config = on_the_floor(method, 1e-3, 300);
  rest(method, config);
  config["friction"] = std::move(friction);
  config["scene"].erase("gravity_m_per_s2");
  config["scene"]["gravity_schedule"] = json::array();
  const auto key = [&](double time, double part) {
    config["scene"]["gravity_schedule"].push_back(
        {{"time_s", time}, {"gravity_m_per_s2", {part * g, 0, -g}}});
  };
  key(0, 0), key(ramp_end, 0.99 * at_rest), key(hold_end, 0.99 * at_rest);
  key(hold_end + 1e-6, 1.01 * at_rest), key(slip_end, 1.01 * at_rest);
  key(slip_end + 1e-6, 0.8), key(end, 0.8);
  return config;
}

constexpr double eps_v = 1e-3;  // m/s

json one_coefficient(double mu) { return {{"mu", mu}, {"eps_v_m_per_s", eps_v}}; }
json two_coefficients() {
  return {{"law", "static_kinetic"}, {"mu", 0.3}, {"mu_static", 0.5}, {"eps_v_m_per_s", eps_v}};
}
/// Ando's, whose matrix has the secant where the step solver can have it.
json published(const Method& method, double mu) {
  json out = {{"law", "capped"}, {"mu", mu}, {"eps_m", 1e-6}, {"refresh", "per_iteration"}};
  if (!method.solver.needs.minimum) out["hessian"] = "secant";
  return out;
}

std::string slows_by_mu_g(const Method& method, const Track& run) {
  const double lost = 0.3 * g * method.weight() * run.t_end();
  return differs("speed", run.velocity(run.t.size() - 1).x(), 1 - lost, 0.03 * lost);
}

/// One iteration, after which an accumulated time of impact may end a step, is none in which friction converges: the matrix has all
/// of the stiffness that it has at rest there.
json converging(const Method& method, json config) {
  if (method.solver.name == "accumulated_toi") config["step_solver"]["min_newton_steps"] = 32;
  return config;
}

/// What the springs of a plate that is still have let it slide by, in weights over their stiffness.
double way_of(const Track& run) { return (run.end() - run.x[0]).row(0).mean() * 100 / g; }

/// Sticks at 0.99 of its friction at rest, slides at 1.01, then by the kinetic coefficient: all to 1 % of what Coulomb's law states.
std::string slips_at(const Method& method, const Track& run, double at_rest, double kinetic) {
  const auto speed = [&](double time) { return run.velocity(run.at(time)).x(); };
  for (const double time : {0.5 * ramp_end, ramp_end, 0.5 * (ramp_end + hold_end), hold_end}) {
    if (!(std::abs(speed(time)) < eps_v))
      return fmt::format("at {:.3g} s the plate slides with {:.3g} m/s", time, speed(time));
  }
  if (!(speed(slip_end) > 2 * eps_v))
    return fmt::format("with 1.01 of its friction the plate gets {:.3g} m/s alone", speed(slip_end));
  const std::size_t from = run.at(slip_end + 0.02), to = run.t.size() - 1;
  const double weight = g * method.weight();
  const double found = (run.velocity(to) - run.velocity(from)).x() / (run.t[to] - run.t[from]);
  if (!(run.velocity(to).x() > 0.1)) return "the plate does not move";
  return differs("acceleration", found / weight, 0.8 - kinetic, 0.01 * at_rest);
}

/// Of one coefficient all of it is known; of two, that the friction is none that springs would pull it out of.
std::string stays_at(const Track& run, double at_rest, double kinetic) {
  const double way = way_of(run);
  if (std::abs(way - (0.6 - (at_rest + kinetic) / 2)) < (at_rest - kinetic) / 2 + 0.02) return "";
  return fmt::format("way is {:.6g}, not in {} to {}", way, 0.6 - at_rest, 0.6 - kinetic);
}

Feature slip(const char* name, const char* answer, const std::function<json(const Method&)>& friction,
             double at_rest, double kinetic) {
  return {
      name,
      answer,
      {"contact", "friction"},
      false,
      [=](const Method& method) { return converging(method, slipping(method, friction(method), at_rest)); },
      [=](const Method& method, const Track& run) {
        return method.still() ? stays_at(run, at_rest, kinetic) : slips_at(method, run, at_rest, kinetic);
      }};
}

Feature sliding_plate(const char* name, const char* answer,
                      const std::function<json(const Method&)>& friction, double load) {
  return {name,
          answer,
          {"contact", "friction"},
          false,
          [=](const Method& method) {
            json config = sliding(method, friction(method));
            return config["friction"].contains("refresh") ? converging(method, config) : config;
          },
          [=](const Method& method, const Track& run) {
            if (!method.still()) return slows_by_mu_g(method, run);
            return differs("way", way_of(run), 0.6 - 0.3 * load, 0.02);
          }};
}

}  // namespace

std::vector<Feature> friction_features() {
  const auto coulomb = [](double mu) { return [mu](const Method&) { return one_coefficient(mu); }; };
  const auto renewed = [](const Method&) {
    json out = one_coefficient(0.3);
    out["lag_iterations"] = 3;
    return out;
  };
  return {
      sliding_plate("friction",
                    "a plate slows by mu g; on springs, without inertia, it slides by (tan - mu) m g/k",
                    coulomb(0.3),
                    0.98),  // the load of the load step before
      sliding_plate("friction renewed", "the same, with the loads of the end of a step", renewed, 1),
      sliding_plate(
          "friction of every iterate", "the same, in Ando's form, with the loads of every iterate",
          [](const Method& method) { return published(method, 0.3); }, 1),
      slip(
          "a force that grows",
          "a plate sticks at 0.99 mu m g, slides at 1.01 mu m g and is sped up by the rest of a larger force",
          coulomb(0.5), 0.5, 0.5),
      slip(
          "a force that grows, two coefficients",
          "the same, at 0.99 and 1.01 of the static coefficient, then by the kinetic one",
          [](const Method&) { return two_coefficients(); }, 0.5, 0.3),
      slip(
          "a force that grows, every iterate", "the same, in Ando's form",
          [](const Method& method) { return published(method, 0.5); }, 0.5, 0.5)};
}

}  // namespace bb::features
