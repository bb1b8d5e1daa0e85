// Curvature corrections on an executor: those of the CPU path, whatever memory is given back meanwhile.
#include <gtest/gtest.h>

#include "tests/executor/system_cases.hpp"
#include "tests/newton/curved_gaps.hpp"

namespace bb::system_curvature_correction_test {
namespace {

struct End {
  Positions x;
  long long detours = 0;
  int iterations = 0;
};

End take_steps(Method method) {
  const Scene scene = test::strip_on_disk();
  Simulation simulation(scene, method, test::rolling_dt, 3);
  StepObserver nobody;
  End end;
  for (int i = 0; i < 3; ++i) {
    const StepReport step = simulation.step(nobody);
    EXPECT_EQ(step.status, StepStatus::converged) << i << ": " << step.detail;
    end.detours += step.detours;
    end.iterations += step.newton_iterations;
  }
  end.x = simulation.history().x;
  return end;
}

/// On a host executor, rows and lists so.
Method executor_method(exec::Index frugal_from, std::size_t list_budget) {
  Method method = test::soft_method(1e-3);
  test::use_executor_solver(method);
  method.make_potential = test::on_executor([] { return std::make_unique<exec::HostExecutor>(); },
                                            [=](exec::ExecutorEngine& potential) {
                                              potential.set_frugal_from(frugal_from);
                                              potential.set_list_budget(list_budget);
                                            });
  return method;
}

TEST(ExecutorSystem, GoesRoundCurvedGapsAsTheCpuPathDoes) {
  Method method = test::soft_method(1e-3);
  test::use_executor_solver(method);
  const End cpu = take_steps(std::move(method));
  EXPECT_GT(cpu.detours, 0);
  EXPECT_LT(cpu.iterations, 60);
  constexpr std::size_t all_lists = std::size_t{1} << 40;
  const End there = take_steps(executor_method(1000, all_lists));
  EXPECT_EQ(there.detours, cpu.detours);
  EXPECT_NEAR(there.iterations, cpu.iterations, 2);
  EXPECT_LT((there.x - cpu.x).cwiseAbs().maxCoeff(), 1e-7);
  for (const auto& [frugal_from, budget] :
       {std::pair<exec::Index, std::size_t>{0, all_lists}, {1000, 0}, {0, 0}}) {
    const End other = take_steps(executor_method(frugal_from, budget));
    EXPECT_TRUE(other.x == there.x) << frugal_from << " " << budget;
    EXPECT_EQ(other.detours, there.detours);
  }
}

}  // namespace
}  // namespace bb::system_curvature_correction_test
