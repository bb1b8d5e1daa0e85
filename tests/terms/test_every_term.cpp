// What every registered term has to hold, in a loop over the registry: a new term is tested without a line
// here, as long as scene_with_everything() needs it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/math/lower_blocks.hpp"
#include "tests/terms/at_iterate.hpp"

namespace bb::every_term_test {
namespace {

using test::AtIterate, test::curvature_along, test::gradient_of;

TEST(EveryTerm, is_needed_by_the_scene_of_this_test_and_made_from_the_plan) {
  const AtIterate at;
  std::size_t n = 0;
  for (const TermEntry& entry : term_entries()) {
    EXPECT_TRUE(at.plan.term(entry.name).needed) << entry.name;
    const bool made = std::any_of(at.terms.begin(), at.terms.end(), [&](const auto& term) {
      return term->name() == entry.name && term->size() > 0;
    });
    EXPECT_TRUE(made) << entry.name;
    ++n;
  }
  EXPECT_EQ(at.terms.size(), n);  // one membrane model
}

TEST(EveryTerm, says_why_it_is_not_needed) {
  const Scene empty;
  const TermOptions options = test::term_options();
  const Plan plan = make_plan(empty, options, {});
  for (const PlanItem& item : plan.terms) {
    EXPECT_FALSE(item.needed);
    EXPECT_FALSE(item.reason.empty());
  }
  EXPECT_EQ(plan.terms.size(), term_entries().size());
}

TEST(EveryTerm, has_the_gradient_of_its_energy) {
  AtIterate at;
  const double h = 1e-6;
  for (const auto& term : at.terms) {
    const Positions gradient = gradient_of(*term, at.x.cols());
    ASSERT_GT(gradient.norm(), 1e-6) << term->name();
    Positions numeric(3, at.x.cols());
    for (Eigen::Index i = 0; i < at.x.size(); ++i) {
      double energy[2];
      for (const int side : {0, 1}) {
        Positions to = at.x;
        to.data()[i] += side == 0 ? -h : h;
        ASSERT_TRUE(test::is_feasible(*term, at.x, to, at.clock));
        term->freeze(at.clock);
        term->evaluate(to);
        energy[side] = test::trial_energy(*term);
      }
      numeric.data()[i] = (energy[1] - energy[0]) / (2 * h);
    }
    EXPECT_LT((numeric - gradient).norm(), 1e-5 * gradient.norm()) << term->name();
  }
}

/// What projection leaves: lower blocks of a matrix that has no negative eigenvalue and is not 0.
TEST(EveryTerm, has_psd_hessians_unless_it_is_linear) {
  const AtIterate at;
  std::size_t judged = 0;
  for (const auto& term : at.terms) {
    double largest = 0;
    for (const TermFamily& family : term->families()) {
      const std::size_t stride = n_lower_numbers(static_cast<std::size_t>(family.stencils.width));
      for (std::size_t at_block = 0; at_block < family.local.hess.size(); at_block += stride) {
        const Eigen::VectorXd values = test::eigenvalues(family.stencils.width, &family.local.hess[at_block]);
        EXPECT_GE(values[0], -1e-9 * values[values.size() - 1]) << term->name();
        largest = std::max(largest, values[values.size() - 1]);
        ++judged;
      }
    }
    EXPECT_EQ(largest > 0, term->name() != "external_force") << term->name();
  }
  EXPECT_GT(judged, 30U);
}

/// Projection only adds curvature: along any direction H has at least what the gradient's difference shows.
TEST(EveryTerm, has_no_less_curvature_than_its_gradient_shows) {
  const AtIterate at;
  const double h = 1e-5;
  std::size_t curved = 0;
  for (int seed = 0; seed < 3; ++seed) {
    Positions dx = at.x;
    for (Eigen::Index i = 0; i < dx.size(); ++i)
      dx.data()[i] = std::sin(2.3 * static_cast<double>(i + 50 * seed));
    AtIterate before, after;
    before.move_to(at.x - h * dx);
    after.move_to(at.x + h * dx);
    for (std::size_t i = 0; i < at.terms.size(); ++i) {
      const double shown = (gradient_of(after.terms[i], dx.cols()) - gradient_of(before.terms[i], dx.cols()))
                               .cwiseProduct(dx)
                               .sum() /
                           (2 * h);
      const double had = curvature_along(at.terms[i], dx);
      EXPECT_GE(had, shown - 1e-4 * std::abs(shown) - 1e-9) << at.terms[i].name();
      curved += shown > 1e-6;
    }
  }
  EXPECT_GT(curved, 9U);  // three directions, and more than half of the terms
}

TEST(EveryTerm, changes_by_the_difference_of_its_energies) {
  AtIterate at;
  const Positions to = test::disturbed(at.scene, 0.006);
  at.trial(to);
  for (const auto& term : at.terms) {
    EnergyParts parts;
    term->change(at.x, to, parts);
    const double expected = test::trial_energy(*term) - test::iterate_energy(*term);
    ASSERT_NE(expected, 0) << term->name();
    const double size = test::magnitude_of(parts);
    EXPECT_NEAR(test::change_of(parts), expected, 1e-13 * size) << term->name();
    EXPECT_GE(size * (1 + 1e-12), std::abs(expected)) << term->name();
  }
}

TEST(EveryTerm, has_the_energy_of_the_trial_once_it_is_accepted) {
  AtIterate at;
  const Positions to = test::disturbed(at.scene, 0.006);
  at.trial(to);
  for (const auto& term : at.terms) {
    const double energy = test::trial_energy(*term);
    term->accept(at.clock);
    term->take_energies();
    EXPECT_EQ(test::iterate_energy(*term), energy) << term->name();
  }
}

TEST(EveryTerm, has_the_same_energy_of_an_iterate_that_was_accepted_without) {
  AtIterate at, other;
  const Positions to = test::disturbed(at.scene, 0.006);
  at.trial(to);
  for (std::size_t i = 0; i < at.terms.size(); ++i) {
    HostTerm &known = **(at.terms.begin() + static_cast<std::ptrdiff_t>(i)),
             &late = **(other.terms.begin() + static_cast<std::ptrdiff_t>(i));
    const double before = test::iterate_energy(late);
    late.prepare({other.scene.x0, to, Positions(to - other.scene.x0)}, other.clock);
    ASSERT_TRUE(test::is_feasible(late, other.x, to, other.clock)) << late.name();
    late.freeze(other.clock);
    late.accept(other.clock);
    late.evaluate_iterate(to);
    EXPECT_EQ(test::iterate_energy(late), test::trial_energy(known)) << late.name();
    EXPECT_NE(test::iterate_energy(late), before) << late.name();
  }
}

TEST(EveryTerm, allows_a_motion_up_to_its_bound_and_says_what_held_it) {
  AtIterate at;
  Positions dx = Positions::Zero(3, at.x.cols());
  dx.row(2).setConstant(-1);    // through the floor
  dx.row(0) = 3 * at.x.row(0);  // and far beyond the limit
  const Positions x1 = at.x + dx;
  int bounded = 0;
  for (const auto& term : at.terms) {
    IterateNumbers report;
    const Motion motion{at.x, x1, dx};
    term->prepare(motion, at.clock);
    const double alpha = test::bound(*term, motion, report, at.clock);
    EXPECT_EQ(alpha, std::min(report.alpha_ccd, report.alpha_strain)) << term->name();
    if (alpha == 1) continue;
    ++bounded;
    EXPECT_FALSE(term->describe_bound().empty()) << term->name();
    EXPECT_TRUE(test::is_feasible(*term, at.x, Positions(at.x + 0.99 * alpha * dx), at.clock))
        << term->name();
    EXPECT_FALSE(test::is_feasible(*term, at.x, Positions(at.x + dx), at.clock)) << term->name();
  }
  EXPECT_EQ(bounded, 2);  // contact and strain limit
}

}  // namespace
}  // namespace bb::every_term_test
