// A particle that falls on a floor bounces with the share of its speed that was requested.
#include <gtest/gtest.h>

#include "tests/newton/small_scenes.hpp"

namespace bb::restitution_test {
namespace {

constexpr double d_hat = 0.01, speed = 1;  // m, m/s

struct Bounce {
  double kept = 0;     // of the speed at which the floor comes into reach
  int in_contact = 0;  // steps
};

/// A particle without weight that meets the floor with `speed`.
Bounce bounce(const std::string& shape, double kappa, double e, double dt) {
  Scene scene = test::particle_over_plane(0.2, 1.05 * d_hat, d_hat);
  scene.gravity.setZero();
  scene.v0 = test::one_point(0, 0, -speed);
  scene.obstacles[0].restitution = e;
  Method method = test::fixed_method(shape, kappa, "newmark");
  method.step_solver.tol_velocity = 1e-9;
  Simulation simulation(scene, method, dt, 100000);
  Bounce out;
  StepObserver observer;
  while (simulation.history().x(2, 0) < 1.1 * d_hat && out.in_contact < 50000) {
    const StepReport report = simulation.step(observer);
    EXPECT_EQ(report.status, StepStatus::converged) << report.detail;
    out.in_contact += static_cast<int>(report.contacts.total());
  }
  out.kept = simulation.history().v(2, 0) / speed;
  return out;
}

TEST(Restitution, IsTheShareOfSpeedThatABounceKeepsWithEveryShape) {
  struct Shape {
    const char* name;
    double kappa;
  };
  for (const Shape& shape : {Shape{"log", 3000}, Shape{"quadratic", 3000}, Shape{"cubic", 4e5}}) {
    SCOPED_TRACE(shape.name);
    EXPECT_NEAR(bounce(shape.name, shape.kappa, 1, 2e-5).kept, 1, 0.01);
    for (const double e : {0.8, 0.3}) {
      const Bounce fine = bounce(shape.name, shape.kappa, e, 2e-5);
      ASSERT_GT(fine.in_contact, 100);
      EXPECT_NEAR(fine.kept, e, 0.03) << "restitution " << e;
    }
  }
}

TEST(Restitution, IsMetToFirstOrderInTheTimeStep) {
  const double coarse = bounce("quadratic", 3000, 0.5, 8e-5).kept - 0.5;
  const double middle = bounce("quadratic", 3000, 0.5, 4e-5).kept - 0.5;
  const double fine = bounce("quadratic", 3000, 0.5, 2e-5).kept - 0.5;
  ASSERT_GT(std::abs(fine), 1e-5);
  EXPECT_NEAR((coarse - middle) / (middle - fine), 2, 0.4) << coarse << " " << middle << " " << fine;
}

}  // namespace
}  // namespace bb::restitution_test
