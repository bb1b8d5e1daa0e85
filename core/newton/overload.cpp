// How far a step that made no progress is beyond what bounded barriers can carry, over the largest force that
// the barrier has. The larger of two estimates of the load: what everything but contact (but the limit) puts
// on a row (an element) on its own, and the force at which the Newton model would come to rest, which knows
// how loads are shared but yields where the barrier would have to hold.
#include <algorithm>
#include <limits>
#include <map>

#include "core/contact/slope_scan.hpp"
#include "core/newton/newton_system.hpp"

namespace bb {
namespace {

// sup |b'| for kappa = 1, m, at each d_hat that comes up; infinite when unbounded. Asked of the shape at
// every d_hat: how it depends on it is the shape's own business.
class LargestSlope {
 public:
  explicit LargestSlope(const BarrierFunction& barrier) : barrier_(barrier) {}
  double operator()(double d_hat) {
    const auto [at, is_new] = known_.try_emplace(d_hat);
    if (is_new) at->second = max_slope(barrier_, d_hat).value_or(std::numeric_limits<double>::infinity());
    return at->second;
  }

 private:
  const BarrierFunction& barrier_;
  std::map<double, double> known_;
};

// |b'| that the Newton model asks for, at the gap `next` where its step would end: linear from d on, m.
double newton_force(const BarrierFunction& barrier, double d, double next, double d_hat) {
  const auto at = barrier.eval(d, d_hat);
  return -at.db + at.d2b * (d - next);
}

}  // namespace

double NewtonSystem::contact_overload(const Positions& dx) const {
  if (method_.contact.shape.infinite_at_zero) return 0;
  const ContactTable& rows = state_.rows;
  const Positions others = gradient_ - contact_gradient_;  // what contact has to balance
  LargestSlope slope(method_.contact);
  double largest = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Eigen::Map<const Vec3d> normal(&rows.normal[3 * r]);
    double push = 0, weight_sq = 0, opening = 0;
    for (std::size_t k = 0; k < 4 && rows.vertex[4 * r + k] >= 0; ++k) {
      const double weight = rows.weight[4 * r + k];
      push += weight * normal.dot(others.col(rows.vertex[4 * r + k]));
      opening += weight * normal.dot(dx.col(rows.vertex[4 * r + k]));
      weight_sq += weight * weight;
    }
    const double capacity = slope(rows.d_hat[r]);  // for kappa = 1
    const double load = push / weight_sq / (rows.multiplicity[r] * rows.kappa[r]);
    const double model = newton_force(method_.contact, rows.d[r], rows.d[r] + opening, rows.d_hat[r]);
    largest = std::max({largest, load / capacity, model / capacity});
  }
  return largest;
}

// Of element e on its own: how many times larger its force would have to be to balance the rest along itself.
double NewtonSystem::times_larger(std::size_t e, const Positions& others) const {
  double needed = 0, own = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto v = static_cast<std::size_t>(limit_->vertices()[3 * e + k]);
    for (std::size_t c = 0; c < 3; ++c) {
      if (fixed_[3 * v + c]) continue;  // carried by the pin
      const double g = limit_local_.grad[9 * e + 3 * k + c];
      needed -= g * others.data()[3 * v + c];
      own += g * g;
    }
  }
  return own > std::numeric_limits<double>::min() ? needed / own : 0;
}

double NewtonSystem::limit_overload(const Positions& dx) {
  if (!limit_ || method_.limit.shape.infinite_at_zero) return 0;
  Positions limit_gradient = Positions::Zero(3, state_.x.cols());
  blocks_->gather_elements(elements_.size(), limit_local_.grad, limit_gradient);
  const Positions others = gradient_ - limit_gradient;  // what the limit has to balance
  limit_->measure(state_.x);
  const std::vector<double> gaps(limit_->gaps().begin(), limit_->gaps().end());
  limit_->measure(state_.x + dx);
  LargestSlope slope(method_.limit);
  double largest = 0;
  for (std::size_t e = 0; e < limit_->size(); ++e) {
    const double width = scene_.limit.width[e];
    const double gap = std::min(gaps[2 * e], gaps[2 * e + 1]);
    const double next = std::min(limit_->gaps()[2 * e], limit_->gaps()[2 * e + 1]);
    if (!(gap < width)) continue;
    const double capacity = slope(width);
    const double share = -method_.limit.eval(gap, width).db / capacity;
    largest = std::max(
        {largest, share * times_larger(e, others), newton_force(method_.limit, gap, next, width) / capacity});
  }
  limit_->measure(state_.x);
  return largest;
}

}  // namespace bb
