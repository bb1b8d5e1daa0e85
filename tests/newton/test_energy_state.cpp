// Energy differences term by term: exact where a difference of sums would be rounding noise.
#include <gtest/gtest.h>

#include "core/newton/energy_state.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb {
namespace {

StepTerms one_particle(double inertia) {
  StepTerms terms;
  terms.x_n = terms.x_tilde = Positions::Zero(3, 1);
  terms.inertia = {inertia};
  terms.force = test::one_point(0, 0, -2);
  return terms;
}

TEST(EnergyState, change_is_the_difference_of_the_totals) {
  StepTerms terms = one_particle(3);
  EnergyState a, b;
  a.x = test::one_point(0.1, 0, 0);
  b.x = test::one_point(0.3, 0.2, -0.1);
  a.element = {{1.0, 2.0}};
  b.element = {{1.5, 0.25}};
  a.contact = {0.5};
  b.contact = {0.25, 0.125};
  const EnergyChange change = energy_change(terms, a, b);
  ASSERT_NE(change.change, 0);
  EXPECT_NEAR(change.change, total_energy(terms, b) - total_energy(terms, a), 1e-15);
  EXPECT_GE(change.magnitude, std::abs(change.change));
}

TEST(EnergyState, a_change_far_below_the_rounding_of_the_total_is_seen) {
  StepTerms terms = one_particle(1e12);
  terms.force.setZero();
  EnergyState a, b;
  a.x = test::one_point(1, 0, 0);
  b.x = a.x;
  b.x(1) = 1e-9;  // moves E by 5e-7 J on top of 5e11 J
  const double change = energy_change(terms, a, b).change;
  EXPECT_NEAR(change, 0.5 * 1e12 * 1e-18, 1e-12);
}

}  // namespace
}  // namespace bb
