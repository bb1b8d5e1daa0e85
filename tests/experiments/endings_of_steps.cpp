// Small simulations that end in a step, each by another word.
#include <limits>

#include "experiments/run/outcome.hpp"
#include "tests/experiments/endings.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::test {
namespace {

class Watch final : public StepObserver {
 public:
  explicit Watch(Ending& out) : out_(out) {}
  void on_iteration(const IterationReport& report) override {
    out_.solves.emplace(to_string(report.linear_status));
    out_.contacts += static_cast<double>(report.contacts.total());
  }

 private:
  Ending& out_;
};

/// The steps of a simulation up to the first that does not converge, judged as a run's are.
Ending simulate(const Scene& scene, Method& method, int steps = 1) {
  Ending out;
  Watch watch(out);
  Simulation simulation(scene, method, 0.01, steps);
  for (int i = 0; i < steps && out.outcome == Outcome::ok; ++i) {
    const StepReport step = simulation.step(watch);
    const Verdict verdict = judge_step(step);
    out.steps.emplace(to_string(step.status));
    out.outcome = verdict.outcome;
    out.detail = verdict.detail;
  }
  return out;
}

Scene particle(double height = 1) { return particle_over_plane(0.2, height, 0.01); }

/// A shape whose energy does not belong to its force: no step along the force lowers E.
void inconsistent(void*, std::size_t n, const double* d, const double* d_hat, double* b, double* db,
                  double* d2b) {
  for (std::size_t i = 0; i < n; ++i) {
    const double depth = std::max(0.0, d_hat[i] - d[i]);
    b[i] = -depth * depth;
    db[i] = -2 * depth;
    d2b[i] = depth > 0 ? 2 : 0;
  }
}

}  // namespace

Ending floating_particle(const LinearOptions& linear) {
  Method method = fixed_method("log", 1, "quasi_static");
  method.linear = linear;
  return simulate(particle(), method);
}

Ending shape_without_a_potential() {
  Method method = fixed_method("cubic", 1e6);
  method.contact.shape = Shape{"inconsistent", "", 1, true, inconsistent, nullptr, nullptr};
  return simulate(particle(0.005), method);
}

Ending stiffness_that_overflows() {  // kappa b'' is infinite, the force is not
  Method method = fixed_method("cubic", 1);
  PolicyConfig steep;
  steep.parameters["kappa_N_per_m"] = 1.0;
  steep.scale = 1e308;
  method.stiffness = make_policy(steep);
  return simulate(particle(0.005), method);
}

Ending slope_that_underflows() {
  Scene scene = particle();
  scene.gravity = Vec3d(0, 0, -1e-170);
  Method method = fixed_method("log", 1);
  method.step_solver.tol_velocity = 1e-300;
  return simulate(scene, method);
}

Ending torn_cloth() {
  SceneBuilder builder("torn cloth", false, Vec3d::Zero(), "test");
  BodySpec spec = cloth_spec(3, 0, 0.001);
  spec.material.limit = StrainLimitSpec{0.01, 0.01};
  PinSpec left, right;
  left.indices = {0, 3, 6};
  right.indices = {2, 5, 8};
  right.motion.velocity = Vec3d(5, 0, 0);
  spec.pins = {left, right};
  builder.add_body(spec);
  Method method = fixed_method("log", 1);
  method.limit_stiffness = test::fixed_limit(10);
  return simulate(builder.finish(), method, 2);
}

Ending few_probes() {
  SceneBuilder builder("thrown cloths", false, Vec3d::Zero(), "test");
  BodySpec upper = cloth_spec(3, 0.03, 0.001), lower = cloth_spec(4, 0, 0.001);
  upper.name = "upper";
  upper.velocity = Vec3d(0, 0, -50);
  builder.add_body(upper);
  builder.add_body(lower);
  Method method = fixed_method("log", 1);
  method.contact_options.ccd_max_probes = 0;
  return simulate(builder.finish(), method, 5);
}

}  // namespace bb::test
