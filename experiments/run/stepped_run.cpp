#include "experiments/run/stepped_run.hpp"

#include <fmt/format.h>

#include <new>
#include <stdexcept>

#include "core/base/record/provenance.hpp"
#include "core/base/record/run_folder.hpp"
#include "core/base/record/writer.hpp"
#include "core/linear/blas_info.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/error.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/comparability.hpp"
#include "experiments/run/device_run.hpp"
#include "experiments/run/earlier_run.hpp"
#include "experiments/run/fill_record.hpp"
#include "experiments/run/input_files.hpp"
#include "experiments/run/linear_choice.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/start_check.hpp"
#include "experiments/run/thread_limit.hpp"
#include "experiments/run/validity.hpp"

namespace bb {
namespace {

RunConfig stepped(const RunConfig& asked) {
  RunConfig config = asked;
  decide_linear_solver(config);
  if (can_lose_device(config)) {
    throw ConfigError("/device", "a run on a card", "cpu or host, for a run by single steps");
  }
  if (has_observed_run(config)) config.passes.time = false;
  return config;
}

/// The recorder, and the caller's hook behind it.
class HookedRecorder final : public StepObserver {
 public:
  HookedRecorder(Recorder& recorder, const SteppedRun::Iteration& iteration)
      : recorder_(recorder), iteration_(iteration) {}
  void on_matrix(StepSystem& system, int step, int iteration) override {
    recorder_.on_matrix(system, step, iteration);
  }
  void on_iteration(const IterationReport& report) override {
    recorder_.on_iteration(report);
    if (iteration_) iteration_(report);
  }
  bool watches_motions() const override { return recorder_.watches_motions(); }
  void on_motion(const Positions& x0, const Positions& x1, int step) override {
    recorder_.on_motion(x0, x1, step);
  }
  void on_retry(int step) override { recorder_.on_retry(step); }
  void on_redo(int step) override { recorder_.on_redo(step); }
  void on_step(StepSystem& system, const StepReport& report, const Positions& x) override {
    recorder_.on_step(system, report, x);
  }

 private:
  Recorder& recorder_;
  const SteppedRun::Iteration& iteration_;
};

}  // namespace

class ThreadLimit {
 public:
  explicit ThreadLimit(const RunConfig& config) : limit_(threads_of(config)) {}

