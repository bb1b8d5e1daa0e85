#include "core/newton/energy_state.hpp"

#include <cmath>
#include <span>

namespace bb {
namespace {

// Neumaier's compensated sum: the order is fixed, the error does not grow with the number of terms.
class Sum {
 public:
  void add(double term) {
    const double next = sum_ + term;
    carry_ += std::abs(sum_) >= std::abs(term) ? (sum_ - next) + term : (term - next) + sum_;
    sum_ = next;
  }
  double value() const { return sum_ + carry_; }

 private:
  double sum_ = 0, carry_ = 0;
};

struct Accumulator {
  Sum change;
  double magnitude = 0;

  void pair(double from, double to) {
    change.add(to - from);
    magnitude += std::abs(from) + std::abs(to);
  }
  void column(std::span<const double> from, std::span<const double> to) {
    for (std::size_t i = 0; i < from.size(); ++i) pair(from[i], to[i]);
  }
  // Rows differ between two states, so only their sums can be compared.
  void rows(std::span<const double> from, std::span<const double> to) {
    for (const double term : from) {
      change.add(-term);
      magnitude += std::abs(term);
    }
    for (const double term : to) {
      change.add(term);
      magnitude += std::abs(term);
    }
  }
};

}  // namespace

EnergyChange energy_change(const StepTerms& terms, const EnergyState& from, const EnergyState& to) {
  Accumulator sum;
  for (Eigen::Index i = 0; i < from.x.cols(); ++i) {
    const double weight = terms.inertia[static_cast<std::size_t>(i)];
    const Vec3d step = to.x.col(i) - from.x.col(i);
    if (weight != 0) {
      const Vec3d from_target = from.x.col(i) - terms.x_tilde.col(i);
      const Vec3d to_target = to.x.col(i) - terms.x_tilde.col(i);
      sum.change.add(0.5 * weight * step.dot(from_target + to_target));
      sum.magnitude += 0.5 * weight * (from_target.squaredNorm() + to_target.squaredNorm());
    }
    const double work = terms.force.col(i).dot(step);
    sum.change.add(-work);
    sum.magnitude += std::abs(work);
  }
  for (std::size_t family = 0; family < from.element.size(); ++family) {
    sum.column(from.element[family], to.element[family]);
  }
  sum.column(from.limit, to.limit);
  sum.rows(from.contact, to.contact);
  sum.rows(from.mollified_contact, to.mollified_contact);
  return {sum.change.value(), sum.magnitude};
}

double total_energy(const StepTerms& terms, const EnergyState& state) {
  Sum sum;
  for (Eigen::Index i = 0; i < state.x.cols(); ++i) {
    const double weight = terms.inertia[static_cast<std::size_t>(i)];
    if (weight != 0) sum.add(0.5 * weight * (state.x.col(i) - terms.x_tilde.col(i)).squaredNorm());
    sum.add(-terms.force.col(i).dot(state.x.col(i) - terms.x_n.col(i)));
  }
  for (const std::vector<double>& family : state.element) {
    for (const double term : family) sum.add(term);
  }
  for (const double term : state.limit) sum.add(term);
  for (const double term : state.contact) sum.add(term);
  for (const double term : state.mollified_contact) sum.add(term);
  return sum.value();
}

}  // namespace bb
