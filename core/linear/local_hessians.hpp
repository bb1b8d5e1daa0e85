// Local Hessians of a family as a matrix is summed of them.
#pragma once

#include <span>
#include <stdexcept>
#include <vector>

namespace bb {

/// `from`, or part of the way to others: from + t (to - from), number by number. Each the lower blocks of all elements,
/// [size * 9 width (width + 1)/2]. Views: what they show has to live as long as they do.
struct LocalHessians {
  std::span<const double> from;
  std::span<const double> to;  // as long as `from`, or empty: `from` alone
  double t = 0;                // 0 to 1

  LocalHessians(std::span<const double> alone) : from(alone) {}
  LocalHessians(const std::vector<double>& alone) : from(alone) {}
  LocalHessians(std::vector<double>&&) = delete;
  /// Errors: logic_error for others of another length, which were not filled.
  LocalHessians(std::span<const double> exact, std::span<const double> others, double part)
      : from(exact), to(others), t(part) {
    if (to.size() != from.size()) throw std::logic_error("local Hessians: others that were not filled");
  }
};

}  // namespace bb
