// The strain limit in an executor's memory: a family of elements whose barrier and stiffness change with the state.
#pragma once

#include <memory>
#include <vector>

#include "core/resident/elements/element_family.hpp"
#include "core/resident/linear/resident_matrix.hpp"
#include "core/resident/sums/resident_sum.hpp"
#include "core/terms/term_options.hpp"

namespace bb::resident {

/// What the loads of a step are made from; memory of the executor, valid for the step.
struct ResidentFrame {
  const double *x_n = nullptr, *x_tilde = nullptr;  // [3 n] m, start of the step and prediction
  double dt = 0, c = 1, load_factor = 1;            // as in StepFrame
};

/// What is said of the limit at a measured state.
struct LimitNumbers {
  double max_stretch = 0, load_max = 0;  // 1, N/m
  double gap_min_rel = 0;                // of the width; infinity without elements
};

class ResidentLimit : public ElementFamily {
 public:
  /// Singular values, pseudo-gaps and barrier terms at x, with the kappa of the last refresh. Everything that
  /// ElementFamily offers is of the state measured last.
  virtual void measure(const double* x) = 0;
  /// A step begins: the next refresh is its first.
  virtual void begin_step() = 0;
  /// kappa at the iterate x, as its rule has it. elastic: the clamped elastic matrix. mass: [n_vertices] kg. Measures.
  /// Returns the largest relative change of an active element's kappa; 0 where the rule keeps it.
  virtual double refresh(const double* x, const ResidentFrame& frame, const double* mass,
                         const MatrixPart& elastic) = 0;
  /// Whether the next refresh reads the elastic matrix.
  virtual bool reads_elastic() const = 0;
  /// Whether the measured state is within the limit.
  virtual bool feasible() = 0;
  /// As StrainLimitBatch::step_bound from 1 on, bit for bit.
  virtual double bound(const double* x, const double* dx, double park) = 0;
  virtual LimitNumbers numbers() = 0;
};

/// Null where nothing is limited. options must outlive it. vertices: its stencils, element-major. Errors: ConfigError
/// for a barrier shape that is not in barriers/shapes (a plugin's has no kernel) and those of StrainLimitBatch.
std::unique_ptr<ResidentLimit> make_limit(exec::Executor& executor, const Scene& scene,
                                          const TermOptions& options, std::vector<int>& vertices);

}  // namespace bb::resident
