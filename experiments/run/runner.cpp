#include "experiments/run/runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "barriers/formulas.hpp"
#include "core/base/record/folder_lock.hpp"
#include "core/base/record/provenance.hpp"
#include "core/base/record/run_folder.hpp"
#include "core/base/record/writer.hpp"
#include "core/linear/blas_info.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/error.hpp"
#include "core/terms/plan.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/comparability.hpp"
#include "experiments/run/device_run.hpp"
#include "experiments/run/earlier_run.hpp"
#include "experiments/run/fill_record.hpp"
#include "experiments/run/input_files.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/passes.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/start_check.hpp"
#include "experiments/run/stored_run.hpp"
#include "experiments/run/thread_limit.hpp"

namespace bb {
namespace {

std::vector<FormulaLibrary> formulas_in(const RunConfig& config) {
  std::vector<std::string> policies;
  const ParameterMap& parameters = config.formulation.stiffness_policy.parameters;
  if (parameters.contains("formula")) policies.push_back(text(parameters, "formula"));
  return formula_libraries({config.formulation.shape, config.strain_limit.shape}, policies);
}

/// Libraries of formulas are made again from the config where they are missing, so no plugin has to be kept for them.
std::vector<PluginFile> with_formulas(const RunConfig& config, std::vector<PluginFile> plugins) {
  for (const FormulaLibrary& library : formulas_in(config)) {
    plugins.push_back({library.name, library.file, library.sha256});
  }
  if (const DeviceCode* code = device_code_in(config)) {
    plugins.push_back({config.formulation.shape + " (PTX)", code->file, code->sha256});
  }
  return plugins;
}

// From the scene to the outcome. A scene that cannot start, or cannot be matched, is an outcome: only its
// geometry or its calibration run can show that.
void simulate(const RunConfig& config, const Scene& scene, const RunOptions& options, Checkpoint& checkpoint,
              Resumed* resumed, RunRecord& record, RunFiles& files) {
  fill_scene(scene, record);
  record.matching.rule = to_string(config.matching.rule);
  const Plan plan = plan_of(config, scene);
  fill_plan(config, plan, record);
  const double before_check = now_s();
  auto failure = start_failure(config, scene, plan.contacts, options.limits());
  const double start_check_s = now_s() - before_check;
  record.summary.start_check_s = start_check_s;
  Calibration calibration;
  if (!failure && resumed) {
    calibration = resumed->calibration;
    record.matching = resumed->record.matching;
  } else if (!failure) {
    failure = find_stiffness(config, scene, options, record.matching, calibration);
  }
  if (failure) {
    record.status.outcome = failure->outcome;
    record.status.detail = failure->detail;
    return;
  }
  run_passes(config, scene, plan, calibration, options, checkpoint, resumed, record, files);
  record.summary.start_check_s = start_check_s;  // of this process
}

std::string goes_on_text(const Checkpoint& checkpoint) {
  return fmt::format("{} kept: the same command with --resume goes on from it", checkpoint.file().string());
}

/// What a run that its device stopped says.
std::string stopped_text(const RunRecord& record, const RunOptions& options, const Checkpoint& checkpoint) {
  return fmt::format("{}: {}\n{} has the steps before{}", to_string(record.status.outcome),
                     record.status.detail, (options.folder / "run.json").string(),
                     checkpoint.exists() ? "; " + goes_on_text(checkpoint) : "");
}

/// Why the record of a run that was cut off does not replace the one in the folder; empty: it does.
std::string why_earlier_stays(const RunRecord& record, const RunOptions& options) {
  if (!was_cut(record.status.outcome)) return "";
  const std::filesystem::path file = options.folder / "run.json";
  std::optional<RunRecord> earlier;
  try {
    earlier = read_run(file);
  } catch (const ConfigError&) {  // of another version
  }
  if (!earlier || earlier->ids.run_id != record.ids.run_id || earlier->steps.size() <= record.steps.size())
    return "";
  return fmt::format("{} stays: it has {} steps of this run, and this one ended as {} after {}",
                     file.string(), earlier->steps.size(), to_string(record.status.outcome),
                     record.steps.size());
}

/// The checkpoint that the run goes on from.
std::optional<Resumed> resumed_from(Checkpoint& checkpoint, const RunRecord& asked_for,
                                    const RunOptions& options) {
  if (options.resume == Resume::yes) return read_resumed(checkpoint, asked_for);
  if (!checkpoint.exists()) return std::nullopt;
  std::string why = "this run begins anew without --resume";
  if (options.resume == Resume::if_this_run) {
    try {
      return read_resumed(checkpoint, asked_for);
    } catch (const ConfigError& error) {
      why = error.what();
      checkpoint.forget();
    }
  }
  if (options.tell) options.tell(fmt::format("{} goes: {}", checkpoint.file().string(), why));
  return std::nullopt;
}

/// The record of this very run, where the folder has it and it is requested: that of a process that was killed behind it, or
/// of one that had the folder a moment ago.
std::optional<RunRecord> recorded(const RunRecord& asked_for, const RunOptions& options) {
  if (options.resume == Resume::no) return std::nullopt;
  try {
    auto stored = read_stored_run(options.folder / "run.json");
    if (stored && why_run_again(*stored, asked_for).empty()) return std::move(stored->record);
  } catch (const ConfigError&) {  // of another version: it gives way
  }
  return std::nullopt;
}

/// What a process that was killed had finished gets its names. The checkpoint of a run that is over goes first: nothing
/// would ever go on from it.
void put_finished_in_place(const std::filesystem::path& folder, Checkpoint& checkpoint) {
  try {
    const auto finished = read_run(pending_record(folder));
    if (finished && !was_cut(finished->status.outcome)) checkpoint.remove();
  } catch (const ConfigError&) {  // of another version: what lies there is judged as it is
  }
  put_in_place(folder);
}

/// simulate(); where memory or a device fails before the first step, the record reports it. Interrupted: nothing of this run is left
/// but what it can go on from.
void simulate_or_say(const RunConfig& config, const Scene& scene, const RunOptions& options,
                     Checkpoint& checkpoint, Resumed* resumed, RunRecord& record, RunFiles& files) {
  try {
    simulate(config, scene, options, checkpoint, resumed, record, files);
  } catch (const std::bad_alloc&) {  // of a step: see Pass
    record.status.outcome = Outcome::oom;
    record.status.detail = "memory ran out before the first step";
  } catch (const exec::OutOfMemory& error) {
    record.status.outcome = Outcome::oom;
    record.status.detail = fmt::format("before the first step of a pass: {}", error.what());
  } catch (const exec::ExecutionError& error) {
    record.status.outcome = Outcome::kernel_failed;
    record.status.detail = fmt::format("before the first step of a pass: {}", error.what());
  } catch (const Interrupted&) {
    if (checkpoint.exists()) throw Interrupted{goes_on_text(checkpoint)};
    files.leave_nothing();
    remove_unfinished(options.folder);
    throw;
  }
}

/// What a record reports of a whole run, once its last step is over.
void complete(const RunConfig& config, const RunOptions& options, const RunFiles& files, RunRecord& record) {
  record.artifacts = files.written();  // also where memory ran out beside a step
  fill_labels(config, options, record);
  record.comparability = judge_comparability(compared_run(record, options.folder), std::nullopt);
  record.status.ended_utc = utc_now();
  record.summary.peak_rss_bytes = peak_rss_bytes();
}

/// The record and its files take the place of what is in the folder, unless that says more than they do. Errors: EarlierStays,
/// DeviceStopped.
void put_record(const RunConfig& config, const RunOptions& options, bool resumed, Checkpoint& checkpoint,
                RunRecord& record, RunFiles& files) {
  const bool device_stopped = can_lose_device(config) && stops_device(record.status.outcome);
  // A resumed run that has made a step of its pass is beyond what is kept; one that was stopped before has nothing yet.
  const bool beyond = resumed && !record.steps.empty();
  if (const std::string why = beyond ? "" : why_earlier_stays(record, options); !why.empty()) {
    const std::string told = checkpoint.exists() ? why + "; " + goes_on_text(checkpoint) : why;
    if (device_stopped) throw DeviceStopped(record.status.outcome, record.status.detail + "\n" + told);
    throw EarlierStays(told);
  }
  files.close();
  write_atomically(pending_record(options.folder), to_json(record));
  if (!was_cut(record.status.outcome)) checkpoint.remove();
  put_in_place(options.folder);
  if (device_stopped) {
    throw DeviceStopped(record.status.outcome, stopped_text(record, options, checkpoint));
  }
}

}  // namespace

std::vector<std::string> formula_caveats(const RunConfig& config) {
  std::vector<std::string> out;
  for (const FormulaLibrary& library : formulas_in(config)) {
    if (library.unproven.empty()) continue;
    out.push_back(fmt::format("{}: the signs of b, b' and b'' are {}", library.name, library.unproven));
  }
  return out;
}

std::string run_label(const RunConfig& config) {
  return fmt::format("{}-{}-{}", config.scene.name, label_of(config.formulation),
                     config_id(config).substr(0, 8));
}

std::string own_note(const RunConfig& config) {
  const std::string& lead = config.name.empty() ? config.scene.name : config.name;
  const FormulationConfig& formulation = config.formulation;
  if (!formulation.name.empty()) return fmt::format("{}: {}", lead, formulation.name);
  return fmt::format("{}: {}, {} {}", lead, formulation.shape, formulation.stiffness_policy.name,
                     config_id(config).substr(0, 8));
}

RunRecord identified(const RunConfig& config, const RunOptions& options) {
  RunRecord record;
  record.passes = {config.passes.time, config.passes.diagnose, config.passes.audit};
  const RunConfig named = name_from(options.folder, config);
  record.config.text = resolved_json(named);
  for (const BodyConfig& body : named.scene.bodies) {
    for (const MeshSource* mesh : {&body.mesh, &body.rest_mesh}) {
      if (!mesh->file.empty()) record.scene.mesh_sha256[mesh->file] = mesh->sha256;
    }
    for (const WeightGroupConfig& group : body.weights) {
      if (!group.file.path.empty()) record.scene.mesh_sha256[group.file.path] = group.file.sha256;
    }
    for (const FilmSource* film : films_of(body)) {
      for (const HashedFile& file : film->files) record.scene.mesh_sha256[file.path] = file.sha256;
      const HashedFile& times = film->times_file;
      if (!times.path.empty()) record.scene.mesh_sha256[times.path] = times.sha256;
    }
  }
  record.provenance = collect_provenance(options.argv, thread_count(config));
  record.provenance.plugins = name_from(options.folder, with_formulas(config, options.plugins));
  record.machine = collect_machine();
  record.machine.card = card_of(config);
  if (!options.sweep_id.empty()) record.ids.sweep_id = options.sweep_id;
  if (!options.rerun_of.empty()) record.ids.rerun_of = options.rerun_of;
  fill_ids(record);
  return record;
}

RunRecord run_config(const RunConfig& asked, const RunOptions& given) {
  RunConfig config = asked;
  decide_linear_solver(config);
  RunOptions options = given;
  if (options.note.empty()) options.note = own_note(config);
  if (options.time_limit_s > 0) options.deadline_s = now_s() + options.time_limit_s;
  const auto threads = threads_of(config);
  set_one_blas_thread();  // before the record reports how many there are, and before anything computes
  // before anything is written: a fault that config and files show is refused here
  const Scene scene = build_scene(config);
  require_device(config, scene);
  check_step_solver_forms(config, scene);
  require_usable(config.linear_solver.name);
  const std::string started_utc = utc_now();
  const FolderLock lock(options.folder);
  const RunRecord asked_for = identified(config, options);  // inputs where they are now
  Checkpoint checkpoint(options.folder, asked_for.ids.build_id, asked_for.config.text);
  put_finished_in_place(options.folder, checkpoint);
  if (auto record = recorded(asked_for, options)) return *record;
  if (options.tell) {
    for (const std::string& caveat : formula_caveats(config)) options.tell(caveat);
  }
  require_replaceable({options.folder, asked_for, options.replace, options.resume == Resume::yes, ""},
                      options.tell);
  std::optional<Resumed> resumed = resumed_from(checkpoint, asked_for, options);
  resumed ? remove_temporaries(options.folder) : remove_unfinished(options.folder);
  check_writable(options.folder);
  if (options.keep_inputs) copy_inputs(options.folder, config, options.plugins);
  RunRecord record = identified(config, options);
  fill_method(config, record);
  record.status.started_utc = resumed ? resumed->record.status.started_utc : started_utc;
  record.validity.build = options.build;

  RunFiles files;
  simulate_or_say(config, scene, options, checkpoint, resumed ? &*resumed : nullptr, record, files);
  complete(config, options, files, record);
  put_record(config, options, resumed.has_value(), checkpoint, record, files);
  return record;
}

}  // namespace bb
