// What the contact term reports of its rows, and how far loads are beyond what they can carry.
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/contact/pair_name.hpp"
#include "core/terms/barrier_load.hpp"
#include "core/terms/contact.hpp"
#include "core/terms/row_report.hpp"

namespace bb {
namespace {

RowTotals totals_of(const ContactState& state) {
  RowTotals out = RowTotals::zero();
  const auto add = [&out](std::uint8_t kind, const auto& rows, std::size_t r) {
    out.add({kind, rows.d[r], rows.d_hat[r], rows.kappa[r], rows.force(r), rows.stiffness(r)});
  };
  for (std::size_t r = 0; r < state.rows.size(); ++r)
    add(static_cast<std::uint8_t>(state.rows.kind[r]), state.rows, r);
  for (std::size_t r = 0; r < state.mollified.size(); ++r) add(mollified_kind, state.mollified, r);
  return out;
}

void visit(const ContactState& state, const std::function<void(const EndRow&)>& f) {
  const auto visit_table = [&f](const auto& rows, bool mollified) {
    for (std::size_t r = 0; r < rows.size(); ++r)
      f({rows.pair[r], rows.key(r), rows.d[r], rows.d_hat[r], -rows.force(r), mollified});
  };
  visit_table(state.rows, false);
  visit_table(state.mollified, true);
}

/// What the rows of pairs with one closest feature share; their capacity goes with d_hat and offset.
using Feature = std::tuple<ContactKey, ContactKind, double, double>;

Feature feature_of(const ContactTable& rows, std::size_t r) {
  return {rows.key(r), rows.kind[r], rows.d_hat[r], rows.offset[r]};
}

// Stiffness of all rows of a feature, N/m: they share what is put on it.
std::map<Feature, double> stiffness_of_features(const ContactTable& rows) {
  std::map<Feature, double> out;
  for (std::size_t r = 0; r < rows.size(); ++r) out[feature_of(rows, r)] += rows.kappa[r];
  return out;
}

}  // namespace

RowTotals ContactTerm::totals(const PositionsView&) { return totals_of(state_); }

void ContactTerm::visit_rows(const PositionsView&, const std::function<void(const EndRow&)>& f) {
  visit(state_, f);
}

void report_end_of(const ContactState& state, Precision precision, const PositionsView& x, StepNumbers& out) {
  report_rows_of_end(
      totals_of(state), state.gap_min, precision, [&x] { return x.cwiseAbs().maxCoeff(); },
      [&state](const auto& f) { visit(state, f); }, out);
}

// The larger of two estimates of the load of a row: what everything but contact puts on it on its own, and
// the force at which the Newton model would come to rest, which knows how loads are shared but yields where
// the barrier would have to hold.
void ContactTerm::report_overload(const PositionsView&, const PositionsView& others, const PositionsView& dx,
                                  StepNumbers& out) {
  out.contact_overload = 0;
  const BarrierFunction& barrier = options_.contact;
  if (barrier.shape.infinite_at_zero || folded_ || gap_potential_) return;
  const ContactTable& rows = state_.rows;
  LargestSlope slope(barrier);
  const std::map<Feature, double> stiffness = stiffness_of_features(rows);
  double largest = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows.kappa[r] < 0) continue;  // a correction carries nothing
    const Eigen::Map<const Vec3d> normal(&rows.normal[3 * r]);
    double push = 0, weight_sq = 0, opening = 0;
    for (std::size_t k = 0; k < 4 && rows.vertex[4 * r + k] >= 0; ++k) {
      const double weight = rows.weight[4 * r + k];
      push += weight * normal.dot(others.col(rows.vertex[4 * r + k]));
      opening += weight * normal.dot(dx.col(rows.vertex[4 * r + k]));
      weight_sq += weight * weight;
    }
    const double capacity = slope(rows.d_hat[r]);  // for kappa = 1
    const double load = push / weight_sq / stiffness.at(feature_of(rows, r));
    const double model = newton_force(barrier, rows.d[r], rows.d[r] + opening, rows.d_hat[r]);
    const double times = std::max(load, model) / capacity;
    if (!(times > largest)) continue;
    largest = times;
    out.contact_overload_at = pair_name(scene_, rows.key(r), rows.kind[r]);
  }
  out.contact_overload = largest;
}

}  // namespace bb
