// What a step solver needs of the system that it calls: what it does without is not made (core/terms/plan.hpp).
#pragma once

namespace bb {

struct StepNeeds {
  bool matrix = true;        // Newton directions: Hessians, a linear solver
  bool energies = true;      // changes of E at trials; false: feasibility alone judges them
  bool minimum = true;       // steps end in a minimum of E: exact Hessians, and that one is looked at
  bool step_bound = true;    // false: steps may pass through surfaces, barriers are read beyond their end
  bool multipliers = false;  // contact has multipliers in the place of its barrier or beside it: on the host
  bool overlap =
      false;  // without a step bound: states beyond contact are as good as others, a bounded shape goes on there
  bool operator==(const StepNeeds&) const = default;
};

}  // namespace bb
