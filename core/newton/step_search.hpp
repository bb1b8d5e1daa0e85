// How far an iteration of Newton goes: bounds, trials and what is accepted.
#pragma once

#include "core/newton/step_solver.hpp"
#include "core/newton/step_system.hpp"

namespace bb {

/// Steps 4 to 6 of line_search.cpp, and the way out of a saddle. Every trial is feasible as rounded; one that is judged by E
/// lowers it by `armijo` of what dx promises, or changes it by no more than rounding.
class StepSearch {
 public:
  /// armijo in (0, 1/2); cap_fraction in (0, 1]: of a bound that binds. bounded: by ACCD and the strain limit, else trials are
  /// judged as states alone.
  StepSearch(double armijo, double cap_fraction, bool bounded)
      : armijo_(armijo), cap_fraction_(cap_fraction), bounded_(bounded) {}

  /// Sets the counters `feasibility_trials`, `truncations` and `lengthened` of a step to 0 and counts in them until the next
  /// begins.
  void begin_step(StepReport& step);
  /// From the iterate along dx. Without an energy test while a prescribed vertex is short of its pose: its motion does work.
  /// small: dx is that of a step that is converged, and is taken as it is. length: dx may be taken so many times where
  /// nothing bounds it. True where a motion was accepted.
  bool along_direction(StepSystem& system, IterationReport& report, bool energy_test, bool small,
                       double length);
  /// A step along negative curvature, or away from a cusp, as the proof says; from d_hat down to the tolerance (m), as far as the
  /// bound allows: E has to fall by a part of what slope and curvature promise, and by more than rounding. False where no length
  /// does: within rounding E is level there.
  bool out_of_saddle(StepSystem& system, EndProof proof, IterationReport& report, double tolerance);

  /// Of the step taken last: its bound, in parts of dx; the part of dx that was taken, above 1 of one that was lengthened;
  /// whether vertices went each as far as contact let it; whether its change of E is noise; whether E, or a trial that was
  /// infeasible, made it shorter than its bound did.
  double bound() const { return bound_; }
  double taken() const { return taken_; }
  bool truncated() const { return truncated_; }
  bool noise() const { return noise_; }
  bool shortened() const { return shortened_; }

 private:
  void find_bound(StepSystem& system, IterationReport& report);
  void bound_again(StepSystem& system, IterationReport& report);
  bool leave(StepSystem& system, IterationReport& report, double slope, double curvature, double least);
  bool go_far(StepSystem& system, IterationReport& report, double length);
  bool go_round(StepSystem& system, IterationReport& report);
  bool go_truncated(StepSystem& system, IterationReport& report, const TruncatedMotion& motion,
                    bool energy_test);
  bool go_along(StepSystem& system, IterationReport& report, double least, bool energy_test);
  bool decreases(StepSystem& system, IterationReport& report, double alpha);
  bool is_feasible(StepSystem& system, IterationReport& report, double alpha);

  double armijo_, cap_fraction_;
  bool bounded_;
  double bound_ = 1;
  bool noise_ = false;
  double share_ = 1;  // of the fall that dx promises, in the motion that is tried
  bool truncated_ = false, shortened_ = false;
  double taken_ = 0;
  double *feasibility_trials_ = nullptr, *truncations_ = nullptr, *lengthened_ = nullptr;
};

}  // namespace bb
