// Hard time steps by every step solver and every Hessian: each state of a folder to the same true error, with what each
// iteration was short for.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/newton/iteration_cause.hpp"
#include "experiments/run/step_state.hpp"

namespace bb {

/// A state by one step solver and one Hessian.
struct CorpusTrial {
  std::string step_solver,
      hessian;                  // hessian: of line_search; empty: that of the config, or the solver's own
  bool exact_friction = false;  // /friction/hessian is exact here, and not as the config states
  std::string refused;          // why this step solver cannot take the state; empty: it was taken
  StepStatus status = StepStatus::converged;
  bool has_memory = true;  // TakenStep
  /// The minimum that it ended in (minimum_name), A that of the reference; empty where its end is within ten tolerances of none.
  std::string minimum;
  Number error_m;  // |x - x_min|_inf of its end, against that minimum, else against A
  std::optional<int> iterations_to_tolerance;  // until that error was first below the tolerance
  int iterations = 0, regularised = 0;         // regularised: is_regularised()
  std::array<int, std::size(all_iteration_causes)>
      causes{};  // iterations by cause; they add up to `iterations`
  WorkCounts work;
  double seconds = 0;      // of the processor
  std::string state_hash;  // sha256 of the end positions
  /// Of its end, in d_hat: the smallest gap, and those at which 5 %, half and 95 % of the contact load are carried at smaller ones.
  Number gap_min_rel = Number::missing("no_contacts"), gap_rel_p05 = gap_min_rel,
         gap_rel_median = gap_min_rel, gap_rel_p95 = gap_min_rel;
};

struct CorpusState {
  std::string name, hard_for, split, formulation, step_solver, linear_solver;
  std::string
      refused;  // why line_search cannot take it, so that there is no trial of it; empty: it was taken
  int step = 0, vertices = 0;
  std::size_t contacts = 0;  // at the end of the reference
  double tolerance_m = 0;
  bool has_reference = true;                     // else nothing is known of the reference
  StepStatus reference = StepStatus::converged;  // how line_search ended at a thousandth of the tolerance
  int reference_iterations = 0;
  double seconds = 0;  // of all trials, the reference and other minima
  std::vector<CorpusTrial> trials;
};

/// A to Z, then AA, AB ...
std::string minimum_name(std::size_t place);

/// As --trials has it: SOLVER, SOLVER/HESSIAN, or SOLVER/HESSIAN/exact_friction.
std::string trial_name(const CorpusTrial& trial);

/// Trials that are not taken yet: line_search with each of all_step_hessians and with the exact Hessian of friction, then every other
/// step solver of the registry with its own Hessian; of these the ones with a name of `names`, in the order of this list, all of
/// them without one. Errors: ConfigError for a name that no trial has.
std::vector<CorpusTrial> corpus_trials(const std::vector<std::string>& names);

/// What is taken of a state. Without the reference no end is compared with a minimum.
struct CorpusChoice {
  std::vector<CorpusTrial> trials = corpus_trials({});
  bool reference = true;
};

/// `tell` receives the name of each trial before it begins. Errors: Interrupted.
CorpusState take_state(const StepState& state, const CorpusChoice& choice, const RunOptions& options,
                       const std::function<void(const std::string&)>& tell);

/// {"schema": "barrierbench.step_corpus/1", ...}; numbers that are absent are null.
std::string corpus_json(const std::vector<CorpusState>& states, const RunOptions& options);
/// The same of one state for people.
std::string corpus_table(const CorpusState& state);

}  // namespace bb
