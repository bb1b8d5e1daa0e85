// The verbs of the program: plain options in, exit code out (docs/design.md). main.cpp parses
// the command line.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/run/device_memory.hpp"
#include "experiments/run/runner.hpp"
#include "experiments/run/stored_run.hpp"

namespace bb::cli {

inline constexpr int exit_ok = 0;
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
};

struct RunVerb {
  std::string config;
  std::vector<std::string> set;  // "/pointer=value"
  std::string out;               // folder; empty: results/runs/<label>
  bool keep_inputs = false;      // copies of meshes and plugins beside the record
  RunLimits limits;
};
/// A config, or a record: rerun().
int run(const RunVerb& verb, const CommonOptions& common);

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
  RunLimits limits;
};
int sweep(const SweepVerb& verb, const CommonOptions& common);

struct StepsVerb {
  std::string config;
  std::vector<std::string> set;
  std::vector<int> at;  // steps, from 0
  std::string out;      // JSON file; empty: none
};
/// Single steps of a run with every choice of Hessian: study_steps() as a table.
int steps(const StepsVerb& verb, const CommonOptions& common);

struct MatrixVerb {
  std::vector<std::string> files;  // NAME.mtx, with NAME.json beside it or without
  std::string json;                // file; empty: none
  double tol_rel = 1e-8;           // of iterative solvers
  int max_iterations = 10000;
  int dense_rows = 1500;  // up to which all eigenvalues are computed
};
/// Stored systems through every linear solver, preconditioner and condition estimator. What fails there is a
/// result. Errors: ConfigError as read_system.
int matrix(const MatrixVerb& verb, const CommonOptions& common);

/// The validity block of this build: read, or computed and kept; what fails is said on stderr.
BuildValidity build_validity(const CommonOptions& common);

struct ValidityVerb {
  bool json = false;  // the report itself
};
/// The checks of the block as a table; exit_wrong_answer when one failed.
int validity(const ValidityVerb& verb, const CommonOptions& common);

struct CcdVerb {
  std::string folder;      // of query files; empty: none
  int random = 0;          // queries of each kind by construction; 0: none
  int head_on = 0;         // sweeps of each gap; 0: none
  std::uint64_t seed = 1;  // of both
  std::string json;        // file; empty: none
};
/// CCD queries with a known truth through ACCD and the audit. exit_wrong_answer when a pair that meets was proven free, or
/// an accepted state has crossed. Errors: ConfigError as read_queries, and unless one source is named.
int ccd(const CcdVerb& verb);

struct DeviceVerb {
  bool json = false;
  bool measure = false;  // rates of copies too
};
/// The card that this build can use. exit_no_card without one. Errors: as measure_copies.
int device(const DeviceVerb& verb);

/// Parses, builds the scene and looks for intersections; runs nothing.
int check(const RunVerb& verb);
/// What the run would do and what it would skip, and why; of a run on a device its memory; then every setting with its
/// default filled in.
int explain(const RunVerb& verb, const ContactDemand& demand);
/// Everything that can be named in a config, one section or "all"; scenes and mesh generators with their
/// parameters. Errors: ConfigError for a section that is not in list_sections().
std::vector<std::string> list_sections();
int list(const std::string& what);
/// Every setting of a format that is read, every field of one that is written, with what it means; or the
/// JSON Schema of it. Errors: ConfigError for another format.
std::vector<std::string> help_formats();
int help(const std::string& format, bool schema);
/// The sweeps of configs/sweeps/demo_*.json, one after the other.
int demo(const std::string& out, const CommonOptions& common);
int eval(const std::string& file, bool schema);

/// Sees to the kernel of BLAS before anything is computed: may replace the process by itself with
/// OPENBLAS_CORETYPE = Haswell, so nothing may have been read or written before.
/// @param request  "haswell", "native" or empty: haswell where this machine can, unless OPENBLAS_CORETYPE
///                 names another
/// Errors: ConfigError when "haswell" was asked for and cannot run here.
void settle_blas_kernel(const std::string& request, const std::vector<std::string>& argv);

}  // namespace bb::cli
