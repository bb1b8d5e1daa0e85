// Which directions are rounding: by the coordinates of a vertex and the size of its body, not by those of others.
#include "core/math/rounding_room.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/newton/saddle_scenes.hpp"

namespace bb::rounding_room_test {
namespace {

TEST(RoundingRoom, is_that_of_the_vertex_and_of_its_body) {
  const double eps = std::numeric_limits<double>::epsilon();
  const double near[] = {0.25, -0.5, 0}, far[] = {1e10, 0, 0}, origin[] = {0, 0, 0};
  EXPECT_TRUE(within_coordinate_rounding(-3.9 * eps, near, 0, eps));
  EXPECT_FALSE(within_coordinate_rounding(4.1 * eps, near, 0, eps));
  EXPECT_TRUE(within_coordinate_rounding(4.1 * eps, near, 1, eps));  // its neighbours are 1 m away
  EXPECT_TRUE(within_coordinate_rounding(1e-6, far, 1, eps));
  EXPECT_FALSE(within_coordinate_rounding(1e-300, origin, 0, eps));
  EXPECT_TRUE(within_coordinate_rounding(0, origin, 0, eps));
  EXPECT_FALSE(within_coordinate_rounding(std::nan(""), far, 1, eps));
}

/// The direction of a sheet's first iterate at several sizes, with or without a rigid body far away.
std::vector<DirectionSize> sizes(bool far_body) {
  const Scene scene = test::driven_sheet({.jitter = 1e-4, .far_body = far_body});
  Method method = test::saddle_method(SaddleRule::ignore);
  NewtonSystem system(scene, method);
  Prediction prediction;
  prediction.x_tilde = scene.x0;
  system.begin_step(scene.x0, prediction, test::sheet_dt, 1);
  system.assemble();
  system.set_target(system.view().x());
  EXPECT_EQ(system.find_direction().linear.status, LinearStatus::ok);
  EXPECT_GT(test::rows_of(system).size(), 0U);
  std::vector<DirectionSize> out;
  system.scale_direction(1e-6 / system.direction_size().inf_m);
  for (int k = 0; k < 4; ++k) {  // 1e-6, 1e-10, 1e-14, 1e-18 m
    out.push_back(system.direction_size());
    system.scale_direction(1e-4);
  }
  return out;
}

TEST(RoundingRoom, of_a_direction_is_that_of_its_own_body) {
  const std::vector<DirectionSize> alone = sizes(false), with_far = sizes(true);
  for (std::size_t k = 0; k < alone.size(); ++k) {
    EXPECT_EQ(alone[k].beyond_m, with_far[k].beyond_m) << k;
    EXPECT_EQ(alone[k].rounding_m, with_far[k].rounding_m) << k;
    EXPECT_EQ(std::max(alone[k].beyond_m, alone[k].rounding_m), alone[k].inf_m) << k;
  }
  EXPECT_EQ(alone[1].beyond_m, alone[1].inf_m);  // 1e-10 m of a sheet of 1 m
  EXPECT_EQ(alone[3].beyond_m, 0);
  EXPECT_EQ(alone[3].rounding_m, alone[3].inf_m);
  EXPECT_GT(alone[3].inf_m, 0);
}

/// A run with a rigid body at 1e10 m reports of its errors what the run without it says.
TEST(RoundingRoom, a_far_body_leaves_the_estimate_as_it_is) {
  struct Estimates final : StepObserver {
    void on_iteration(const IterationReport& report) override { of.push_back(report.error_estimate_m.value); }
    std::vector<double> of;
  };
  std::array<Estimates, 2> seen;
  for (const std::size_t far : {0, 1}) {
    const Scene scene = test::driven_sheet({.jitter = 1e-4, .far_body = far == 1});
    Method method = test::saddle_method(SaddleRule::escape);
    Simulation simulation(scene, method, test::sheet_dt, 1);
    const StepReport report = simulation.step(seen[far]);
    ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
    ASSERT_GT(report.contacts.total(), 0U);
    EXPECT_LT(report.end_error_tolerances.value, 1);
  }
  ASSERT_GT(seen[0].of.size(), 3U);
  ASSERT_EQ(seen[0].of.size(), seen[1].of.size());
  for (std::size_t i = 0; i < seen[0].of.size(); ++i) {
    EXPECT_TRUE(seen[0].of[i] == seen[1].of[i] || std::isinf(seen[1].of[i]) || std::isnan(seen[1].of[i]) ||
                std::abs(seen[1].of[i] - seen[0].of[i]) < 1e-3 * seen[0].of[i])
        << i;
  }
}

}  // namespace
}  // namespace bb::rounding_room_test
