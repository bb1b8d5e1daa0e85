#include "experiments/run/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/newton/newton_system.hpp"
#include "core/terms/contact.hpp"
#include "experiments/run/audit_mesh.hpp"
#include "experiments/run/audit_verdict.hpp"
#include "experiments/run/step_record.hpp"

namespace bb {
namespace {

/// A stage leaves out groups of terms; it is there when the last of them has elements.
struct StageName {
  const char* config;
  MatrixStage stage;
  TermSet left_out;
  std::optional<TermGroup> last;
};
constexpr StageName stage_names[] = {
    {"full", MatrixStage::full, {}, {}},
    {"without_contact", MatrixStage::no_contact, TermGroup::contact, TermGroup::contact},
    {"without_contact_and_limit", MatrixStage::no_contact_no_limit,
     TermSet(TermGroup::contact) | TermGroup::limit, TermGroup::limit}};

Number gap_number(double gap) { return std::isinf(gap) ? Number::missing("no_contacts") : Number(gap); }

// Smallest d/d_hat over the rows; infinity without rows.
double smallest_relative_gap(const ContactState& state) {
  double smallest = std::numeric_limits<double>::infinity();
  const auto scan = [&smallest](const auto& rows) {
    for (std::size_t r = 0; r < rows.size(); ++r) smallest = std::min(smallest, rows.d[r] / rows.d_hat[r]);
  };
  state.for_each_table(scan);
  return smallest;
}

/// What the preconditioner of PCG makes of the matrix; nothing for one that is no scaling.
std::optional<Scaling> scaling_of(const LinearSolverConfig& solver) {
  const std::string preconditioner = preconditioner_of({solver.name, solver.parameters});
  for (const Scaling scaling : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
    if (preconditioner == to_string(scaling)) return scaling;
  }
  return std::nullopt;
}

// Empty beyond the end: a run that was timed may have stopped earlier.
PhaseTimes time_of(const std::vector<PhaseTimes>& times, std::size_t n) {
  return n < times.size() ? times[n] : PhaseTimes{};
}

void keep_smaller(Number& kept, double value) {
  if (!std::isinf(value) && (!kept.finite() || value < kept.value)) kept = value;
}

}  // namespace

Recorder::Recorder(const RunConfig& config, const Scene& scene, RunRecord& record, TraceWriter* trace,
                   ArtifactWriter* artifacts)
    : config_(config),
      scene_(scene),
      record_(record),
      trace_(trace),
      artifacts_(artifacts),
      probe_(config.diagnose.seed) {
  record_.audit.enabled = config.passes.audit;
  if (artifacts_ && config.output.frames_every > 0) artifacts_->start();
  if (config.passes.audit) {
    audit_mesh_ = make_audit_mesh(scene);
    audit_ = std::make_unique<audit::Audit>(audit_mesh_);
    audit_tolerance_ = audit_tolerance(scene, config.contact.ccd_park);
    judge(scene.x0, -1);
  }
}

Recorder::~Recorder() = default;

void Recorder::judge(const Positions& x, int step) {
  const double start = now_s();
  audit_->check_state(x, step);
  last_judged_ = x;
  record_.audit.seconds += now_s() - start;
}

bool Recorder::due(int, int iteration) const {
  if (!config_.passes.diagnose || iteration % std::max(1, config_.diagnose.every) != 0) return false;
  return config_.diagnose.budget == 0 || condition_s_ < config_.diagnose.budget;
}

void Recorder::on_matrix(NewtonSystem& system, int step, int iteration) {
  samples_.clear();
  probed_ = Number::missing("not_due");
  due_now_ = due(step, iteration);
  if (!due_now_) return;
  const double start = now_s();
  const bool before_solve = config_.diagnose.tier > 0;  // tier 0 reads what the solve leaves
  for (const std::string& name : before_solve ? config_.diagnose.stages : std::vector<std::string>()) {
    const auto* entry = std::find_if(std::begin(stage_names), std::end(stage_names),
                                     [&name](const StageName& s) { return name == s.config; });
    if (entry == std::end(stage_names) || (entry->last && !system.active(*entry->last))) continue;
    const ReducedSystem& reduced = system.reduced(TermSet::all().without(entry->left_out));
    for (const Scaling scaling : config_.diagnose.scalings) {
      ConditionSample sample;
      sample.stage = entry->stage;
      sample.scaling = scaling;
      sample.tier = config_.diagnose.tier;
      sample.estimate = estimator_.estimate(reduced, {config_.diagnose.tier, scaling, config_.diagnose.seed});
      samples_.push_back(sample);
    }
  }
  if (artifacts_ && config_.output.matrices) artifacts_->matrix(system.reduced(), step, iteration);
  if (config_.diagnose.pcg) probed_ = probe_.iterations(system.reduced());
  condition_s_ += now_s() - start;
}

// Tier 0: the spectrum that PCG saw, which is that of the full matrix scaled by its preconditioner.
void Recorder::add_ritz_sample(const LinearReport& linear) {
  const std::optional<Scaling> scaling = scaling_of(config_.linear_solver);
  if (!due_now_ || config_.diagnose.tier != 0 || !scaling) return;
  ConditionSample sample;
  sample.scaling = *scaling;
  sample.tier = 0;
  sample.estimate = condition_from_ritz(linear.ritz_min, linear.ritz_max);
  samples_.push_back(sample);
}

TraceRow Recorder::trace_row(const IterationReport& report) const {
  TraceRow row;
  row.step = report.step;
  row.iteration = report.iteration;
  row.energy_J = report.energy;
  row.energy_change_J = report.energy_change;
  row.grad_inf_N = report.grad_inf;
  row.dx_inf_m = report.dx_inf;
  row.decrement_J = report.decrement / 2;
  row.alpha = report.alpha;
  row.alpha_ccd = report.alpha_ccd;
  row.alpha_strain = report.alpha_limit;
  row.line_search_trials = report.line_search_trials;
  row.rounding_accept = report.accepted_by_rounding;
  row.linear_status = std::string(to_string(report.linear.status));
  row.linear_iterations = report.linear.iterations;
  row.residual_true = report.linear.residual_true;
  const bool iterative = report.linear.iterations > 0;
  row.residual_recurrence =
      iterative ? Number(report.linear.residual_recurrence) : Number::missing("direct_solver");
  row.ritz_min = iterative ? Number(report.linear.ritz_min) : Number::missing("direct_solver");
  row.ritz_max = iterative ? Number(report.linear.ritz_max) : Number::missing("direct_solver");
  row.probe_pcg_iterations = probed_;
  row.analyzed = report.linear.analyzed;
  row.cond = samples_;
  row.contacts = report.contacts;
  row.gap_min_iterates_m = gap_number(report.gap_min);
  row.gap_min_iterates_rel = gap_number(report.gap_min_rel);
  const bool touching = report.contacts.total() > 0;
  row.kappa_min_N_per_m = touching ? Number(report.kappa_min) : Number::missing("no_contacts");
  row.kappa_max_N_per_m = touching ? Number(report.kappa_max) : Number::missing("no_contacts");
  const bool first = report.iteration == 0;
  row.kappa_change_rel = first ? Number::missing("first_iteration") : Number(report.kappa_change);
  const bool limited = report.max_stretch > 0;
  row.limit_kappa_change_rel = !limited ? Number::missing("no_limit")
                               : first  ? Number::missing("first_iteration")
                                        : Number(report.limit_kappa_change);
  row.limit_gap_min_rel = limited ? Number(report.limit_gap_min_rel) : Number::missing("no_limit");
  row.contact_curvature_max_N_per_m =
      touching ? Number(report.curvature_max) : Number::missing("no_contacts");
  row.contact_load_max_N = touching ? Number(report.force_max) : Number::missing("no_contacts");
  row.max_stretch = report.max_stretch > 0 ? Number(report.max_stretch - 1) : Number::missing("no_limit");
  row.limit_load_max_N_per_m =
      report.max_stretch > 0 ? Number(report.limit_tension) : Number::missing("no_limit");
  row.n_free = report.n_free;
  row.nnz = report.nnz;
  return row;
}

void Recorder::on_iteration(const IterationReport& report) {
  seen_.push_back(report.times);
  add_ritz_sample(report.linear);
  if (trace_) {
    rows_.push_back(trace_row(report));
    rows_.back().time = time_of(*reported_, seen_.size() - 1);
  }
  for (const ConditionSample& sample : samples_) cond_.add(sample);
  samples_.clear();
  if (probed_.finite()) probes_.push_back(probed_.value);
  linear_.push_back(report.linear.iterations);
  keep_smaller(iterates_gap_, report.gap_min);
  keep_smaller(iterates_gap_rel_, report.gap_min_rel);
}

void Recorder::on_motion(const Positions& x0, const Positions& x1, int step) {
  if (!audit_) return;
  const double start = now_s();
  if (x0 != last_judged_) audit_->note_unjudged(step);
  audit_->check_motion(x0, x1, step, audit_tolerance_);
  record_.audit.seconds += now_s() - start;
  judge(x1, step);
}

void Recorder::note_contacts(const NewtonSystem& system, int step) {
  const Scene& scene = system.scene();
  const auto n_bodies = static_cast<int>(scene.bodies.size());
  const auto name = [&](int owner) {
    return owner < n_bodies ? scene.bodies[static_cast<std::size_t>(owner)].name
                            : scene.obstacles[static_cast<std::size_t>(owner - n_bodies)].name;
  };
  const auto scan = [&](const auto& rows) {
    for (const ContactKey& key : rows.key) {
      int first = std::numeric_limits<int>::max(), second = -1;
      for (const int id : key) {
        if (id == -1) continue;
        const int owner = id < 0 ? n_bodies - 2 - id : scene.body[static_cast<std::size_t>(id)];
        first = std::min(first, owner);
        second = std::max(second, owner);
      }
      if (!touching_.emplace(first, second).second) continue;
      const std::string one = name(first), other = name(second);
      record_.summary.first_contact.emplace(std::min(one, other) + "|" + std::max(one, other), step);
    }
  };
  contact_state(system.terms()).for_each_table(scan);
}

// Gaps of the method are those of converged step ends; an iterate's are a matter of the path to them.
void Recorder::fill_gaps(const NewtonSystem& system, const StepReport& report, StepRecord& step) {
  const double gap_rel = smallest_relative_gap(contact_state(system.terms()));
  if (report.status == StepStatus::converged) {
    step.gap_min_m = gap_number(report.gap_min);
    step.gap_min_rel = gap_number(gap_rel);
  } else {
    step.gap_min_m = step.gap_min_rel = Number::missing("not_converged");
  }
  keep_smaller(iterates_gap_, report.gap_min);
  keep_smaller(iterates_gap_rel_, gap_rel);
  step.gap_min_iterates_m = iterates_gap_.finite() ? iterates_gap_ : Number::missing("no_contacts");
  step.gap_min_iterates_rel = iterates_gap_rel_.finite() ? iterates_gap_rel_ : Number::missing("no_contacts");
  iterates_gap_ = iterates_gap_rel_ = Number();
}

void Recorder::on_step(NewtonSystem& system, const StepReport& report, const Positions& x) {
  if (audit_ && x != last_judged_) audit_->note_unjudged(report.step);
  const int every = config_.output.frames_every;
  if (artifacts_ && every > 0 && report.step % every == 0) {
    artifacts_->frame(x, report.step,
                      contact_fields(contact_state(system.terms()), system.scene().n_vertices()));
  }
  StepRecord step = step_record(system, report);
  note_contacts(system, report.step);
  fill_gaps(system, report, step);
  if (audit_) {
    const audit::AuditLedger& ledger = audit_->ledger();
    step.crossings = ledger.crossings - record_.audit.crossings;
    step.violations = ledger.violations + ledger.obstacle_violations - record_.audit.violations;
    step.unproven = ledger.unproven - record_.audit.unproven;
    step.inverted = ledger.inverted - record_.audit.inverted;
    record_.audit.crossings = ledger.crossings;
    record_.audit.violations = ledger.violations + ledger.obstacle_violations;
    record_.audit.unproven = ledger.unproven;
    record_.audit.inverted = ledger.inverted;
  }
  record_.steps.push_back(step);

  newton_.push_back(report.iterations);
  contacts_.push_back(static_cast<double>(report.contacts.total()));
  if (step.gap_min_rel.finite()) gaps_.push_back(step.gap_min_rel.value);
  for (TraceRow& row : rows_) {
    row.t_s = report.t;
    trace_->add(row);
  }
  rows_.clear();
  if (trace_) trace_->end_step();
}

void Recorder::finish() {
  Summary& summary = record_.summary;
  for (const StepRecord& step : record_.steps) {
    ++summary.steps;
    summary.steps_capped += step.status == "iteration_cap";
    summary.newton_iterations += step.newton_iterations;
    summary.linear_iterations += step.linear_iterations;
    summary.linear_solves += step.linear_solves;
    summary.factorizations += step.factorizations;
    summary.analyses += step.analyses;
    summary.line_search_trials += step.line_search_trials;
    summary.ccd_queries += step.ccd_queries;
    summary.ccd_probes += step.ccd_probes;
    summary.ccd_capped += step.ccd_capped;
    const auto keep_gap = [](Number& kept, const Number& gap) {
      if (gap.finite()) keep_smaller(kept, gap.value);
    };
    keep_gap(summary.gap_min_m, step.gap_min_m);
    keep_gap(summary.gap_min_iterates_m, step.gap_min_iterates_m);
    keep_gap(summary.gap_min_iterates_rel, step.gap_min_iterates_rel);
    const auto keep_larger = [](Number& kept, const Number& value) {
      if (value.finite() && (!kept.finite() || value.value > kept.value)) kept = value;
    };
    keep_larger(summary.max_stretch, step.max_stretch);
    keep_larger(summary.contact_load_max_N, step.contact_load_max_N);
    keep_larger(summary.limit_load_max_N_per_m, step.limit_load_max_N_per_m);
  }
  summary.newton_per_step = summarize(newton_);
  summary.linear_per_solve = summarize(linear_);
  summary.probe_pcg = summarize(probes_);
  summary.contacts = summarize(contacts_);
  summary.gap_min_rel = summarize(gaps_);
  summary.cond = cond_.summary();
  if (audit_) fill_audit();
}

void Recorder::fill_audit() {
  const audit::AuditLedger& ledger = audit_->ledger();
  AuditRecord& out = record_.audit;
  out.edges = ledger.subjects.edges;
  out.triangles = ledger.subjects.triangles;
  out.vertices = ledger.subjects.vertices;
  out.obstacles = ledger.subjects.obstacles;
  out.states = ledger.states;
  out.motions = ledger.motions;
  out.state_pairs = ledger.state_pairs;
  out.motion_pairs = ledger.motion_pairs;
  out.obstacle_queries = ledger.obstacle_queries;
  out.judged = ledger.judged();
  out.crossings = ledger.crossings;
  out.touches = ledger.touches;
  out.violations = ledger.violations + ledger.obstacle_violations;
  out.unproven = ledger.unproven;
  out.inverted = ledger.inverted;
  out.obstacle_violations = ledger.obstacle_violations;
  out.scene_faults = ledger.scene_faults;
  out.first_bad_step = ledger.first_bad_step;
  for (const auto& found : {ledger.first_bad, ledger.first_fault}) {
    if (found) out.examples.push_back(describe(scene_, audit_mesh_, *found));
  }
}

Verdict Recorder::audit_verdict() const {
  return audit_ ? judge_audit(scene_, audit_mesh_, audit_->ledger()) : Verdict();
}

}  // namespace bb
