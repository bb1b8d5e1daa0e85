// Every integrator of the registry on the harmonic oscillator and in free fall.
#include <gtest/gtest.h>

#include <cmath>

#include "core/math/error.hpp"
#include "core/model/integrators/registry.hpp"

namespace bb::integrators_test {
namespace {

/// One particle, mass 1, force f0 - k x along x; the implicit step is solved in closed form:
/// (x - x_tilde)/(c h^2) = f0 - k x.
struct Particle {
  double k, f0;
  History history;
  Prediction prediction;
  Positions v, a;

  Particle(double stiffness, double force, double x0, double v0) : k(stiffness), f0(force) {
    history.x = history.v = history.a = Positions::Zero(3, 1);
    history.x(0) = x0;
    history.v(0) = v0;
    history.a(0) = force - stiffness * x0;
    history.x_prev = history.x;
    history.v_prev = history.v;
    a = Positions::Zero(3, 1);  // stays so where the integrator keeps none
  }
  void step(const Integrator& integrator, double dt) {
    integrator.predict(history, dt, prediction);
    const double weight = 1 / (prediction.c * dt * dt);
    Positions x = prediction.x_tilde;
    const double load = integrator.weight_factor() * f0;
    x.row(0).array() = (weight * prediction.x_tilde.row(0).array() + load) / (weight + k);
    integrator.finish(history, dt, prediction, x, v, a);
    history.x_prev = history.x;
    history.v_prev = history.v;
    history.x = x;
    history.v = v;
    history.a = a;
    ++history.steps;
  }
};

// |x - cos(2)| after t = 1 with omega = 2, from x = 1 at rest.
double oscillator_error(const Integrator& integrator, int steps) {
  Particle particle(4, 0, 1, 0);
  for (int i = 0; i < steps; ++i) particle.step(integrator, 1.0 / steps);
  return std::abs(particle.history.x(0) - std::cos(2.0));
}

int expected_order(std::string_view name) {
  return name == "implicit_euler" || name == "half_gravity" ? 1 : 2;
}

TEST(Integrators, reach_their_order_on_the_oscillator) {
  int tested = 0;
  for (const IntegratorEntry& entry : integrators()) {
    const auto integrator = make_integrator(entry.name);
    if (integrator->quasi_static()) continue;
    const double coarse = oscillator_error(*integrator, 200), fine = oscillator_error(*integrator, 400);
    ASSERT_GT(fine, 1e-9) << entry.name;
    const double order = std::log2(coarse / fine);
    EXPECT_NEAR(order, expected_order(entry.name), 0.1) << entry.name;
    ++tested;
  }
  EXPECT_GE(tested, 3);
}

TEST(Integrators, velocity_is_consistent_with_the_force) {
  int with_acceleration = 0;
  for (const IntegratorEntry& entry : integrators()) {
    const auto integrator = make_integrator(entry.name);
    if (integrator->quasi_static()) continue;
    Particle particle(0, -9.81, 0, 3);
    const double dt = 0.01;
    for (int i = 0; i < 50; ++i) particle.step(*integrator, dt);
    EXPECT_NEAR(particle.history.v(0), 3 - integrator->weight_factor() * 9.81 * 0.5, 1e-10) << entry.name;
    EXPECT_NEAR(particle.history.a(0), integrator->needs_acceleration() ? -9.81 : 0, 1e-9) << entry.name;
    with_acceleration += integrator->needs_acceleration() ? 1 : 0;
  }
  EXPECT_EQ(with_acceleration, 1);
}

TEST(Integrators, half_gravity_predicts_what_its_source_does_and_falls_with_half_of_it) {
  const auto integrator = make_integrator("half_gravity");
  for (const double dt : {0.1, 0.001}) {
    Particle particle(0, -9.81, 2, 3);
    particle.step(*integrator, dt);
    EXPECT_NEAR(particle.history.x(0), 2 + 3 * dt - 9.81 * dt * dt / 2, 1e-14);
    EXPECT_NEAR(particle.history.v(0), 3 - 9.81 * dt / 2, 1e-12);
    const int steps = static_cast<int>(std::lround(1 / dt));
    for (int i = 1; i < steps; ++i) particle.step(*integrator, dt);
    EXPECT_NEAR(particle.history.v(0), 3 - 9.81 / 2, 1e-9) << "of g after one second";
  }
  for (const IntegratorEntry& entry : integrators()) {
    const auto each = make_integrator(entry.name);
    EXPECT_EQ(each->weight_factor(), entry.name == "half_gravity" ? 0.5 : 1) << entry.name;
    EXPECT_EQ(each->one_step(), entry.name != "bdf2") << entry.name;
  }
}

TEST(Integrators, newmark_keeps_the_energy_of_the_oscillator_and_implicit_euler_does_not) {
  const auto energy_after = [](const char* name) {
    const auto integrator = make_integrator(name);
    Particle particle(4, 0, 1, 0);
    for (int i = 0; i < 1000; ++i) particle.step(*integrator, 0.01);
    return 0.5 * particle.history.v(0) * particle.history.v(0) +
           2 * particle.history.x(0) * particle.history.x(0);
  };

  EXPECT_NEAR(energy_after("newmark"), 2.0, 1e-10);
  EXPECT_LT(energy_after("implicit_euler"), 1.9);
}

TEST(Integrators, weights_are_those_of_the_design) {
  Particle fresh(1, 0, 1, 0);
  Prediction prediction;
  const auto bdf2 = make_integrator("bdf2");
  bdf2->predict(fresh.history, 0.1, prediction);
  EXPECT_EQ(prediction.c, 1.0);
  fresh.step(*bdf2, 0.1);
  bdf2->predict(fresh.history, 0.1, prediction);
  EXPECT_EQ(prediction.c, 4.0 / 9.0);
  make_integrator("newmark")->predict(fresh.history, 0.1, prediction);
  EXPECT_EQ(prediction.c, 0.25);
  make_integrator("quasi_static")->predict(fresh.history, 0.1, prediction);
  EXPECT_EQ(prediction.c, 0.0);
}

TEST(Integrators, unknown_name_lists_the_known_ones) {
  try {
    make_integrator("verlet");
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("verlet"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("newmark"), std::string::npos);
  }
}

}  // namespace
}  // namespace bb::integrators_test
