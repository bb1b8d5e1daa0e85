// The Newton loop allocates nothing per contact or element once it is warm.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>

#include "tests/newton/counting_malloc.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::allocations_test {
namespace {

Scene two_layers(int n) {
  SceneBuilder builder("two layers", false, Vec3d(0, 0, -9.81), "test");
  for (int layer = 0; layer < 2; ++layer) {
    BodySpec spec = test::cloth_spec(n, 0.011 + 0.009 * layer, 0.01);
    spec.name = "layer" + std::to_string(layer);
    spec.mesh.vertices.row(0) *= 1 + 0.03 * layer;  // vertices not above vertices
    spec.material.bending = 1e-4;
    spec.material.limit = StrainLimitSpec{0.025, 0.025};
    builder.add_body(spec);
  }
  Obstacle floor;
  floor.name = "floor";
  floor.axis = Vec3d::UnitZ();
  builder.add_obstacle(floor);
  return builder.finish();
}

/// Allocations of every iteration whose matrix pattern did not change, from one report to the next.
class Watch final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override {
    const long now = test::n_mallocs();
    if (report.iteration > 0 && !report.pattern_changed && !report.solve.linear.analyzed) {
      counts.push_back(now - last_);
      contacts = std::max(contacts, report.contacts.total());
    }
    last_ = test::n_mallocs();
  }
  std::vector<long> counts;
  std::size_t contacts = 0;

 private:
  long last_ = 0;
};

struct Result {
  long median;
  std::size_t contacts;
};

Result allocations_per_iteration(int n, const char* policy_name) {
  const Scene scene = two_layers(n);
  Method method = test::fixed_method("cubic", 200);
  method.limit_stiffness = test::fixed_limit(1e3);
  PolicyConfig policy;
  policy.name = policy_name;
  policy.parameters["kappa_N_per_m"] = 200;
  policy.parameters.emplace("refresh", "per_step");
  method.stiffness = make_policy(policy);
  method.step_solver.tol_velocity = 1e-7;
  Simulation simulation(scene, method, 0.005, 16);
  Watch watch;
  for (int i = 0; i < 16; ++i) EXPECT_EQ(simulation.step(watch).status, StepStatus::converged) << i;
  std::vector<long> late(watch.counts.begin() + static_cast<std::ptrdiff_t>(watch.counts.size() / 2),
                         watch.counts.end());
  if (late.size() < 5) return {-1, 0};
  std::nth_element(late.begin(), late.begin() + static_cast<std::ptrdiff_t>(late.size() / 2), late.end());
  return {late[late.size() / 2], watch.contacts};
}

TEST(Allocations, do_not_grow_with_contacts_and_elements) {
  if (!test::counts_mallocs()) GTEST_SKIP() << "a sanitizer owns malloc";
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  for (const char* policy : {"fixed", "elasticity_inclusive"}) {
    const Result few = allocations_per_iteration(6, policy), many = allocations_per_iteration(14, policy);
    ASSERT_GT(few.contacts, 10U);
    ASSERT_GT(many.contacts, 4 * few.contacts);
    ASSERT_GT(few.median, 0) << "nothing was counted";
    EXPECT_LE(many.median, few.median + 8)
        << policy << ": " << few.median << " allocations with " << few.contacts << " contacts";
  }
}

}  // namespace
}  // namespace bb::allocations_test
