// How far the end of a step is from the solution when its step solver does not have to converge: one more Newton
// direction from there, in a system of its own, so that the run is, bit for bit, what it is without.
#pragma once

#include <memory>

#include "core/newton/newton_system.hpp"

namespace bb {

class EndResidual {
 public:
  /// All must outlive it.
  EndResidual(const Scene& scene, Method& method, const Plan& plan)
      : scene_(scene), method_(method), plan_(plan) {}
  /// |dx|_inf, m, at the iterate of `system`, whose step began as `frame` says; prescribed vertices stay. Absent where
  /// the direction cannot be found. Charged to Phase::output. Cost: two assemblies and a solve, three assemblies on a
  /// device.
  Number measure(StepSystem& system, const StepFrame& frame);

 private:
  const Scene& scene_;
  Method& method_;
  const Plan& plan_;
  std::unique_ptr<NewtonSystem> own_;
};

}  // namespace bb
