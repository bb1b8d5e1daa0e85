#include "experiments/run/passes.hpp"

#include <stdexcept>

#include "core/math/error.hpp"
#include "experiments/run/device_run.hpp"
#include "experiments/run/fill_record.hpp"
#include "experiments/run/keep_record.hpp"
#include "experiments/run/pass.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/stored_run.hpp"
#include "experiments/run/validity.hpp"

namespace bb {

// found by its argument, so outside of the namespace without a name
static void keep(Archive& archive, Calibration& c) {
  archive(c.kappa, c.k_s, c.solid_k_s, c.scale, c.limit_scale, c.limited);
}

namespace {

/// The two passes, and what a checkpoint between two of their steps has to hold.
class PassSequence {
 public:
  PassSequence(const RunConfig& config, const Scene& scene, const Plan& plan, const Calibration& calibration,
               const RunOptions& options, Checkpoint& checkpoint, RunRecord& record, RunFiles& files)
      : config_(config),
        scene_(scene),
        plan_(plan),
        calibration_(calibration),
        options_(options),
        checkpoint_(checkpoint),
        begun_(record),
        record_(record),
        files_(files) {}

  void run(Resumed* resumed) {
    if (resumed) {
      rest_ = &resumed->rest;
      keep_timed(*rest_);
    }
    const bool look = has_observed_run(config_);
    if (config_.passes.time && !in_second_) run_timed(look);
    const bool cut = config_.passes.time && !timed_.whole;  // memory or time ran out: there is no second pass
    in_second_ = look && !cut;
    if (in_second_) run_observed();
    finish(look && cut);
  }

 private:
  void run_timed(bool look) {
    RunConfig bare = config_;
    bare.passes = {true, false, false};
    RunRecord apart;  // only times and hash of the timed pass are used where another one follows
    Recorder recorder(bare, scene_, look ? apart : record_, nullptr);
    Pass pass(bare, scene_, calibration_, plan_, options_, "time", recorder, look ? 1 : 0);
    go_on(pass);
    timed_ = pass.run([&](Pass::Moment moment) { save(pass, moment); });
    keep_held(timed_);
    recorder.finish();
    if (options_.build.valid) times_ = recorder.iteration_times();
    if (!look || timed_.whole) return;
    record_.steps = std::move(apart.steps);  // of a run that was cut off they are all that there is
    record_.summary = apart.summary;
  }

  void run_observed() {
    rest_ ? files_.trace.emplace(options_.folder, checkpoint_.trace())
          : files_.trace.emplace(options_.folder);
    files_.artifacts.emplace(options_.folder, scene_);
    Recorder recorder(config_, scene_, record_, &*files_.trace, &*files_.artifacts);
    recorder.report_times(times_);
    Pass pass(config_, scene_, calibration_, plan_, options_, "diagnose", recorder);
    if (rest_) {
      rest_->scope(scope());
      (*rest_)(*files_.artifacts);
    }
    go_on(pass);
    seen_ = pass.run([&](Pass::Moment moment) { save(pass, moment); });
    keep_held(seen_);
    recorder.finish();
    if (recorder.ledger()) ledger_ = *recorder.ledger();
    audited_ = recorder.audit_verdict();
  }

  void go_on(Pass& pass) {
    if (!rest_) return;
    rest_->scope(scope());
    (*rest_)(pass);
    if (!rest_->at_end()) throw std::logic_error("checkpoint: more than a run reads");
    rest_ = nullptr;
    record_.status.resumed_from_step = static_cast<double>(pass.steps());
    if (files_.artifacts) files_.artifacts->leave_unfinished();
  }

  /// The lists of the first pass have their names in the checkpoint's log while it runs and after it.
  const char* scope() const { return in_second_ ? "second" : "first"; }

  void keep_timed(Archive& archive) {
    archive.scope("first");
    archive(in_second_, timed_);
    archive.grown("iterations", times_);
  }

  void save(Pass& pass, Pass::Moment moment) {
    if (moment == Pass::Moment::before_device) {
      held_.emplace(archive_of(pass, false));
      return;
    }
    const bool sync = moment == Pass::Moment::stop || checkpoint_.should_sync();
    const Held now = archive_of(pass, sync);
    checkpoint_.write(now.archive, now.trace, sync);
  }

  /// A device failed: the run can go on from the end of the last step.
  void keep_held(const PassResult& result) {
    if (held_ && stops_device(result.verdict.outcome)) checkpoint_.write(held_->archive, held_->trace, true);
    held_.reset();
  }

  struct Held {
    Archive archive;
    FilePrefix trace;
  };

  Held archive_of(Pass& pass, bool sync) {
    Held out{checkpoint_.begin(), {}};
    Calibration calibration = calibration_;
    out.archive(begun_, calibration);
    keep_timed(out.archive);
    out.archive.scope(scope());
    if (in_second_) {
      out.trace = files_.trace->checkpoint(sync);
      out.archive(*files_.artifacts);
      files_.artifacts->leave_unfinished();
    }
    out.archive(pass);
    return out;
  }

  void finish(bool second_left_out) {
    const PassResult& main = in_second_ ? seen_ : timed_;
    Verdict verdict = main.verdict;
    if (in_second_) merge(verdict, audited_.outcome, audited_.detail);
    if (second_left_out) verdict.detail += "; the passes `diagnose` and `audit` were not run";
    record_.status.outcome = verdict.outcome;
    record_.status.detail = verdict.detail;
    fill_times(timed_, config_.passes.time, record_);
    record_.summary.state_hash = main.state_hash;
    fill_stiffness(main, record_);
    // a pass that was cut off ends in another state: that shows nothing about the other one
    const std::string seen_hash = in_second_ && seen_.whole ? seen_.state_hash : "";
    fill_validity(scene_, ledger_ ? &*ledger_ : nullptr, timed_.state_hash, seen_hash, record_);
  }

  const RunConfig& config_;
  const Scene& scene_;
  const Plan& plan_;
  const Calibration& calibration_;
  const RunOptions& options_;
  Checkpoint& checkpoint_;
  RunRecord begun_;
  RunRecord& record_;
  RunFiles& files_;
  bool in_second_ = false;
  PassResult timed_, seen_;
  std::vector<PhaseTimes> times_;  // of the iterations of the first pass
  std::optional<audit::AuditLedger> ledger_;
  Verdict audited_;
  std::optional<Held> held_;  // the end of the last step, of a run on a device
  Archive* rest_ = nullptr;   // what a checkpoint still holds
};

}  // namespace

std::optional<Resumed> read_resumed(Checkpoint& checkpoint, const RunRecord& now) {
  std::optional<Archive> archive = checkpoint.read();
  if (!archive) return std::nullopt;
  Resumed out;
  (*archive)(out.record, out.calibration);
  out.rest = std::move(*archive);
  const std::vector<Difference> others = differences(out.record, now);
  if (others.empty() && out.record.ids.run_id == now.ids.run_id) return out;
  std::string what;
  for (const Difference& other : others) what += (what.empty() ? "" : "; ") + other.what;
  throw ConfigError(checkpoint.file().string(),
                    "a checkpoint of another run: " + (what.empty() ? "another run_id" : what),
                    "one of this very run, or no --resume");
}

void run_passes(const RunConfig& config, const Scene& scene, const Plan& plan, const Calibration& calibration,
                const RunOptions& options, Checkpoint& checkpoint, Resumed* resumed, RunRecord& record,
                RunFiles& files) {
  PassSequence(config, scene, plan, calibration, options, checkpoint, record, files).run(resumed);
}

}  // namespace bb
