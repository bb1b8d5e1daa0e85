// Constraints that terms offer beside their energy: values, gradients and compliances against the energies, closed forms
// and gaps that are found anew.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "core/terms/contact.hpp"
#include "tests/terms/at_iterate.hpp"

namespace bb::constraints_test {
namespace {

using test::AtIterate;
using Batches = std::vector<const ConstraintBatch*>;

Batches constraints_of(AtIterate& at, std::string_view name, const Positions& x,
                       Inequalities inequalities = Inequalities::rigid) {
  Batches out;
  const ConstraintRequest request{x, inequalities, at.clock};
  for (const auto& term : at.terms) {
    if (term->name() == name) term->add_constraints(request, out);
  }
  return out;
}

const HostTerm& term_of(const AtIterate& at, std::string_view name) {
  for (const auto& term : at.terms) {
    if (term->name() == name) return *term;
  }
  throw std::logic_error("no such term");
}

double along(const ConstraintBatch& batch, std::size_t e, const std::vector<double>& gradient,
             const Positions& dx) {
  const auto width = static_cast<std::size_t>(batch.width());
  double sum = 0;
  for (std::size_t a = 0; a < width; ++a) {
    const int vertex = batch.vertices()[width * e + a];
    if (vertex >= 0) sum += Vec3d::Map(&gradient[3 * a]).dot(dx.col(vertex));
  }
  return sum;
}

TEST(Constraints, are_offered_by_springs_stitches_and_contact_alone) {
  AtIterate at;
  std::set<std::string> names;
  for (const auto& term : at.terms) {
    Batches batches;
    term->add_constraints({at.x, Inequalities::rigid, at.clock}, batches);
    EXPECT_EQ(term->offers_constraints(), !batches.empty()) << term->name();
    if (!batches.empty()) names.emplace(term->name());
  }
  EXPECT_EQ(names, (std::set<std::string>{"contact", "springs", "stitch"}));
}

TEST(Constraints, of_springs_have_their_energies_and_closed_forms) {
  AtIterate at;
  const Batches batches = constraints_of(at, "springs", at.x);
  ASSERT_EQ(batches.size(), 1U);
  const ConstraintBatch& springs = *batches[0];
  const std::vector<double>& energy = term_of(at, "springs").families()[0].local.energy;
  ASSERT_EQ(springs.size(), energy.size());
  ASSERT_GT(springs.size(), 10U);
  EXPECT_EQ(springs.kind(), ConstraintKind::equality);
  std::vector<double> gradient(6);
  double largest = 0;
  for (std::size_t e = 0; e < springs.size(); ++e) {
    const int a = springs.vertices()[2 * e], b = springs.vertices()[2 * e + 1];
    const double value = springs.value(e, at.x, gradient.data());
    const Vec3d way = at.x.col(b) - at.x.col(a);
    EXPECT_DOUBLE_EQ(value, way.norm() - (at.scene.rest.col(b) - at.scene.rest.col(a)).norm());
    EXPECT_LT((Vec3d::Map(&gradient[3]) - way.normalized()).norm(), 1e-15);
    EXPECT_LT((Vec3d::Map(&gradient[0]) + way.normalized()).norm(), 1e-15);
    EXPECT_EQ(springs.compliance()[e], 1 / at.scene.springs.stiffness[e]);
    EXPECT_NEAR(value * value / (2 * springs.compliance()[e]), energy[e], 1e-14 * energy[e]);
    largest = std::max(largest, energy[e]);
  }
  EXPECT_GT(largest, 1e-6);
}

/// Of contact the gap is that of rows which are found anew on either side.
TEST(Constraints, have_the_gradients_of_their_values) {
  AtIterate at;
  const double h = 1e-7;
  Positions dx = test::disturbed(at.scene, 1) - at.scene.x0;
  for (const char* name : {"springs", "contact"}) {
    const Positions sides[2] = {at.x - h * dx, at.x + h * dx};
    std::vector<double> moved[2], gradient(12);
    for (const int side : {0, 1}) {
      const ConstraintBatch& here = *constraints_of(at, name, at.x).at(0);
      moved[side].assign(here.size(), std::numeric_limits<double>::quiet_NaN());
      const ConstraintBatch& there = *constraints_of(at, name, sides[side]).at(0);
      for (std::size_t e = 0; e < there.size(); ++e) {
        if (there.before(e) < 0) continue;
        moved[side][static_cast<std::size_t>(there.before(e))] = there.value(e, sides[side], gradient.data());
      }
    }
    const ConstraintBatch& here = *constraints_of(at, name, at.x).at(0);
    int compared = 0;
    for (std::size_t e = 0; e < here.size(); ++e) {
      if (std::isnan(moved[0][e]) || std::isnan(moved[1][e])) continue;
      here.value(e, at.x, gradient.data());
      const double numeric = (moved[1][e] - moved[0][e]) / (2 * h), closed = along(here, e, gradient, dx);
      EXPECT_NEAR(numeric, closed, 1e-6) << name << " " << e;
      compared += std::abs(closed) > 1e-3;
    }
    EXPECT_GT(compared, 10) << name;
  }
}

TEST(Constraints, of_contact_are_the_gaps_of_its_rows_rigid_or_as_compliant_as_kappa) {
  AtIterate at;
  const ContactState& rows = contact_state(at.terms);
  ASSERT_GT(rows.rows.size(), 10U);
  ASSERT_GT(rows.mollified.size(), 0U);
  for (const Inequalities asked : {Inequalities::rigid, Inequalities::compliant}) {
    const ConstraintBatch& gaps = *constraints_of(at, "contact", at.x, asked).at(0);
    ASSERT_EQ(gaps.size(), rows.size());
    EXPECT_EQ(gaps.kind(), ConstraintKind::inequality);
    std::vector<double> gradient(12);
    for (std::size_t r = 0; r < rows.rows.size(); ++r) {
      EXPECT_NEAR(gaps.value(r, at.x, gradient.data()), rows.rows.d[r], 1e-14);
      const double own = 1.0 / 40;  // of the scene's fixed kappa
      EXPECT_DOUBLE_EQ(gaps.compliance()[r], asked == Inequalities::rigid ? 0 : own);
    }
    for (std::size_t r = 0; r < rows.mollified.size(); ++r)
      EXPECT_NEAR(gaps.value(rows.rows.size() + r, at.x, gradient.data()), rows.mollified.d[r], 1e-14);
  }
}

}  // namespace
}  // namespace bb::constraints_test
