// The Hessians that a term offers to the Newton matrix: the exact one is the derivative of its gradient, the
// clamped and the absolute one are made of the same elements.
#include <cmath>

#include "core/math/lower_blocks.hpp"
#include "core/terms/step_hessian.hpp"
#include "tests/terms/at_iterate.hpp"

namespace bb::projections_test {
namespace {

/// Compressed one way and stretched the other, so that elements have negative eigenvalues and the limit acts.
/// Contact with the Hessian of the gap.
struct Compressed : test::AtIterate {
  Compressed() {
    options.hessian_mode = HessianMode::projected_full;
    Positions to = test::disturbed(scene, 0.006);
    to.row(0) *= 0.97;
    to.row(1) *= 1.03;
    compressed = to;
  }
  Positions compressed;
};

bool has_choice(const HostTerm& term) {
  for (const HessianChoice& choice : hessian_choices()) {
    if (choice.name == term.name()) return true;
  }
  return false;
}

Positions direction(Eigen::Index n, int seed) {
  return Positions::NullaryExpr(3, n, [seed](Eigen::Index r, Eigen::Index c) {
    return std::sin(2.3 * static_cast<double>(3 * c + r + 50 * seed));
  });
}

/// Of a column of local terms: the smallest eigenvalue over the largest, over all elements; how many of them
/// have one below -1e-6 of it.
int count_negative(const TermFamily& family, const std::vector<double>& hess) {
  const std::size_t stride = n_lower_numbers(static_cast<std::size_t>(family.stencils.width));
  int n = 0;
  for (std::size_t at = 0; at < hess.size(); at += stride) {
    const Eigen::VectorXd values = test::eigenvalues(family.stencils.width, &hess[at]);
    n += values[0] < -1e-6 * std::abs(values[values.size() - 1]) ? 1 : 0;
  }
  return n;
}

TEST(Projections, terms_with_a_choice_are_those_that_are_not_convex) {
  std::size_t n = 0;
  for (const TermEntry& entry : term_entries()) n += entry.convex ? 0 : 1;
  EXPECT_EQ(hessian_choices().size(), n);
  EXPECT_EQ(n, 10U);
}

TEST(Projections, the_exact_hessian_is_the_derivative_of_the_gradient) {
  const double h = 1e-6;
  for (int seed = 0; seed < 3; ++seed) {
    Compressed at, before, after;
    const Positions dx = direction(at.x.cols(), seed);
    at.move_to(at.compressed, Projection::none);
    before.move_to(at.compressed - h * dx, Projection::none);
    after.move_to(at.compressed + h * dx, Projection::none);
    for (std::size_t i = 0; i < at.terms.size(); ++i) {
      const Positions change =
          test::gradient_of(after.terms[i], dx.cols()) - test::gradient_of(before.terms[i], dx.cols());
      const double shown = change.cwiseProduct(dx).sum() / (2 * h);
      const double had = test::curvature_along(at.terms[i], dx);
      EXPECT_NEAR(had, shown, 1e-5 * std::abs(had) + 1e-7) << at.terms[i].name();
      EXPECT_EQ(had != 0, at.terms[i].name() != "external_force");
    }
  }
}

TEST(Projections, clamp_gives_what_linearising_with_psd_gives) {
  Compressed exact, clamped;
  exact.move_to(exact.compressed, Projection::none);
  clamped.move_to(exact.compressed, Projection::psd);
  int judged = 0, changed = 0;
  for (std::size_t i = 0; i < exact.terms.size(); ++i) {
    if (!has_choice(exact.terms[i])) continue;
    const_cast<HostTerm&>(exact.terms[i]).clamp(exact.x);
    for (std::size_t f = 0; f < exact.terms[i].families().size(); ++f) {
      const TermFamily &of_exact = exact.terms[i].families()[f], &of_clamped = clamped.terms[i].families()[f];
      EXPECT_EQ(of_exact.clamped.hess, of_clamped.local.hess) << exact.terms[i].name();
      EXPECT_EQ(of_exact.local.grad, of_clamped.local.grad) << exact.terms[i].name();
      EXPECT_EQ(count_negative(of_exact, of_exact.clamped.hess), 0) << exact.terms[i].name();
      changed += count_negative(of_exact, of_exact.local.hess) > 0 ? 1 : 0;
      ++judged;
    }
  }
  EXPECT_GE(judged, 6);
  EXPECT_GE(changed, 4);  // membrane, springs, hinges, contact
}

TEST(Projections, absolute_has_no_negative_eigenvalue_and_at_least_the_clamped_curvature) {
  Compressed at, clamped;
  at.move_to(at.compressed, Projection::absolute);
  clamped.move_to(at.compressed, Projection::psd);
  int more = 0;
  for (std::size_t i = 0; i < at.terms.size(); ++i) {
    if (!has_choice(at.terms[i])) continue;
    for (const TermFamily& family : at.terms[i].families()) {
      EXPECT_EQ(count_negative(family, family.local.hess), 0) << at.terms[i].name();
    }
    const Positions dx = direction(at.x.cols(), 1);
    const double absolute = test::curvature_along(at.terms[i], dx);
    const double psd = test::curvature_along(clamped.terms[i], dx);
    EXPECT_GE(absolute, psd * (1 - 1e-12)) << at.terms[i].name();
    more += absolute > psd * (1 + 1e-6) ? 1 : 0;
  }
  EXPECT_GE(more, 3);
}

}  // namespace
}  // namespace bb::projections_test
