#include "core/newton/error_estimate.hpp"

#include <algorithm>
#include <limits>

namespace bb {

void ErrorEstimate::reset(double largest, Precision precision) {
  dx_.clear();
  rounding_ = 8 * value_epsilon(precision) * largest;
  smallest_ = values_in_float(precision) ? rounding_ : 0;
  contraction_ = Number::missing("first_iteration");
  before_ = 0;
  whole_ = false;
}

void ErrorEstimate::add(double dx, double residual) {
  if (dx_.empty()) {
    contraction_ = Number::missing("first_iteration");
  } else if (!whole_ || dx_.back() == 0) {
    contraction_ = Number::missing("shortened_step");
    before_ = 0;
  } else {
    const double ratio = dx / dx_.back();
    contraction_ = Number(std::max({ratio, before_ * before_, residual}));
    before_ = ratio;
  }
  dx_.push_back(dx);
}

void ErrorEstimate::took(double alpha) { whole_ = alpha == 1; }

double ErrorEstimate::error() const {
  constexpr double unknown = 0.9;
  if (dx_.back() <= rounding_) return dx_.back();
  const double q = contraction_.finite() ? contraction_.value : unknown;
  if (!(q < 1)) return std::numeric_limits<double>::infinity();
  return dx_.back() * q / (1 - q);
}

bool ErrorEstimate::still_falling() const {
  constexpr std::ptrdiff_t window = 10;
  if (std::ssize(dx_) <= window) return true;
  return *std::min_element(dx_.end() - window, dx_.end()) <
         *std::min_element(dx_.begin(), dx_.end() - window);
}

}  // namespace bb
