// How runs and small simulations end: what test_every_outcome.cpp requires for every word.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/base/record/outcome.hpp"
#include "core/linear/linear_solver.hpp"

namespace bb::test {

struct Ending {
  Outcome outcome = Outcome::ok;
  std::string detail;
  std::set<std::string> steps, solves;  // words of all steps, of all linear solves
  double contacts = 0;                  // over all steps
};

using Overrides = std::vector<std::string>;

/// A block that comes to rest on its three corners, in three steps.
inline constexpr const char* resting_block =
    R"({"schema": "barrierbench.config/1", "scene": {"name": "resting_block_1d"},
  "formulation": {"name": "cubic", "d_hat_m": 0.01}, "matching": {"rule": "equal_force", "load_N": 1},
  "passes": {"time": false, "audit": true}, "time": {"steps": 3}})";

/// The record of a run, and the solves of its trace.
Ending run(const std::string& config, const Overrides& overrides = {}, double time_limit_s = 0);

// of runs (endings_of_runs.cpp)
Ending factor_too_large();  // CHOLMOD says so
Ending unjudged();          // its audit does not see the motions
Ending greedy();            // its third step finds no memory
Ending failing();           // a kernel of its device fails in the first step

// of simulations (endings_of_steps.cpp)
Ending floating_particle(const LinearOptions& linear);  // no inertia, nothing that holds it
Ending shape_without_a_potential();
Ending stiffness_that_overflows();
Ending slope_that_underflows();
Ending torn_cloth();
Ending few_probes();  // a fast cloth that may not look whether it touches

}  // namespace bb::test
