// How far an iterate of Newton's method is from the solution, from how fast its directions shrink.
#pragma once

#include <algorithm>
#include <vector>

#include "core/base/record/number.hpp"

namespace bb {

class ErrorEstimate {
 public:
  /// A step begins.
  void reset();
  /// The direction of the next iteration, solved for up to this part of the residual. dx: |dx|_inf in m of what
  /// stands out of rounding; rounding: |dx|_inf of the rest (rounding_room.hpp).
  void add(double dx, double residual = 0, double rounding = 0);
  /// The part of that direction that was taken.
  void took(double alpha);

  /// q: |dx| over that of the iteration before, and at least the square of the q before it, so that one
  /// lucky ratio does not hide linear convergence, and at least the part of the residual that an inexact solve
  /// left, since the next direction has to make up for it. Absent unless the whole direction before was taken.
  Number contraction() const { return contraction_; }
  /// |dx| q/(1 - q), m: how far x + dx is from the solution if directions go on shrinking by q. An unknown q, and
  /// an unknown q before it, counts as 0.9: one ratio alone leaves at least 0.81. Infinite from q = 1 on. A |dx|
  /// within rounding shrinks no more and counts as it is.
  double error() const;
  /// Whether the smallest |dx| of the last ten iterations is below that of all before; true in the
  /// first ten.
  bool still_falling() const;
  /// The last |dx|, m. Requires one.
  double last() const { return std::max(dx_.back(), rounding_); }

 private:
  static constexpr double unknown = 0.9;

  std::vector<double> dx_;
  Number contraction_;
  double rounding_ = 0;      // m, of the last direction
  double before_ = unknown;  // the q before
  bool whole_ = false;       // the direction before was taken whole
};

}  // namespace bb
