// What a run is expected to take: from records of it or of its like, else from a model.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/base/record/run_record.hpp"
#include "experiments/config/run_config.hpp"

namespace bb::cli {

/// What decides how long a run takes.
struct RunSize {
  std::string config_id, scene, formulation;
  std::string of_scene;  // SHA-256 of the settings of the scene
  double steps = 0, unknowns = 0;
  int passes = 1;  // with the calibration run of a matching rule
};

/// What the config shows without its scene being built. scene: SHA-256 of the section `scene`.
RunSize size_of(const RunConfig& config, const std::string& scene);

/// Where an expectation is from: a record of this very config; of the same scene, the nearer the better; the model.
enum class CostSource { own_record, same_scene, model };

struct ExpectedCost {
  double core_s = 0;
  CostSource source = CostSource::model;
};

/// Records of earlier runs, and a model where they show nothing: seconds = 0.03 + passes x steps x 8 iterations a step x 4.5e-6 s an
/// unknown. Both numbers are medians over the runs of results/studies/work_precision.jsonl and
/// results/baselines; the seconds of an iteration are within a factor of 6 there. Large scenes take more: `drape` with 15,360 unknowns and pcg has taken
/// 1.4e-5 s an unknown and 20 to 30 iterations a step. Condition estimates and audits are not in it.
class CostBook {
 public:
  /// Every run.json below a folder; what cannot be read is passed over. Cost: reading them.
  void add_records(const std::filesystem::path& folder);
  /// Fills in the unknowns, where no record of the config is known. Scenes of the same settings are built once.
  /// config: makes the config that the size is of. Errors: ConfigError, as build_scene.
  void measure(RunSize& size, const std::function<RunConfig()>& config);
  /// A record of the same config as it stands; else the median over records of the same scene of their core seconds a step and
  /// unknown, those with the same settings of it before others, then those of the same formulation.
  ExpectedCost expected(const RunSize& size) const;
  std::size_t records() const { return known_.size(); }

 private:
  struct Known {
    RunSize size;
    double core_s;
  };
  std::vector<Known> known_;
  std::map<std::string, double> of_config_;  // config_id -> core s
  std::map<std::string, double> unknowns_;   // of_scene -> unknowns
};

}  // namespace bb::cli
