// How much of the largest force of a bounded barrier a load is: what contact and strain limit share when they
// say how far a step without progress is beyond what they can carry.
#pragma once

#include <map>

#include "core/barrier/shape.hpp"

namespace bb {

/// sup |b'| for kappa = 1, m, at each d_hat that comes up; infinite when unbounded. Evaluated by the shape at
/// every d_hat: how it depends on it is the shape's own business.
class LargestSlope {
 public:
  explicit LargestSlope(const BarrierFunction& barrier) : barrier_(barrier) {}
  double operator()(double d_hat);

 private:
  const BarrierFunction& barrier_;
  std::map<double, double> known_;
};

/// |b'| of the Newton model at the gap `next` where its step would end: linear from d on, m.
double newton_force(const BarrierFunction& barrier, double d, double next, double d_hat);

}  // namespace bb
