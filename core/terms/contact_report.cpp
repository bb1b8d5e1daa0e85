// What the contact term says of its rows: counts, gaps, kappa, loads.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "core/contact/pair_name.hpp"
#include "core/terms/barrier_load.hpp"
#include "core/terms/contact.hpp"

namespace bb {
namespace {

ContactCounts count_contacts(const ContactState& state) {
  ContactCounts counts;
  for (const ContactKind kind : state.rows.kind) {
    switch (kind) {
      case ContactKind::point_point:
        ++counts.point_point;
        break;
      case ContactKind::point_edge:
        ++counts.point_edge;
        break;
      case ContactKind::point_triangle:
        ++counts.point_triangle;
        break;
      case ContactKind::edge_edge:
        ++counts.edge_edge;
        break;
      case ContactKind::obstacle:
      case ContactKind::obstacle_edge:
      case ContactKind::obstacle_triangle:
        ++counts.obstacle;
        break;
    }
  }
  counts.mollified = state.mollified.size();
  return counts;
}

struct RowNumbers {
  double gap_min_rel = std::numeric_limits<double>::infinity();
  double kappa_min = std::numeric_limits<double>::infinity(), kappa_max = 0;
  double load_max = 0, load_sum = 0, curvature_max = 0;
};

// Loads and curvature without mollified rows: such a row has e(x) kappa |b'| and no load of its own.
RowNumbers measure(const ContactState& state) {
  RowNumbers out;
  state.for_each_table([&out](const auto& rows) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      out.kappa_min = std::min(out.kappa_min, rows.kappa[r]);
      out.kappa_max = std::max(out.kappa_max, rows.kappa[r]);
      out.gap_min_rel = std::min(out.gap_min_rel, rows.d[r] / rows.d_hat[r]);
    }
  });
  const ContactTable& rows = state.rows;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    out.curvature_max = std::max(out.curvature_max, rows.kappa[r] * rows.d2b[r]);
    out.load_max = std::max(out.load_max, -rows.kappa[r] * rows.db[r]);
    out.load_sum -= rows.kappa[r] * rows.db[r];
  }
  return out;
}

void list_loads(const ContactTable& rows, std::vector<ContactLoad>& out) {
  out.clear();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double load = -rows.kappa[r] * rows.db[r];
    if (load > 0) out.push_back({rows.key(r), rows.d[r] / rows.d_hat[r], load});
  }
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

// What an iterate and the end of a step both say, where there are rows.
template <class Numbers>
void fill(const RowNumbers& rows, Numbers& out) {
  out.kappa_min_N_per_m = rows.kappa_min;
  out.kappa_max_N_per_m = rows.kappa_max;
  out.contact_load_max_N = rows.load_max;
}

}  // namespace

void ContactTerm::report(const PositionsView&, IterateNumbers& out, PhaseClock&) {
  out.kappa_change_rel = kappa_change_;
  report_rows(state_, out);
}

void report_rows(const ContactState& state, IterateNumbers& out) {
  out.contacts = count_contacts(state);
  if (out.contacts.total() == 0) return;
  const RowNumbers rows = measure(state);
  fill(rows, out);
  out.gap_min_iterates_m = state.gap_min;
  out.gap_min_iterates_rel = rows.gap_min_rel;
  out.contact_curvature_max_N_per_m = rows.curvature_max;
}

void ContactTerm::report_end(const PositionsView& x, StepNumbers& out, PhaseClock&) {
  report_rows(state_, options_.precision, x, out);
}

void report_rows(const ContactState& state, Precision precision, const PositionsView& x, StepNumbers& out) {
  out.contacts = count_contacts(state);
  if (out.contacts.total() == 0) return;
  const RowNumbers rows = measure(state);
  fill(rows, out);
  out.contact_load_sum_N = rows.load_sum;
  list_loads(state.rows, out.contact_loads);
  out.gap_min_m = state.gap_min;
  out.gap_min_rel = rows.gap_min_rel;
  const double largest = x.cwiseAbs().maxCoeff();
  const double ulp = with_value_scalar(precision, [&]<class T>() -> double {
    const T at = static_cast<T>(largest);
    return std::nextafter(at, 2 * at) - at;
  });
  out.gap_min_ulps = state.gap_min / ulp;
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
