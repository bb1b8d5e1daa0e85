// A step that goes on with another length (accumulated_toi): every number of the iterate is that of the new length, as
// on the CPU path.
#include <gtest/gtest.h>

#include <functional>

#include "tests/barriers/limit_policies.hpp"
#include "tests/executor/system_cases.hpp"

namespace bb::system_restart_test {
namespace {

constexpr double dt = 0.01;

/// What an iterate says.
struct Iterate {
  double energy, kappa_max, limit_load_max, curvature, slope;
  Positions gradient;
};

/// A step of dt from the touching start, assembled; then again as one of `length`.
struct Restarted {
  Scene scene = test::touching(test::cloth_on_plate(), 0.012);
  Method method;
  Plan plan;

  explicit Restarted(Method given) : method(std::move(given)), plan(plan_of()) {}
  Plan plan_of() {
    test::use_executor_solver(method, 1e-13);
    return make_plan(scene, method, plan_options(method));
  }
  Prediction predicted(double length, double c) const {
    Prediction out;
    out.c = c;
    out.x_tilde = scene.x0;
    out.x_tilde.row(2).array() -= 0.2 * length;
    return out;
  }
  static Iterate iterate(StepSystem& system) {
    system.assemble();
    system.set_target(system.view().x());
    EXPECT_EQ(system.find_direction().linear.status, LinearStatus::ok);
    IterateNumbers numbers;
    system.view().report(numbers);
    EXPECT_GT(numbers.contacts.total(), 0U);
    return {
        system.view().energy(),       numbers.kappa_max_N_per_m.value, numbers.limit_load_max_N_per_m.value,
        system.direction_curvature(), system.direction_size().slope_J, system.view().gradient()};
  }
  std::pair<Iterate, Iterate> both_lengths(StepSystem& system, double length, double c) const {
    system.begin_step(scene.x0, predicted(dt, 1), dt, 1);
    Iterate whole = iterate(system);
    system.restart_step(predicted(length, c), length);
    return {std::move(whole), iterate(system)};
  }
};

struct Policy {
  const char *name, *mass_term, *refresh;
  bool follows;  // whether kappa has to change with the length
};

Method method_of(const Policy& policy) {
  Method method = test::fixed_method("cubic", 40);
  method.hessian_mode = HessianMode::projected_full;
  if (std::string(policy.name) == "fixed") return method;
  PolicyConfig config;
  config.name = policy.name;
  config.parameters.emplace("mass_term", policy.mass_term);
  config.parameters.emplace("refresh", policy.refresh);
  method.stiffness = make_policy(config);
  method.limit_stiffness = test::elastic_limit({.mass_term = MassTerm::inertia});
  return method;
}

void expect_same(const Iterate& found, const Iterate& expected, const char* what) {
  EXPECT_NEAR(found.energy, expected.energy, 1e-11 * std::abs(expected.energy)) << what;
  EXPECT_NEAR(found.kappa_max, expected.kappa_max, 1e-11 * expected.kappa_max) << what;
  EXPECT_NEAR(found.limit_load_max, expected.limit_load_max, 1e-9 * std::abs(expected.limit_load_max))
      << what;
  EXPECT_NEAR(found.curvature, expected.curvature, 1e-8 * std::abs(expected.curvature)) << what;
  EXPECT_NEAR(found.slope, expected.slope, 1e-8 * std::abs(expected.slope)) << what;
  EXPECT_LT((found.gradient - expected.gradient).cwiseAbs().maxCoeff(),
            1e-10 * expected.gradient.cwiseAbs().maxCoeff())
      << what;
}

TEST(SystemRestart, TheNumbersOfAnIterateAreThoseOfTheNewLength) {
  const Policy policies[] = {{"fixed", "", "", false},
                             {"elasticity_inclusive", "inertia", "per_iteration", true},
                             {"elasticity_inclusive", "scaled", "per_iteration", true},
                             {"elasticity_inclusive", "paper", "per_iteration", false},
                             {"elasticity_inclusive", "inertia", "per_step", false}};
  for (const Policy& policy : policies) {
    for (const auto& [length, c] : {std::pair{0.4 * dt, 1.0}, {dt, 4.0 / 9}}) {
      const std::string what = std::string(policy.name) + " " + policy.mass_term + " " + policy.refresh;
      Restarted of_cpu(method_of(policy)), of_executor(method_of(policy));
      NewtonSystem cpu(of_cpu.scene, of_cpu.method, of_cpu.plan);
      test::ExecutorSystem resident(std::make_unique<exec::HostExecutor>(), of_executor.scene,
                                    of_executor.method, of_executor.plan);
      const auto expected = of_cpu.both_lengths(cpu, length, c),
                 found = of_executor.both_lengths(resident, length, c);
      expect_same(found.first, expected.first, (what + ", whole").c_str());
      expect_same(found.second, expected.second, (what + ", shorter").c_str());
      if (c != 1) {  // else it is m v^2/2, whatever the length
        EXPECT_NE(expected.second.energy, expected.first.energy);
      }
      EXPECT_NE(expected.second.curvature, expected.first.curvature);
      EXPECT_EQ(found.second.kappa_max > 1.5 * found.first.kappa_max, policy.follows) << what;
    }
  }
}

}  // namespace
}  // namespace bb::system_restart_test