 private:
  oneapi::tbb::global_control limit_;
};

SteppedRun::SteppedRun(const RunConfig& asked, RunOptions options)
    : asked_time_(asked.passes.time),
      config_(stepped(asked)),
      threads_(std::make_unique<ThreadLimit>(config_)),
      options_(std::move(options)) {
  set_one_blas_thread();
  scene_ = build_scene(config_);
  require_device(config_, scene_);
  check_step_solver_forms(config_, scene_);
  require_usable(config_.linear_solver.name);
  const OutputConfig& output = config_.output;
  if (!has_folder() && (output.frames_every > 0 || output.matrices || output.pair_forces.value_or(false))) {
    throw ConfigError("/output", "frames, matrices or forces", "a folder to write them to, or none of them");
  }
  prepare();
}

SteppedRun::~SteppedRun() {
  if (finished_ || !lock_) return;
  files_.leave_nothing();
  remove_unfinished(options_.folder);
}

void SteppedRun::take_folder() {
  lock_.emplace(options_.folder);
  put_in_place(options_.folder);
  RunConfig asked = config_;
  asked.passes.time = asked_time_;
  const std::string asked_text = resolved_json(name_from(options_.folder, std::move(asked)));
  require_replaceable({options_.folder, record_, options_.replace, false, asked_text}, options_.tell);
  if (options_.replace != Replace::all && Checkpoint(options_.folder, "").exists()) {
    throw ConfigError(options_.folder.string(), "the checkpoint of a run that is not over",
                      "another folder, bench run --resume, or replace=True");
  }
  remove_unfinished(options_.folder);
  check_writable(options_.folder);
}

void SteppedRun::prepare() {
  if (options_.note.empty()) options_.note = own_note(config_);
  RunOptions named = options_;
  if (!has_folder()) named.folder = ".";
  record_ = identified(config_, named);
  if (has_folder()) take_folder();
  fill_method(config_, record_);
  record_.status.started_utc = utc_now();
  record_.validity.build = options_.build;
  fill_scene(scene_, record_);
  record_.matching.rule = to_string(config_.matching.rule);
  plan_ = plan_of(config_, scene_);
  fill_plan(config_, plan_, record_);
  t_end_ = end_time(config_.time) * (1 - 1e-9);
  const double before_check = now_s();
  auto failure = start_failure(config_, scene_, plan_.contacts);
  record_.summary.start_check_s = now_s() - before_check;
  if (!failure) failure = find_stiffness(config_, scene_, named, record_.matching, calibration_);
  if (failure) {
    result_.verdict = *failure;
    return;
  }
  if (has_folder() && has_observed_run(config_)) {
    files_.trace.emplace(options_.folder);
    files_.artifacts.emplace(options_.folder, scene_);
  }
  make_pass();
}

void SteppedRun::make_pass() {
  recorder_.emplace(config_, scene_, record_, files_.trace ? &*files_.trace : nullptr,
                    files_.artifacts ? &*files_.artifacts : nullptr);
  simulation_.reset();
  method_.emplace(make_method(config_, calibration_));
  simulation_ = std::make_unique<Simulation>(scene_, *method_, plan_, config_.time.dt, config_.time.steps);
}

bool SteppedRun::over() const {
  return finished_ || !simulation_ || result_.verdict.outcome != Outcome::ok ||
         !(simulation_->time() < t_end_);
}

// Everything that a step changes.
void SteppedRun::keep(Archive& archive) {
  archive.scope("run");
  if (files_.artifacts) archive(*files_.artifacts);
  archive(result_, *simulation_, *recorder_);
}

void SteppedRun::go_back(const Archive& start) {
  make_pass();
  GrownLists before;
  before.add(log_);
  Archive again(start.bytes(), before);
  keep(again);
  lists_ = {};
  lists_.count = before.count;
}

const StepRecord& SteppedRun::step(const Iteration& iteration) {
  if (over()) {
    throw std::logic_error(fmt::format("the run is over: {}{}{}", to_string(result_.verdict.outcome),
                                       result_.verdict.detail.empty() ? "" : ": ", result_.verdict.detail));
  }
  Archive start(lists_);
  keep(start);
  log_ += std::move(lists_.added);
  lists_.added.clear();
  try {
    HookedRecorder observer(*recorder_, iteration);
    const double begin = now_s();
    const StepReport report = simulation_->step(observer);
    result_.steps.push_back({now_s() - begin, report.time});
    result_.wall_s += result_.steps.back().wall_s;
    result_.verdict = judge_step(report);
  } catch (const std::bad_alloc&) {
    result_.verdict = {Outcome::oom, fmt::format("step {}: memory ran out", result_.steps.size())};
  } catch (...) {
    go_back(start);
    throw;
  }
  if (record_.steps.empty())
    throw std::bad_alloc();  // memory ran out in the first step: there is nothing to show
  return record_.steps.back();
}

void SteppedRun::close_record(Recorder& recorder, RunRecord& record) const {
  recorder.finish();
  PassResult pass = result_;
  pass.state_hash = state_hash(x());
  pass.stiffness = method_->stiffness->state();
  Verdict verdict = result_.verdict;
  if (verdict.outcome == Outcome::ok && simulation_->time() < t_end_) {
    verdict = {Outcome::timeout, fmt::format("its caller ended it after {} steps, at {:.6g} of {:.6g} s",
                                             steps(), simulation_->time(), end_time(config_.time))};
  }
  const bool observed = has_observed_run(config_);
  if (observed) {
    const Verdict audited = recorder.audit_verdict();
    merge(verdict, audited.outcome, audited.detail);
  }
  record.status.outcome = verdict.outcome;
  record.status.detail = verdict.detail;
  fill_times(observed ? PassResult() : pass, config_.passes.time, record);
  record.summary.state_hash = pass.state_hash;
  fill_stiffness(pass, record);
  fill_validity(scene_, recorder.ledger(), observed ? "" : pass.state_hash, observed ? pass.state_hash : "",
                record);
}

RunRecord SteppedRun::record() {
  if (finished_) return record_;
  RunRecord out = record_;
  if (!simulation_) {
    out.status.outcome = result_.verdict.outcome;
    out.status.detail = result_.verdict.detail;
  } else {
    if (files_.artifacts && (config_.output.frames_every > 0 || config_.output.pair_forces.value_or(false))) {
      throw std::logic_error("the record of a run with frames or forces is made by finish()");
    }
    Recorder apart(config_, scene_, out, nullptr);
    Archive written;
    recorder_->keep(written);
    Archive read(written.bytes());
    apart.keep(read);
    close_record(apart, out);
  }
  fill_labels(config_, options_, out);
  out.comparability = judge_comparability(compared_run(out, options_.folder), std::nullopt);
  out.status.ended_utc = utc_now();
  out.summary.peak_rss_bytes = peak_rss_bytes();
  return out;
}

const RunRecord& SteppedRun::finish() {
  if (finished_) return record_;
  if (simulation_) {
    close_record(*recorder_, record_);
  } else {
    record_.status.outcome = result_.verdict.outcome;
    record_.status.detail = result_.verdict.detail;
  }
  record_.artifacts = files_.written();
  fill_labels(config_, options_, record_);
  record_.comparability = judge_comparability(compared_run(record_, options_.folder), std::nullopt);
  record_.status.ended_utc = utc_now();
  record_.summary.peak_rss_bytes = peak_rss_bytes();
  if (has_folder()) {
    files_.close();
    write_atomically(pending_record(options_.folder), to_json(record_));
    put_in_place(options_.folder);
  }
  finished_ = true;
  lock_.reset();
  threads_.reset();
  return record_;
}

}  // namespace bb
