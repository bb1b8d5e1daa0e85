// Inertia and the work of the weight by hand, and a change that a difference of sums would not see.
#include <gtest/gtest.h>

#include "tests/terms/all_terms.hpp"

namespace bb::load_terms_test {
namespace {

Positions one_point(double x, double y, double z) {
  Positions point(3, 1);
  point << x, y, z;
  return point;
}

/// One particle of this mass under a weight of 2 N, or without one; the inertia weight is the mass.
struct Particle : test::TermsOf {
  Particle(double mass, bool weight, const Positions& x_n, const Positions& x_tilde)
      : TermsOf(scene_of(mass, weight), x_n, {x_n, x_tilde, 1, 1, 1}) {}
  static Scene scene_of(double mass, bool weight) {
    Scene scene;
    scene.rest = scene.x0 = one_point(0, 0, 0);
    scene.mass = {mass};
    scene.body = {0};
    if (weight) scene.gravity = Vec3d(0, 0, -2 / mass);
    return scene;
  }
  /// Sums over both terms.
  double energy(const Positions& x) {
    double sum = 0;
    for (const auto& term : terms) {
      term->linearise(x, context());
      sum += test::iterate_energy(*term);
    }
    return sum;
  }
  EnergyParts change(const Positions& x0, const Positions& x1) const {
    EnergyParts out;
    for (const auto& term : terms) term->change(x0, x1, out);
    return out;
  }
};

TEST(LoadTerms, inertia_and_work_by_hand) {
  const Positions x_n = one_point(0.05, 0, 0.3), x_tilde = one_point(0, 0.1, -0.2);
  Particle particle(3, true, x_n, x_tilde);
  ASSERT_EQ(particle.terms.size(), 2U);
  const double inertia = 0.5 * 3 * (0.05 * 0.05 + 0.1 * 0.1 + 0.5 * 0.5);
  EXPECT_NEAR(particle.energy(x_n), inertia, 1e-15);  // no work yet
  Positions down = x_n;
  down(2, 0) -= 0.5;  // to the height of x_tilde, 1 J of work
  const EnergyParts parts = particle.change(x_n, down);
  EXPECT_NEAR(test::change_of(parts), -0.5 * 3 * 0.25 - 1, 1e-15);
  EXPECT_NEAR(test::change_of(parts), particle.energy(down) - particle.energy(x_n), 1e-15);
  EXPECT_NEAR(test::magnitude_of(parts), inertia + (inertia - 0.5 * 3 * 0.25) + 1, 1e-15);
}

TEST(LoadTerms, a_change_far_below_the_rounding_of_the_total_is_seen) {
  const Positions origin = one_point(0, 0, 0);
  const Particle particle(1e12, false, origin, origin);
  ASSERT_EQ(particle.terms.size(), 1U);
  const Positions x0 = one_point(1, 0, 0), x1 = one_point(1, 1e-9, 0);  // 5e-7 J on top of 5e11 J
  EXPECT_NEAR(test::change_of(particle.change(x0, x1)), 0.5 * 1e12 * 1e-18, 1e-12);
}

TEST(LoadTerms, the_weight_grows_with_the_load_factor) {
  const Positions origin = one_point(0, 0, 0);
  Particle particle(3, true, origin, origin);
  for (const auto& term : particle.terms) term->begin_step({origin, origin, 1, 0, 0.25}, particle.clock);
  EXPECT_EQ(particle.energy(one_point(0, 0, 1)), 0.5);  // a quarter of 2 N, and no inertia with c = 0
}

}  // namespace
}  // namespace bb::load_terms_test
