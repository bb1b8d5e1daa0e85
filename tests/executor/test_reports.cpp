// What both systems say of contacts, number by number.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/contact/moving_obstacles.hpp"
#include "tests/executor/both_systems.hpp"

namespace bb::exec_reports_test {
namespace {

using test::Both;
using test::touching_method;

void expect_near(const Number& found, const Number& expected, const char* what) {
  ASSERT_TRUE(found.finite() && expected.finite()) << what;
  ASSERT_GT(expected.value, 0) << what;
  EXPECT_NEAR(found.value, expected.value, 1e-12 * expected.value) << what;
}

/// What an iterate and the end of a step both say of contacts.
template <class Numbers>
void expect_same_contacts(const Numbers& found, const Numbers& expected) {
  EXPECT_EQ(found.contacts.point_point, expected.contacts.point_point);
  EXPECT_EQ(found.contacts.point_edge, expected.contacts.point_edge);
  EXPECT_EQ(found.contacts.point_triangle, expected.contacts.point_triangle);
  EXPECT_EQ(found.contacts.edge_edge, expected.contacts.edge_edge);
  EXPECT_EQ(found.contacts.obstacle, expected.contacts.obstacle);
  EXPECT_EQ(found.contacts.mollified, expected.contacts.mollified);
  ASSERT_GT(expected.contacts.total(), 0u);
  expect_near(found.kappa_min_N_per_m, expected.kappa_min_N_per_m, "kappa_min");
  expect_near(found.kappa_max_N_per_m, expected.kappa_max_N_per_m, "kappa_max");
  expect_near(found.contact_load_max_N, expected.contact_load_max_N, "load_max");
  expect_near(found.gap_min_iterates_m, expected.gap_min_iterates_m, "gap_min_iterates");
}

void expect_same_reports(Both& both, int& n_shared) {
  IterateNumbers iterate[2];
  StepNumbers end[2];
  for (const std::size_t k : {0, 1}) {
    both.systems()[k]->view().report(iterate[k]);
    both.systems()[k]->view().report_end(end[k]);
    end[k].gap_min_iterates_m = end[k].gap_min_m;
  }
  expect_same_contacts(iterate[1], iterate[0]);
  expect_same_contacts(end[1], end[0]);
  expect_near(iterate[1].contact_curvature_max_N_per_m, iterate[0].contact_curvature_max_N_per_m,
              "curvature");
  expect_near(end[1].contact_load_sum_N, end[0].contact_load_sum_N, "load_sum");
  expect_near(end[1].gap_min_rel, end[0].gap_min_rel, "gap_min_rel");
  ASSERT_EQ(end[1].contact_loads.size(), end[0].contact_loads.size());
  for (std::size_t i = 0; i < end[0].contact_loads.size(); ++i) {  // in one order: that of the pairs
    const ContactLoad &a = end[0].contact_loads[i], &b = end[1].contact_loads[i];
    EXPECT_EQ(b.key, a.key);
    EXPECT_EQ(b.gap_rel, a.gap_rel);
    EXPECT_NEAR(b.load_N, a.load_N, 1e-12 * a.load_N);
    n_shared += i > 0 && a.key == end[0].contact_loads[i - 1].key;
  }
}

TEST(ExecutorSystem, SaysTheSameOfContactsNumberByNumber) {
  int n_shared = 0;
  const auto compare = [&n_shared](const Scene& scene, const std::function<Method()>& method) {
    Both both(scene, method);
    expect_same_reports(both, n_shared);
    EXPECT_EQ(both.of_executor.stiffness->state().kappa_start > 0,
              both.of_cpu.stiffness->state().kappa_start > 0);
    EXPECT_NEAR(both.of_executor.stiffness->state().kappa_start, both.of_cpu.stiffness->state().kappa_start,
                1e-12 * both.of_cpu.stiffness->state().kappa_start);
  };
  const ParameterMap lagged = {{"mass_term", std::string("inertia")}, {"refresh", std::string("per_step")}};
  const std::function<Method()> methods[] = {
      touching_method, [] { return test::method_with_policy("log", "ipc_adaptive", {}); },
      [&] { return test::method_with_policy("cubic", "elasticity_inclusive", lagged); }};
  const Scene scenes[] = {test::touching(test::cloth_on_plate(), 0.012),
                          test::touching(test::two_sheets(), 0.01),
                          test::touching(test::cloth_on_balls_and_bar(), 0.02),
                          test::with_moving_obstacles(test::touching(test::cloth_on_balls_and_bar(), 0.02))};
  for (std::size_t m = 0; m < std::size(methods); ++m) {
    for (std::size_t s = 0; s < std::size(scenes); ++s) {
      SCOPED_TRACE("method " + std::to_string(m) + ", scene " + std::to_string(s));
      compare(scenes[s], methods[m]);
    }
  }
  EXPECT_GT(n_shared, 3);  // pairs with one closest feature
}

// The vertex by which an obstacle moves is no part of its contacts.
TEST(ExecutorSystem, NamesAnObstacleThatMovesAsOneThatStands) {
  const Scene still = test::touching(test::cloth_on_balls_and_bar(), 0.02);
  StepNumbers end[2];
  for (const std::size_t k : {0, 1}) {
    Both both(k == 0 ? still : test::with_moving_obstacles(still), touching_method);
    both.resident.view().report_end(end[k]);
  }
  ASSERT_GT(end[0].contact_loads.size(), 5u);
  ASSERT_EQ(end[1].contact_loads.size(), end[0].contact_loads.size());
  for (std::size_t i = 0; i < end[0].contact_loads.size(); ++i) {
    EXPECT_EQ(end[1].contact_loads[i].key, end[0].contact_loads[i].key);
    EXPECT_TRUE(
        std::ranges::any_of(end[1].contact_loads[i].key, [](int id) { return obstacle_of(id) >= 0; }));
  }
}

}  // namespace
}  // namespace bb::exec_reports_test
