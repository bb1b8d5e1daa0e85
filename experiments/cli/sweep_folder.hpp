// The folder of a sweep: where its cases lie, which of them are there, and what is kept beside them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/cli/sweep_spec.hpp"
#include "experiments/cli/verbs.hpp"

namespace bb::cli {

/// The folder of a case below that of its sweep: LABEL-id8.
std::string folder_name(const SweepCase& one);

/// What every case of one sweep shares.
struct Sweep {
  SweepVerb verb;
  const CommonOptions& common;
  SweepSpec spec;
  std::filesystem::path out;
  std::vector<std::size_t> chosen;  // of spec.cases, those that this call sees to
  RunOptions options;               // of every run

  std::filesystem::path folder(std::size_t i) const { return out / folder_name(spec.cases[i]); }
  std::string note(std::size_t i) const { return spec.name + ": " + spec.cases[i].label; }
  /// Every case, and not a share or a single one.
  bool whole() const { return chosen.size() == spec.cases.size(); }
};

/// Reads the file and sees which cases are requested. Errors: those of load_sweep; ConfigError for a shard or an index that
/// there is not, and for options that do not go together.
Sweep open_sweep(const SweepVerb& verb, const CommonOptions& common, const SeenCase& seen = {});

RunOptions case_options(const Sweep& sweep, std::size_t i);

/// Why case i has to run; empty when the record of this very run is there: run_id, config, program, plugins, libraries, machine,
/// and its own trace. "nothing" where the folder has no record. Cost: reading record and trace.
std::string why_to_run(const Sweep& sweep, std::size_t i, const RunConfig& config);

/// Seconds times threads that the record of a case took, from its start to its end; of one that was stopped and went on, in the steps of its
/// timed pass.
double core_seconds(const RunRecord& record);

/// sweep.json, the file as it was read, and cases.json: every case with its folder, label, config_id and swept values, which
/// ./bench status and ./bench data collect read. Each is written where it is not there or another one. Errors: RecordError.
void write_sweep_files(const Sweep& sweep);

/// Whether every case has a record, whatever is in it.
bool all_there(const Sweep& sweep);

/// Which runs may be compared, in every record of the sweep; then a line for every case: outcome, verdict, reason. refused: one a
/// case. Errors: RecordError.
void compare_cases(const Sweep& sweep, const std::vector<bool>& refused);

}  // namespace bb::cli
