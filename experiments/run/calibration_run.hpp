// The calibration run of matching: the scene once with the log barrier. Its states report which contacts and limited
// elements carry loads (calibration_demand.hpp), from which a matching rule makes stiffness (calibration.hpp).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/run/method.hpp"
#include "experiments/run/runner.hpp"
#include "experiments/run/stiffness_answer.hpp"

namespace bb {

/// Loads of the weight alone: the calibration run starts from them, and they are used where the calibration run found nothing.
struct StaticLoads {
  double contact = 0;  // N per free vertex
  double limit = 0;    // N/m, weight over the side of a square of the limited area; 0 without a limit
  double solid_limit =
      0;  // Pa, weight over the side of a cube of the limited volume; 0 without a limit of solids
};

/// What the calibration run leaves. Memory: 24 bytes a vertex and step, what terms remember a step (rest shapes that creep), 16 a
/// vertex and a limited element.
struct CalibrationRun {
  RunConfig config;       // its own
  Calibration stiffness;  // kappa and k_s of its log barriers
  StaticLoads rest;
  std::vector<double> c;            // inertia weight of the integrator in each converged step
  std::vector<Positions> x;         // m, at the start, then at the end of each converged step
  std::vector<std::string> memory;  // archives of what terms remember as each of them begins; or empty
  AnswerSums answers;               // over the ends of all converged steps
  int unanswered = 0;               // steps whose answers could not be computed: their forces count as loads
  std::string config_id;
  std::string stopped;  // why it ended early; empty when it did not

  int steps() const { return static_cast<int>(x.size()) - 1; }
  std::size_t bytes() const;
};

/// The barrier of the calibration run, to which the rules compare others.
BarrierFunction log_barrier();

/// Calibration runs by config id, so that the formulations of a sweep share one. Not thread-safe.
class CalibrationRunCache {
 public:
  /// The states of all calibration runs that are kept take at most so many bytes; the last one is kept
  /// whatever it takes.
  explicit CalibrationRunCache(std::size_t bytes) : bytes_(bytes) {}
  /// Null when it is not known, or not any more.
  std::shared_ptr<const CalibrationRun> find(const std::string& config_id);
  /// Keeps it and drops those that were requested longest ago.
  std::shared_ptr<const CalibrationRun> keep(CalibrationRun calibration_run);

 private:
  std::size_t bytes_;
  std::vector<std::shared_ptr<const CalibrationRun>> known_;  // requested last: at the end
};

/// Runs the calibration run of this config, or returns the one that is known: 256 MiB of them are kept.
/// The limits are looked at between two of its steps; a calibration run that they end is not kept.
/// Errors: ConfigError when the scene has no weight to start from; Interrupted; TimeOver.
std::shared_ptr<const CalibrationRun> run_calibration(const RunConfig& config, const Scene& scene,
                                                      const RunOptions& options);

/// kappa (N/m) from which a policy with one global kappa starts in the run of this very config, unscaled:
/// the run is followed to its first contact, up to which the scale cannot change it. Nothing when it meets
/// none. Errors: ConfigError of the policy; Interrupted; TimeOver.
std::optional<double> policy_start(const RunConfig& config, const Scene& scene,
                                   const Calibration& calibration, const RunOptions& options);

}  // namespace bb
