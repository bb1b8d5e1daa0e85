// Launches return at once on a card: a wait belongs to the phase that made the work.
#include <gtest/gtest.h>

#include <map>

#include "tests/executor/both_systems.hpp"

namespace bb::exec_phases_test {
namespace {

/// Counts the launches that a phase waited for and another one had made.
class Waiter final : public exec::HostExecutor {
 public:
  PhaseClock* clock = nullptr;
  std::map<Phase, int> of_others;  // by the phase that waited
  int waits = 0;

  void synchronize() override { wait(); }
  void download(void* to, const void* from, std::size_t bytes) override {
    wait();
    HostExecutor::download(to, from, bytes);
  }

 protected:
  void run(const exec::KernelInfo& kernel, exec::Index n, const void* f) override {
    if (clock) ++pending_[phase()];
    HostExecutor::run(kernel, n, f);
  }

 private:
  Phase phase() {
    asks_ = true;  // a clock that waits at the ends of phases comes back here
    const Phase now = clock->change(Phase::output);
    clock->change(now);
    asks_ = false;
    return now;
  }
  void wait() {
    if (!clock || asks_) return;
    waits += !pending_.empty();
    for (const auto& [made_by, launches] : pending_) {
      if (made_by != phase()) of_others[phase()] += launches;
    }
    pending_.clear();
  }
  std::map<Phase, int> pending_;
  bool asks_ = false;
};

Method executor_method() {
  Method method = test::touching_method();
  test::use_executor_solver(method, 1e-10);
  return method;
}

/// Two sheets in contact on an executor that counts.
struct WaitedSystem {
  Scene scene = test::touching(test::two_sheets(), 0.01);
  Method method = executor_method();
  Plan plan = make_plan(scene, method, plan_options(method));
  std::unique_ptr<Waiter> made = std::make_unique<Waiter>();
  Waiter& waiter = *made;
  test::ExecutorSystem system{std::move(made), scene, method, plan};
};

/// Launches of a whole Newton iteration, line search and acceptance included, that another phase waited for.
int launches_of_others(bool synchronize) {
  WaitedSystem of;
  Waiter& waiter = of.waiter;
  auto& system = of.system;
  if (synchronize) dynamic_cast<exec::ExecutorEngine&>(system.potential()).synchronize_phases();
  waiter.clock = &system.clock();
  system.begin_step(of.scene.x0, {1, of.scene.x0}, 0.01, 1);
  system.set_target(of.scene.x0);
  system.assemble();
  system.find_direction();
  system.prepare_motion(MotionEnd::free, true);
  IterationReport report;
  const double bound = system.bound_motion(report);
  EXPECT_TRUE(system.try_motion(0.5 * bound));
  system.accept();
  system.assemble();
  waiter.synchronize();
  EXPECT_GT(waiter.waits, 10);
  int out = 0;
  for (const auto& [phase, launches] : waiter.of_others) out += launches;
  return out;
}

TEST(ExecutorPhases, EachWaitsForItsOwnLaunchesWhereThatIsAskedFor) {
  EXPECT_GT(launches_of_others(false), 0);
  EXPECT_EQ(launches_of_others(true), 0);
}

TEST(ExecutorPhases, AssemblyIsNotChargedToTheSolve) {
  WaitedSystem of;
  Waiter& waiter = of.waiter;
  auto& system = of.system;
  system.begin_step(of.scene.x0, {1, of.scene.x0}, 0.01, 1);
  system.assemble();
  waiter.clock = &system.clock();
  system.find_direction();
  EXPECT_GT(waiter.waits, 2);
  EXPECT_EQ(waiter.of_others[Phase::linear_solve], 0);
  system.assemble();
  EXPECT_EQ(waiter.of_others[Phase::contact_terms] + waiter.of_others[Phase::elastic], 0);
}

}  // namespace
}  // namespace bb::exec_phases_test
