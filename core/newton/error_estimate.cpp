#include "core/newton/error_estimate.hpp"

#include <limits>

namespace bb {

void ErrorEstimate::reset() { *this = {}; }

void ErrorEstimate::add(double dx, double residual, double rounding) {
  if (dx_.empty()) {
    contraction_ = Number::missing("first_iteration");
  } else if (!whole_ || dx_.back() == 0) {
    contraction_ = Number::missing("shortened_step");
    before_ = unknown;
  } else {
    const double ratio = dx / dx_.back();
    contraction_ = Number(std::max({ratio, before_ * before_, residual}));
    before_ = ratio;
  }
  dx_.push_back(dx);
  rounding_ = rounding;
}

void ErrorEstimate::took(double alpha) { whole_ = alpha == 1; }

double ErrorEstimate::error() const {
  if (dx_.back() == 0) return rounding_;
  const double q = contraction_.finite() ? contraction_.value : unknown;
  if (!(q < 1)) return std::numeric_limits<double>::infinity();
  return std::max(rounding_, dx_.back() * q / (1 - q));
}

bool ErrorEstimate::still_falling() const {
  constexpr std::ptrdiff_t window = 10;
  if (std::ssize(dx_) <= window) return true;
  return *std::min_element(dx_.end() - window, dx_.end()) <
         *std::min_element(dx_.begin(), dx_.end() - window);
}

}  // namespace bb
