// The work of block-Jacobi PCG on the very system that another solver solves: what a condition number means.
#pragma once

#include <cstdint>
#include <memory>

#include "core/base/record/trace_row.hpp"
#include "core/linear/linear_solver.hpp"

namespace bb {

/// Iterations to a residual of 1e-6 |b| on one fixed, seeded right-hand side (methodology: counts are
/// compared on the same b). Cost: one PCG solve; belongs to the pass `diagnose`.
class PcgProbe {
 public:
  explicit PcgProbe(std::uint64_t seed);
  /// A breakdown is no count: missing, with the status of the solver.
  Number iterations(const ReducedSystem& system);

 private:
  std::uint64_t seed_;
  std::unique_ptr<LinearSolver> solver_;
  VecXd b_, x_;
};

}  // namespace bb
