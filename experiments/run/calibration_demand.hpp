// What the contacts and limited elements of a calibration run require of a stiffness: the largest demand over all of them,
// at all converged step ends (docs/theory/barriers.md, Matching).
#pragma once

#include <functional>
#include <string>

#include "experiments/run/calibration_run.hpp"

namespace bb {

/// The matching rule: stiffness (N/m) with which a barrier of this width carries this load.
using MatchedStiffness = std::function<double(double load, double width)>;

/// The contact or limited element with the largest demand.
struct Demand {
  double largest = 0;        // N/m, the matched stiffness; 1 with a policy: that over the policy's own
  double load = 0;           // N of a pair, or N/m
  double width = 0;          // its d_hat (m), or the width of its limit (1)
  double answer = 0;         // d log force/d log stiffness (stiffness_answer.hpp)
  int step = -1;             // of the calibration run, at whose end it carried the load
  std::string where;         // names it
  long long considered = 0;  // loads that were compared, over all steps; 0: all of the above is void
  // forces that follow their stiffness, as between prescribed bodies at a fixed distance, are no loads
  long long left_out = 0;    // over all steps; 0: the rest is void
  double left_out_load = 0;  // the largest of them, N of a pair, or N/m
  int left_out_step = -1;
  std::string left_out_where;
};

/// The largest demand over the contacts that carry a load; those whose force answers to kappa are left out. `own`: the policy that is to be scaled, or null. It is evaluated for the
/// contact with the H that it reads: of the step's end when it is refreshed in every iteration, else of the
/// step's start; and at d_hat, where a new pair gets its kappa, or at u d_hat if that gives less. Rows with a
/// mollifier are left out: their load is e(x) times that of a row.
/// Errors: ConfigError when `own` gives a contact that carried a load no stiffness; Interrupted and TimeOver of the limits.
/// Cost: finding the rows of each step, and with `own` one assembly a step.
Demand contact_demand(const CalibrationRun& calibration_run, const Scene& scene,
                      const MatchedStiffness& matched, const StiffnessPolicy* own, double u,
                      const RunLimits& limits = {});

/// The same over the limited elements. `own` is evaluated at the width of the limit; where kappa_e is frozen for a
/// step as a number, at the gap of the step's start if that is wider. Requires a scene with limited elements.
Demand limit_demand(const CalibrationRun& calibration_run, const Scene& scene,
                    const MatchedStiffness& matched, const StiffnessPolicy* own,
                    const RunLimits& limits = {});

}  // namespace bb
