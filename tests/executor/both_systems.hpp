// One scene that is in contact, in a system of the host and in one of an executor.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <utility>

#include "tests/executor/system_cases.hpp"

namespace bb::test {

/// Both systems at the start of a step of a scene that is in contact.
struct Both {
  Scene scene;
  Method of_cpu, of_executor;
  Plan plan;
  NewtonSystem cpu;
  ExecutorSystem there;

  Both(Scene in, const std::function<Method()>& method)
      : scene(std::move(in)),
        of_cpu(method()),
        of_executor(method()),
        plan(solved(of_cpu, of_executor)),
        cpu(scene, of_cpu, plan),
        there(std::make_unique<exec::HostExecutor>(), scene, of_executor, plan) {
    Prediction falling;
    falling.x_tilde = scene.x0;
    falling.x_tilde.row(scene.planar ? 1 : 2).array() -= 2e-3;
    Positions target = scene.x0;
    target.row(0).array() += 5e-4;
    for (StepSystem* system : systems()) {
      system->begin_step(scene.x0, falling, 0.01, 1);
      system->set_target(target);
      system->assemble();
    }
  }
  std::array<StepSystem*, 2> systems() { return {&cpu, &there}; }

 private:
  Plan solved(Method& a, Method& b) {
    use_executor_solver(a, 1e-13);
    use_executor_solver(b, 1e-13);
    return make_plan(scene, a, plan_options(a));
  }
};

inline Method touching_method() {
  Method method = fixed_method("cubic", 40);
  method.hessian_mode = HessianMode::projected_full;
  return method;
}

}  // namespace bb::test
