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
  terms.x_n = test::one_point(0.05, 0, 0.3);
  terms.x_tilde = test::one_point(0, 0.1, -0.2);
  EnergyState a, b;
  a.x = test::one_point(0.1, 0, 0);
  b.x = test::one_point(0.3, 0.2, -0.1);
  const EnergyState a_alone = a, b_alone = b;
  const double moved = energy_change(terms, a_alone, b_alone).change;
  EXPECT_NEAR(moved, total_energy(terms, b_alone) - total_energy(terms, a_alone), 1e-15);
  // every other term by itself, so that none is left out of both
  struct Term {
    std::vector<double> from, to;
    std::vector<double>& (*of)(EnergyState&);
  };
  const auto element = [](EnergyState& s) -> std::vector<double>& { return s.element.emplace_back(); };
  const auto limit = [](EnergyState& s) -> std::vector<double>& { return s.limit; };
  const auto contact = [](EnergyState& s) -> std::vector<double>& { return s.contact; };
  const auto mollified = [](EnergyState& s) -> std::vector<double>& { return s.mollified_contact; };
  for (const Term& term : {Term{{1.0, 2.0}, {1.5, 0.25}, element}, Term{{3.0}, {5.0}, limit},
                           Term{{0.5}, {0.25, 0.125}, contact}, Term{{0.75}, {}, mollified}}) {
    EnergyState from = a_alone, to = b_alone;
    term.of(from) = term.from;
    term.of(to) = term.to;
    double difference = 0, magnitude = 0;
    for (const double e : term.to) difference += e, magnitude += e;
    for (const double e : term.from) difference -= e, magnitude += e;
    ASSERT_NE(difference, 0);
    const EnergyChange change = energy_change(terms, from, to);
    EXPECT_NEAR(change.change, moved + difference, 1e-15);
    EXPECT_NEAR(change.change, total_energy(terms, to) - total_energy(terms, from), 1e-15);
    EXPECT_NEAR(change.magnitude, energy_change(terms, a_alone, b_alone).magnitude + magnitude, 1e-15);
  }
}

TEST(EnergyState, inertia_and_work_by_hand) {
  StepTerms terms = one_particle(3);
  terms.x_n = test::one_point(0.05, 0, 0.3);
  terms.x_tilde = test::one_point(0, 0.1, -0.2);
  EnergyState at;
  at.x = terms.x_n;  // no work yet
  const double inertia = 0.5 * 3 * (0.05 * 0.05 + 0.1 * 0.1 + 0.5 * 0.5);
  EXPECT_NEAR(total_energy(terms, at), inertia, 1e-15);
  EnergyState down = at;
  down.x(2, 0) -= 0.5;  // to the height of x_tilde, 1 J of work
  EXPECT_NEAR(energy_change(terms, at, down).change, -0.5 * 3 * 0.25 - 1, 1e-15);
  EXPECT_NEAR(energy_change(terms, at, down).magnitude, inertia + (inertia - 0.5 * 3 * 0.25) + 1, 1e-15);
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
