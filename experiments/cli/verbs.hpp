// What verbs of the program share: exit codes, common options, running one config. Each verb has a file of its own
// (verbs.inc); main.cpp parses the command line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "experiments/run/runner.hpp"
#include "experiments/run/stored_run.hpp"

namespace bb::cli {

inline constexpr int exit_ok = 0;
inline constexpr int exit_not_clean = 1;  // what was judged penetrates, or could not be proven not to: audit
inline constexpr int exit_bad_input = 2;
inline constexpr int exit_no_repeat =
    3;  // a record did not repeat itself, and nothing that it names explains it
inline constexpr int exit_wrong_answer = 4;  // a check with a known answer failed: ccd, validity
inline constexpr int exit_no_card = 5;       // no card that this build can use: device
inline constexpr int exit_internal = 70;
inline constexpr int exit_try_again = 75;

struct CommonOptions {
  std::vector<std::string> plugins;  // loaded before anything is parsed
  std::vector<PluginFile> loaded;    // what they turned out to be
  std::vector<std::string> argv;     // for the record
  std::string progress = "auto";     // auto, plain, none
  double progress_every_s = 0;       // between two lines off a terminal; 0: as the mode has it
  std::string blas_kernel;           // haswell, native, or empty: see settle_blas_kernel
};

/// How long a run may take, and where it begins.
struct RunLimits {
  bool resume = false;      // go on from a checkpoint where there is one
  double time_limit_s = 0;  // of every run; 0: none
  int step_limit = 0;       // steps that one process takes of each pass; 0: none

  void put_in(RunOptions& options) const;
};

struct RunVerb {
  std::string config;
  std::vector<std::string> set;  // "/pointer=value"
  std::string out;               // folder; empty: results/runs/<label>
  bool keep_inputs = false;      // copies of meshes and plugins beside the record
  bool replace = false;          // what another config left in the folder goes
  RunLimits limits;
};
/// Runs the config inside a record in a folder of its own (empty `out`: results/runs/<label>-rerun, numbered
/// when that is taken) and says whether the final state is the same, or what may have changed it. Meshes and
/// plugins are those that the record names, unless verb.set or --plugin name others. exit_no_repeat when the
/// state or the outcome differs and nothing explains it. Errors: ConfigError also when `out` is the folder of
/// the record, and for meshes and plugins that are not there or have another content.
int rerun(const StoredRun& stored, const RunVerb& verb, const CommonOptions& common);

/// Registers a plugin; with its hash. Errors: as bb::register_plugin.
PluginFile load_plugin_file(const std::string& file);

RunOptions run_options(const CommonOptions& common);
/// run_config with a progress line, then its row and its place on stdout.
RunRecord run_and_show(const RunConfig& config, RunOptions options, const CommonOptions& common);

struct SweepVerb {
  std::string spec;
  std::vector<std::string> set;
  std::string out;       // empty: results/runs/<name of the sweep>
  bool dry_run = false;  // print the expanded list, run nothing
  bool again = false;    // run finished ids too
  bool keep_inputs = false;
  int jobs = 1;                      // processes at a time; 1: this one
  std::string shard;                 // "i/N"; empty: every case
  std::optional<std::size_t> index;  // one case
  RunLimits limits;
};
/// Errors: ConfigError after the last case, of all cases that were refused.
int sweep(const SweepVerb& verb, const CommonOptions& common);

/// The validity block of this build: read, or computed and kept; what fails is reported on stderr.
BuildValidity build_validity(const CommonOptions& common);

/// Sees to the kernel of BLAS before anything is computed: may replace the process by itself with
/// OPENBLAS_CORETYPE = Haswell, so nothing may have been read or written before.
/// @param request  "haswell", "native" or empty: haswell where this machine can, unless OPENBLAS_CORETYPE
///                 names another
/// Errors: ConfigError when "haswell" was requested and cannot run here.
void settle_blas_kernel(const std::string& request, const std::vector<std::string>& argv);

}  // namespace bb::cli
