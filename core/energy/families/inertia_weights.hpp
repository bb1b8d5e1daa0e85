// Weights of inertia as a column of an executor: the host makes them where a step has another length than the one before.
#pragma once

#include <span>
#include <vector>

#include "core/energy/families/family_step.hpp"
#include "core/energy/vertex_loads.hpp"
#include "core/exec/buffer.hpp"

namespace bb {

class InertiaWeights {
 public:
  /// mass: [n] kg, 0 for prescribed vertices; outlives it.
  InertiaWeights(exec::Executor& executor, std::span<const double> mass)
      : mass_(mass), weight_(executor, "weights of inertia") {}

  /// [n] N/m, of a step; valid until the next call.
  const double* of(const FamilyStep& step) {
    if (weight_.size() == 0 || step.dt != dt_ || step.c != c_) {
      dt_ = step.dt, c_ = step.c;
      std::vector<double> weight;  // seldom: steps of a run are alike
      for (const double mass : mass_) weight.push_back(inertia_weight(mass, c_, dt_));
      weight_.upload(weight);
    }
    return weight_.data();
  }

 private:
  std::span<const double> mass_;
  exec::Buffer<double> weight_;
  double dt_ = 0, c_ = 0;  // s; as in StepColumns
};

}  // namespace bb
