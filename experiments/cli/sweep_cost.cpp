#include "experiments/cli/sweep_cost.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/record/provenance.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"
#include "experiments/cli/sweep_folder.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/plan.hpp"

namespace bb::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double start_s = 0.03, iterations_a_step = 8, seconds_an_unknown = 4.5e-6;

/// How alike two runs are beyond the name of their scene.
int likeness(const RunSize& a, const RunSize& b) {
  return 2 * (a.of_scene == b.of_scene ? 1 : 0) + (a.formulation == b.formulation ? 1 : 0);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

RunSize size_of_record(const RunRecord& record) {
  RunSize out;
  out.config_id = config_id(record.config.text);
  out.scene = record.labels.scene;
  out.formulation = record.labels.formulation;
  out.of_scene = sha256_hex(json::parse(record.config.text).value("scene", json()).dump());
  out.steps = static_cast<double>(record.steps.size());
  out.unknowns = static_cast<double>(record.scene.free_dofs);
  return out;
}

}  // namespace

void CostBook::add_records(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename() == "run.json") files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    try {
      const auto record = read_run(file);
      const double core_s = record ? core_seconds(*record) : 0;
      if (core_s <= 0 || was_cut(record->status.outcome)) continue;
      known_.push_back({size_of_record(*record), core_s});
      of_config_[known_.back().size.config_id] = core_s;
    } catch (const ConfigError&) {  // of another version
    }
  }
}

RunSize size_of(const RunConfig& config, const std::string& scene) {
  RunSize out;
  out.scene = config.scene.name;
  out.formulation = label_of(config.formulation);
  out.of_scene = scene;
  out.steps = config.time.steps;
  out.passes = (config.passes.time ? 1 : 0) + (has_observed_run(config) ? 1 : 0) +
               (config.matching.rule != MatchingRule::as_given ? 1 : 0);
  return out;
}

void CostBook::measure(RunSize& size, const std::function<RunConfig()>& config_of) {
  if (of_config_.contains(size.config_id)) return;
  const auto [found, is_new] = unknowns_.try_emplace(size.of_scene);
  if (is_new) found->second = static_cast<double>(free_dofs(build_scene(config_of())));
  size.unknowns = found->second;
}

ExpectedCost CostBook::expected(const RunSize& size) const {
  if (const auto own = of_config_.find(size.config_id); own != of_config_.end())
    return {own->second, CostSource::own_record};
  std::vector<double> rates;
  int best = -1;
  for (const auto& [other, core_s] : known_) {
    if (other.scene != size.scene || other.steps * other.unknowns <= 0 || likeness(size, other) < best)
      continue;
    if (likeness(size, other) > best) rates.clear();
    best = likeness(size, other);
    rates.push_back(core_s / (other.steps * other.unknowns));
  }
  if (!rates.empty()) return {median(rates) * size.steps * size.unknowns, CostSource::same_scene};
  const double iteration_s = seconds_an_unknown * size.unknowns;
  return {start_s + size.passes * size.steps * iterations_a_step * iteration_s, CostSource::model};
}

}  // namespace bb::cli
