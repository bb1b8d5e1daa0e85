// How far an iterate of Newton's method is from the solution, from how fast its directions shrink.
#pragma once

#include <vector>

#include "core/math/precision.hpp"
#include "core/record/number.hpp"

namespace bb {

class ErrorEstimate {
 public:
  /// A step begins at a state of that precision whose largest |coordinate| is `largest`, m.
  void reset(double largest, Precision precision = Precision::full);
  /// The smallest error that a step can be asked for, m: in float the rounding of the coordinates, 0 in double.
  double smallest() const { return smallest_; }
  /// The direction of the next iteration, |dx|_inf in m, solved for up to this part of the residual.
  void add(double dx, double residual = 0);
  /// The part of that direction that was taken.
  void took(double alpha);

  /// q: |dx| over that of the iteration before, and at least the square of the q before it, so that one
  /// lucky ratio does not hide linear convergence, and at least the part of the residual that an inexact solve
  /// left, since the next direction has to make up for it. Absent unless the whole direction before was taken.
  Number contraction() const { return contraction_; }
  /// |dx| q/(1 - q), m: how far x + dx is from the solution if directions go on shrinking by q. An unknown q
  /// counts as 0.9; infinite from q = 1 on. A |dx| within rounding of the coordinates shrinks no more and counts
  /// as it is.
  double error() const;
  /// Whether the smallest |dx| of the last ten iterations is below that of all before; true in the
  /// first ten.
  bool still_falling() const;
  /// The last |dx|, m. Requires one.
  double last() const { return dx_.back(); }

 private:
  std::vector<double> dx_;
  Number contraction_;
  double rounding_ = 0;  // m, of the coordinates
  double smallest_ = 0;  // m
  double before_ = 0;    // last known q
  bool whole_ = false;   // the direction before was taken whole
};

}  // namespace bb
