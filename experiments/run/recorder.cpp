#include "experiments/run/recorder.hpp"

#include "core/newton/newton_system.hpp"
#include "core/step_solvers/registry.hpp"
#include "core/terms/contact.hpp"
#include "experiments/config/step_promise.hpp"
#include "experiments/run/keep_record.hpp"
#include "experiments/run/run_summary.hpp"
#include "experiments/run/step_energies.hpp"

namespace bb {

Recorder::Recorder(const RunConfig& config, const Scene& scene, RunRecord& record, TraceWriter* trace,
                   ArtifactWriter* artifacts)
    : config_(config),
      record_(record),
      trace_(trace),
      artifacts_(artifacts),
      condition_(config, artifacts),
      first_contacts_(scene),
      gaps_(scene) {
  if (artifacts_ && config.output.frames_every > 0) artifacts_->start();
  if (artifacts_ && config.output.pair_forces.value_or(false)) pair_forces_.emplace(scene);
  record_.audit.enabled = config.passes.audit;
  if (config.passes.audit)
    audit_.emplace(scene, config.time.dt, config.contact.min_gap_fraction, record_.audit,
                   promised_overlap(config), config.contact.model == ContactModel::points);
}

void Recorder::on_matrix(StepSystem& system, int step, int iteration) {
  condition_.on_matrix(system, step, iteration);
}

void Recorder::on_iteration(const IterationReport& report) {
  seen_.push_back(report.time);
  linear_.push_back(report.solve.linear.iterations);
  TraceRow row = report;
  const std::size_t n = seen_.size() - 1;  // a run that was timed may have stopped earlier
  row.time = n < reported_->size() ? (*reported_)[n] : PhaseTimes{};
  condition_.on_iteration(report.solve.linear, row);
  if (trace_) rows_.push_back(std::move(row));
}

void Recorder::on_motion(const Positions& x0, const Positions& x1, int step) {
  if (audit_) audit_->on_motion(x0, x1, step);
}

// The rows of the attempt stay in the trace, its motions are not those of the run.
void Recorder::on_retry(int step) {
  if (audit_) audit_->on_retry();
  forget_attempt(step);
}

void Recorder::on_redo(int step) {
  if (audit_) audit_->on_redo();
  forget_attempt(step);
}

void Recorder::forget_attempt(int step) {
  if (artifacts_) artifacts_->drop_matrices(step);
  condition_.forget_step();
}

bool Recorder::wants_forces() const {
  const OutputConfig& output = config_.output;
  return pair_forces_ || output.contact_forces.value_or(false) || output.friction_forces.value_or(false);
}

// Friction alone does without the rows of contact.
std::vector<ContactForce> Recorder::forces_of(Diagnosis& state) const {
  const bool all = pair_forces_ || config_.output.contact_forces.value_or(false);
  std::vector<ContactForce> out;
  for (const auto& term : state.terms()) {
    if (all || term->name() == "friction") term->add_forces(state.x(), state.x_n(), out);
  }
  return out;
}

// Frames, forces and first contacts. A run on a device that is only timed has none: rows would have to be found again on
// the CPU.
void Recorder::look_at_rows(StepSystem& system, const StepReport& report, const Positions& x) {
  if (!system.is_on_host() && !trace_ && !audit_ && !artifacts_) return;
  Diagnosis& state = system.on_host().diagnosis();
  const ContactState& contact = contact_state(state.terms());
  const std::vector<ContactForce> forces =
      artifacts_ && wants_forces() ? forces_of(state) : std::vector<ContactForce>();
  if (artifacts_ && config_.output.frames_every > 0) {
    const int n = system.view().scene().n_vertices();
    last_.emplace(LastState{report.step, x, contact_fields(contact, n)});
    ContactFields& fields = last_->fields;
    if (config_.output.contact_forces.value_or(false)) fields.contact = vertex_forces(forces, n, false);
    if (config_.output.friction_forces.value_or(false)) fields.friction = vertex_forces(forces, n, true);
    if (report.step % config_.output.frames_every == 0) write_last();
  }
  if (pair_forces_) pair_forces_->add(report.step, report.t_s, forces);
  first_contacts_.note(contact, report.step, record_.summary.first_contact);
}

void Recorder::write_last() {
  if (last_) artifacts_->frame(last_->x, last_->step, last_->fields);
  last_.reset();
}

void Recorder::on_step(StepSystem& system, const StepReport& report, const Positions& x) {
  look_at_rows(system, report, x);
  if (report.status == StepStatus::converged) gaps_.add(report.contact_loads, report.dt_s);
  condition_.end_step();
  StepRecord step = report;
  step.time = {};  // that of the timed run is filled in when the runs are over
  fill_energies(system, step);
  if (audit_) audit_->on_step(x, step);
  record_.steps.push_back(std::move(step));
  if (!trace_) return;
  for (TraceRow& row : rows_) {
    row.t_s = report.t_s;
    trace_->add(row);
  }
  rows_.clear();
  trace_->end_step();
}

void Recorder::keep(Archive& archive) {
  archive.section("recorder");
  archive.grown("records", record_.steps);
  archive.grown("linear", linear_);
  archive.grown("iterations", seen_);
  archive(record_.summary.first_contact, record_.audit, condition_, first_contacts_, gaps_, last_);
  if (audit_) archive(*audit_);
  if (pair_forces_) archive(*pair_forces_);
}

void Recorder::LastState::keep(Archive& archive) {
  archive(step, x, fields.gap_rel, fields.load, fields.contact, fields.friction);
}

void Recorder::finish() {
  write_last();
  if (pair_forces_) artifacts_->pair_forces(pair_forces_->csv());
  const StepSolverEntry& solver = step_solvers().require(config_.step_solver.name, "/step_solver/name");
  summarize_steps(solver.counters, record_);
  record_.summary.convergence = solver.asked_to_converge ? "asked" : "not_asked";
  record_.summary.linear_per_solve = summarize(linear_);
  condition_.fill(record_.summary);
  record_.summary.contact_gaps = gaps_.summary();
}

Verdict Recorder::audit_verdict() const { return audit_ ? audit_->verdict() : Verdict(); }

}  // namespace bb
