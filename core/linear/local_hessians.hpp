// Local Hessians of a family as a matrix is summed of them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace bb {

/// `from`, or part of the way to other ones: from + t (to - from), number by number. Both: the lower blocks of all elements,
/// [size * 9 width (width + 1)/2]. Views: what they show has to live as long as they do.
struct LocalHessians {
  std::span<const double> from;
  std::span<const double> to;  // as long as `from`, or empty: `from` alone
  double t = 0;                // 0 to 1

  LocalHessians(std::span<const double> alone) : from(alone) {}
  LocalHessians(const std::vector<double>& alone) : from(alone) {}
  LocalHessians(std::span<const double> exact, std::span<const double> other, double part)
      : from(exact), to(other), t(part) {}
  double operator[](std::size_t i) const { return to.empty() ? from[i] : from[i] + t * (to[i] - from[i]); }
};

}  // namespace bb
