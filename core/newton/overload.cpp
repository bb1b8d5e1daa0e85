// How far a step that made no progress is beyond what bounded barriers can carry: the force that everything
// but contact puts on a row (everything but the limit on a limited element), over the largest force its
// barrier can answer with. An estimate: it gives a row the whole load of its vertices.
#include <algorithm>
#include <limits>

#include "core/newton/newton_system.hpp"

namespace bb {
namespace {

// Largest |b'(d)| over 0 <= d < d_hat for kappa = 1, m. Sampled: on the squared argument the force has its
// maximum inside the interval (at d_hat/sqrt(5) for the cubic), on the gap at 0.
double force_limit(const BarrierFunction& barrier, double d_hat) {
  double largest = 0;
  for (int i = 0; i < 64; ++i) largest = std::max(largest, -barrier.eval(d_hat * i / 64, d_hat).db);
  return largest;
}

}  // namespace

double NewtonSystem::contact_overload() const {
  if (method_.contact.shape.infinite_at_zero) return 0;
  const ContactTable& rows = state_.rows;
  const Positions others = gradient_ - contact_gradient_;  // what contact has to balance
  double largest = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Eigen::Map<const Vec3d> normal(&rows.normal[3 * r]);
    double push = 0, weight_sq = 0;
    for (std::size_t k = 0; k < 4 && rows.vertex[4 * r + k] >= 0; ++k) {
      const double weight = rows.weight[4 * r + k];
      push += weight * normal.dot(others.col(rows.vertex[4 * r + k]));
      weight_sq += weight * weight;
    }
    const double capacity =
        rows.multiplicity[r] * rows.kappa[r] * force_limit(method_.contact, rows.d_hat[r]);
    largest = std::max(largest, push / weight_sq / capacity);
  }
  return largest;
}

// Along the element's own limit force g_e: it would have to be -(others . g_e)/|g_e|^2 times as large.
double NewtonSystem::limit_overload() const {
  if (!limit_ || method_.limit.shape.infinite_at_zero) return 0;
  Positions others = -gradient_;
  blocks_->gather_elements(elements_.size(), limit_local_.grad, others);  // -(gradient - that of the limit)
  double largest = 0;
  for (std::size_t e = 0; e < limit_->size(); ++e) {
    const double width = scene_.limit.width[e];
    const double gap = std::min(limit_->gaps()[2 * e], limit_->gaps()[2 * e + 1]);
    if (!(gap < width)) continue;
    double needed = 0, own = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Map<const Vec3d> g(&limit_local_.grad[9 * e + 3 * k]);
      needed += g.dot(others.col(limit_->vertices()[3 * e + k]));
      own += g.squaredNorm();
    }
    if (!(own > std::numeric_limits<double>::min())) continue;
    const double share = -method_.limit.eval(gap, width).db / force_limit(method_.limit, width);
    largest = std::max(largest, needed / own * share);
  }
  return largest;
}

}  // namespace bb
