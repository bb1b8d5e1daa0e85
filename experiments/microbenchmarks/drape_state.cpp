#include "experiments/microbenchmarks/drape_state.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/linear/cholmod_factor.hpp"
#include "experiments/config/parse.hpp"

namespace bb::bench {
namespace {

constexpr int kIterations = 3;  // a step: enough to keep falling, E need not converge
constexpr int kMaxSteps = 40;

RunConfig drape_config(int n) {
  return parse_config(R"({"schema": "barrierbench.config/1", "scene": {"name": "drape", "layers": 5, "n": )" +
                          std::to_string(n) +
                          R"(}, "formulation": "log", "matching": {"rule": "equal_force"},
                             "strain_limit": {"shape": "log"}})",
                      "drape of the microbenchmarks");
}

Calibration stiffness(const RunConfig& config, const Scene& scene) {
  double weight = 0;
  for (const double mass : scene.mass) weight += mass * scene.gravity.norm();
  Calibration ones;
  ones.kappa = ones.k_s = 1.0;
  const Method probe = make_method(config, ones);
  const double d_hat = config.formulation.d_hat, width = config.strain_limit.width;
  const double per_vertex = weight / (scene.n_vertices() / 5.0);
  Calibration out;
  out.kappa = per_vertex / std::abs(probe.contact.eval(d_hat / 2, d_hat).db);
  out.k_s = weight / std::abs(probe.limit.eval(width / 2, width).db);  // the width of a sheet is 1 m
  return out;
}

/// Whether the sphere and every two neighbouring layers share a row.
bool all_touch(const Scene& scene, const ContactTable& rows) {
  std::set<int> lower;  // the lower layer of each touching pair, -1 for the sphere
  const auto body = [&](int vertex) { return scene.body[static_cast<std::size_t>(vertex)]; };
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (is_obstacle(rows.kind[r])) {
      lower.insert(-1);
      continue;
    }
    const int first = body(rows.key(r)[3]);
    for (const int vertex : rows.key(r)) {
      if (vertex >= 0 && body(vertex) != first) lower.insert(std::min(first, body(vertex)));
    }
  }
  return lower.size() == scene.bodies.size();
}

double median_factor_s(const ReducedSystem& matrix) {
  CholmodFactor factor;
  std::vector<double> seconds;
  for (int i = 0; i < 5; ++i) {
    factor.factorize(matrix);
    seconds.push_back(factor.factor_s());
  }
  std::nth_element(seconds.begin(), seconds.begin() + 2, seconds.end());
  return seconds[2];
}

std::unique_ptr<DrapeState> make_state(int n) {
  auto state = std::make_unique<DrapeState>();
  state->config = drape_config(n);
  state->scene = build_scene(state->config);
  state->method = make_method(state->config, stiffness(state->config, state->scene));
  state->method.step_solver.max_iterations = kIterations;
  state->simulation =
      std::make_unique<Simulation>(state->scene, state->method, state->config.time.dt, kMaxSteps);
  StepObserver nobody;
  for (int step = 0; step < kMaxSteps && !state->all_layers_touch; ++step) {
    state->simulation->step(nobody);
    state->all_layers_touch = all_touch(state->scene, contact_state(state->diagnosis().terms()).rows);
  }
  state->system().assemble();
  state->system().set_target(state->x());
  state->system().find_direction();
  state->dx = state->diagnosis().direction();
  state->x1 = state->x() + state->dx;
  state->factor_s = median_factor_s(state->diagnosis().solved());
  return state;
}

}  // namespace

DrapeState& drape_state(int n) {
  static std::map<int, std::unique_ptr<DrapeState>> states;
  std::unique_ptr<DrapeState>& state = states[n];
  if (!state) state = make_state(n);
  return *state;
}

}  // namespace bb::bench
