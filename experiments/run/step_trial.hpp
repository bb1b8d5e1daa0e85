// One time step from an archive of the simulation in front of it: as its run took it, or with another Hessian, tolerance or
// step solver.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/newton/report.hpp"
#include "core/step_solvers/simulation.hpp"
#include "experiments/run/calibration.hpp"
#include "experiments/run/plan.hpp"

namespace bb {

/// What all steps of a config share. It outlives them.
struct StepSetting {
  const RunConfig& config;
  const Scene& scene;
  const Calibration& calibration;
  const Plan plan;
};

/// The run in front of a step: an archive of its simulation, with the memory of its policies.
struct StepStart {
  int step = 0;  // of the run, from 0
  std::string bytes;
};

/// The tolerance of a reference is that of the run divided by this.
inline constexpr double reference_finer = 1000;

struct StepVariant {
  std::optional<StepHessian> hessian = std::nullopt;  // of all terms; absent: as the config states
  double finer = 1;                                   // the tolerance is divided by it
  bool keeps_states = false;
};

struct TakenStep {
  StepReport report;
  double tolerance_m = 0;  // h tol_velocity
  double seconds = 0;      // of the processor
  bool has_memory =
      true;  // false: what terms and policies remember of the run is no memory of this step solver
  std::vector<IterationReport> iterations;
  std::vector<Positions> states;  // after each of them, where requested
  Positions end;
};

/// That this process has used so far: other processes of the machine do not count.
double processor_seconds();

/// null where there is none.
nlohmann::ordered_json json_of(const Number& number);

/// Runs the setting to the start of each of `steps` (ascending, from 0, all in the run). Errors: ConfigError naming `option` where
/// the run does not get there; Interrupted.
std::vector<StepStart> step_starts(const StepSetting& setting, const std::vector<int>& steps,
                                   const char* option, const RunOptions& options);

/// With the run's own choices it is the step of the run, bit for bit. Errors: ConfigError for what the step solver cannot step;
/// std::logic_error where the archive is that of another simulation.
TakenStep take_step(const StepSetting& setting, const std::string& archive, const StepVariant& variant);

}  // namespace bb
