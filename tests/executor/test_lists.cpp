// Motions whose candidate lists would take too much memory: the bound is found in the trees, and nothing else differs.
#include <gtest/gtest.h>

#include "core/exec/counting_executor.hpp"
#include "tests/executor/system_cases.hpp"

namespace bb::exec_lists_test {
namespace {

constexpr std::size_t no_lists = 0, all_lists = std::size_t{1} << 40;  // B

/// Counts launches of kernels by what their names contain.
class WatchingExecutor final : public exec::HostExecutor {
 public:
  int in_trees = 0, in_lists = 0;

 private:
  void run(const exec::KernelInfo& kernel, exec::Index n, const void* f) override {
    const std::string name = kernel.name();
    in_trees += name.find("AskInTree") != std::string::npos ? 1 : 0;
    in_lists += name.find("AskPairs") != std::string::npos ? 1 : 0;
    HostExecutor::run(kernel, n, f);
  }
};

/// A system in front of a motion far beyond contact.
struct AtAMotion {
  Scene scene = test::cloth_on_plate();  // farther apart than d_hat
  Method method = test::fixed_method("cubic", 40);
  WatchingExecutor* executor = nullptr;  // of the system
  std::unique_ptr<test::ExecutorSystem> system;

  explicit AtAMotion(std::size_t budget = all_lists) {
    test::use_executor_solver(method);
    auto own = std::make_unique<WatchingExecutor>();
    executor = own.get();
    const Plan plan = make_plan(scene, method, plan_options(method));
    system = std::make_unique<test::ExecutorSystem>(std::move(own), scene, method, plan);
    system->engine().set_list_budget(budget);
    Prediction falling{1, scene.x0};
    falling.x_tilde.row(2).array() -= 2e-3;
    system->begin_step(scene.x0, falling, 0.01, 1);
    system->set_target(system->view().x());
    system->assemble();
    EXPECT_EQ(system->find_direction().linear.status, LinearStatus::ok);
    system->scale_direction(30);
  }
  StepBound bound() {
    IterationReport report;
    system->bound_motion(report);
    return report.bound;
  }
  StepBound prepare_and_bound() {
    system->prepare_motion(MotionEnd::free, true);
    return bound();
  }
  std::size_t bytes_of_lists() const {
    std::size_t out = 0;
    for (const auto& [name, bytes] : executor->memory().by_name())
      out += name.starts_with("candidates ") ? bytes : 0;
    return out;
  }
};

void expect_same(const StepBound& found, const StepBound& expected) {
  EXPECT_EQ(found.alpha, expected.alpha);
  EXPECT_EQ(found.kind, expected.kind);
  EXPECT_EQ(found.key, expected.key);
}

TEST(ExecutorLists, OfAMotionAreLeftOutBeyondTheirBudget) {
  AtAMotion listed, unlisted(no_lists);
  const StepBound expected = listed.prepare_and_bound(), found = unlisted.prepare_and_bound();
  ASSERT_GT(expected.alpha, 0);
  ASSERT_LT(expected.alpha, 1);
  ASSERT_NE(expected.kind, ContactKind::obstacle);
  expect_same(found, expected);
  EXPECT_EQ(unlisted.system->view().describe_bound(), listed.system->view().describe_bound());
  EXPECT_EQ(listed.executor->in_trees, 0);
  EXPECT_EQ(unlisted.executor->in_lists, 0);
  EXPECT_GT(listed.executor->in_lists, 0);
  EXPECT_GT(unlisted.executor->in_trees, 0);
  EXPECT_EQ(unlisted.bytes_of_lists(), 0u);
  for (const double part : {0.1, 0.9}) {
    const auto to = listed.system->try_motion(part * expected.alpha),
               same = unlisted.system->try_motion(part * expected.alpha);
    ASSERT_TRUE(to && same);
    ASSERT_NE(to->change, 0);
    EXPECT_EQ(same->change, to->change);
    EXPECT_EQ(unlisted.system->view().energy(), listed.system->view().energy());
    EXPECT_EQ(unlisted.system->direction_curvature(), listed.system->direction_curvature());
    expect_same(unlisted.bound(), expected);  // the trees were those of a state
  }
}

TEST(ExecutorLists, OfALimitedMemoryTakeHalfOfWhatIsLeft) {
  AtAMotion free, limited;
  const StepBound expected = free.prepare_and_bound();
  const std::size_t bytes = free.bytes_of_lists();
  ASSERT_GT(bytes, limited.bytes_of_lists());
  limited.executor->limit_memory(limited.executor->memory().bytes() + bytes);
  expect_same(limited.prepare_and_bound(), expected);
  EXPECT_GT(limited.executor->in_trees, 0);
  EXPECT_EQ(limited.executor->in_lists, 0);
  limited.executor->limit_memory(limited.executor->memory().bytes() + 4 * bytes);
  expect_same(limited.prepare_and_bound(), expected);
  EXPECT_GT(limited.executor->in_lists, 0);
}

struct WatchedRun {
  test::RunEnd end;
  int in_trees = 0;
};

WatchedRun watched_run(std::size_t budget, exec::Index frugal_from) {
  Method method = test::fixed_method("cubic", 20);
  method.hessian_mode = HessianMode::projected_full;
  test::use_executor_solver(method);
  WatchingExecutor* executor = nullptr;
  const auto make = [&executor] {
    auto own = std::make_unique<WatchingExecutor>();
    executor = own.get();
    return own;
  };
  method.make_potential = test::on_executor(make, [=](exec::ExecutorEngine& potential) {
    potential.set_list_budget(budget);
    potential.set_frugal_from(frugal_from);
  });
  const Scene scene = test::cloth_on_plate();
  Simulation simulation(scene, method, 0.01, 10);
  return {test::run_steps(simulation, 10), executor->in_trees};
}

TEST(ExecutorLists, ChangeNoBitOfARun) {
  constexpr exec::Index never = exec::Index{1} << 40;
  const WatchedRun listed = watched_run(all_lists, never);
  ASSERT_GT(listed.end.contacts, 20u);
  ASSERT_EQ(listed.in_trees, 0);
  for (const exec::Index frugal_from : {never, exec::Index{1}}) {
    const WatchedRun unlisted = watched_run(no_lists, frugal_from);
    EXPECT_GT(unlisted.in_trees, 10);
    EXPECT_EQ(unlisted.end.x, listed.end.x);
    EXPECT_EQ(unlisted.end.iterations, listed.end.iterations);
    EXPECT_EQ(unlisted.end.contacts, listed.end.contacts);
    EXPECT_EQ(unlisted.end.kappa_max, listed.end.kappa_max);
  }
}

TEST(ExecutorLists, AreCountedWhereOnlyStatesHaveThem) {
  const Scene scene = test::cloth_on_plate();
  Method method = test::fixed_method("cubic", 20);
  test::use_executor_solver(method);
  const Plan plan = make_plan(scene, method, plan_options(method));
  test::ExecutorSystem system(std::make_unique<exec::CountingExecutor>(), scene, method, plan);
  system.engine().set_list_budget(no_lists);
  exec::ExpectedContacts expected;
  expected.rows = 1 << 20;
  expected.candidates.edge_edge = 2 << 20;
  exec::count_memory(system, system.engine(), scene, expected);
  EXPECT_GE(system.memory().at_peak().at("candidates edge-edge"), std::size_t{16} << 20);
}

}  // namespace
}  // namespace bb::exec_lists_test
