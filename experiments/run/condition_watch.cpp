#include "experiments/run/condition_watch.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/linear/end_vectors.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/newton/newton_system.hpp"
#include "experiments/run/matrix_dump.hpp"
#include "experiments/run/spectrum_ends.hpp"

namespace bb {
namespace {

/// A stage leaves out groups of terms; it is there when one of `needed` has elements, or when it leaves out nothing.
struct Stage {
  MatrixStage name;
  TermSet left_out;
  std::vector<TermGroup> needed;
};
constexpr TermSet of_contact = TermSet(TermGroup::contact) | TermGroup::friction;
const Stage stages[] = {
    {MatrixStage::full, {}, {}},
    {MatrixStage::without_contact, of_contact, {TermGroup::contact, TermGroup::friction}},
    {MatrixStage::without_limit, TermGroup::limit, {TermGroup::limit}},
    {MatrixStage::without_contact_and_limit, of_contact | TermGroup::limit, {TermGroup::limit}}};

/// What the preconditioner of PCG makes of the matrix; nothing for one that is no scaling.
std::optional<Scaling> scaling_of(const LinearSolverConfig& solver) {
  const std::string preconditioner = preconditioner_of({solver.name, solver.parameters});
  for (const Scaling scaling : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
    if (preconditioner == to_string(scaling)) return scaling;
  }
  return std::nullopt;
}

/// A value that is unknown is absent for the reason that the estimate itself gives.
ConditionSample sample_of(MatrixForm matrix, MatrixStage stage, Scaling scaling, Estimator estimator,
                          const ConditionEstimate& e) {
  const auto known = [&e](double v) {
    return std::isfinite(v) ? Number(v) : Number::missing(to_string(e.status).data());  // a literal
  };
  return {matrix,
          stage,
          scaling,
          static_cast<int>(estimator),
          known(e.lambda_min),
          known(e.lambda_max),
          known(e.cond),
          e.status,
          e.method,
          e.proof,
          e.residual,
          e.solves,
          e.products,
          e.factorizations,
          e.seconds,
          {}};
}

}  // namespace

ConditionWatch::ConditionWatch(const RunConfig& config, ArtifactWriter* artifacts)
    : config_(config), artifacts_(artifacts), probe_(config.diagnose.seed) {}

bool ConditionWatch::due(int iteration) const {
  if (!config_.passes.diagnose || iteration % std::max(1, config_.diagnose.every) != 0) return false;
  return config_.diagnose.budget == 0 || spent_s_ < config_.diagnose.budget;
}

void ConditionWatch::estimate(const ReducedSystem& matrix, MatrixForm form, MatrixStage stage) {
  const Estimator estimator = config_.diagnose.estimator;
  for (const Scaling scaling : config_.diagnose.scalings) {
    samples_.push_back(
        sample_of(form, stage, scaling, estimator,
                  estimator_.estimate(matrix, {estimator, scaling, config_.diagnose.seed,
                                               config_.diagnose.max_solves, config_.diagnose.max_products})));
  }
}

// Of the clamped samples that were taken last, one a scaling.
void ConditionWatch::find_ends(Diagnosis& system, TermSet set) {
  const ReducedSystem& matrix = system.clamped(set);
  const std::size_t first = samples_.size() - config_.diagnose.scalings.size();
  for (std::size_t i = first; i < samples_.size(); ++i) {
    const auto ends = end_vectors(matrix, samples_[i].scaling, config_.diagnose.seed);
    if (ends) samples_[i].ends = describe_ends(system, set, *ends);
  }
}

void ConditionWatch::on_matrix(StepSystem& step_system, int step, int iteration) {
  samples_.clear();
  probed_ = Number::missing("not_due");
  due_ = due(iteration);
  if (!due_) return;
  Diagnosis& system = step_system.on_host().diagnosis();
  form_ = system.solved_is_clamped() ? MatrixForm::clamped : MatrixForm::solved;
  const double start = now_s();
  if (config_.diagnose.estimator != Estimator::ritz) {  // ritz reads what the solve leaves
    for (const std::string& name : config_.diagnose.stages) {
      for (const Stage& stage : stages) {
        const auto has_elements = [&](TermGroup group) { return system.active(group); };
        if (name != to_string(stage.name)) continue;
        if (!stage.needed.empty() && std::none_of(stage.needed.begin(), stage.needed.end(), has_elements))
          continue;
        const TermSet set = TermSet::all().without(stage.left_out);
        estimate(system.clamped(set), MatrixForm::clamped, stage.name);
        if (config_.diagnose.ends) find_ends(system, set);
        if (stage.name != MatrixStage::full || system.solved_is_clamped()) continue;
        estimate(system.solved(), MatrixForm::solved, stage.name);
      }
    }
  }
  if (artifacts_ && config_.output.matrices) write_matrices(system, step, iteration);
  if (config_.diagnose.pcg) probed_ = probe_.iterations(system.solved());
  spent_s_ += now_s() - start;
}

void ConditionWatch::write_matrices(Diagnosis& system, int step, int iteration) {
  const auto write = [&](const ReducedSystem& matrix, const std::string& form) {
    artifacts_->matrix(stored_system(system, matrix, form, config_, step, iteration, samples_));
  };
  write(system.solved(), std::string(to_string(form_)));
  if (!system.solved_is_exact()) write(system.exact(), "exact");
}

void ConditionWatch::on_iteration(const LinearReport& linear, TraceRow& row) {
  const std::optional<Scaling> scaling = scaling_of(config_.linear_solver);
  if (due_ && config_.diagnose.estimator == Estimator::ritz &&
      scaling) {  // the full matrix scaled by the preconditioner
    samples_.push_back(sample_of(form_, MatrixStage::full, *scaling, Estimator::ritz,
                                 condition_from_ritz(linear.ritz_min, linear.ritz_max)));
  }
  for (const ConditionSample& sample : samples_) step_cond_.add(sample);
  if (probed_.finite()) step_probes_.push_back(probed_.value);
  row.probe_pcg_iterations = probed_;
  row.cond = std::move(samples_);
  samples_.clear();
}

void ConditionWatch::keep(Archive& archive) {
  archive(cond_, spent_s_);
  archive.grown("probes", probes_);
}

void ConditionWatch::end_step() {
  cond_.append(step_cond_);
  probes_.insert(probes_.end(), step_probes_.begin(), step_probes_.end());
  forget_step();
}

void ConditionWatch::forget_step() {
  step_cond_ = {};
  step_probes_.clear();
}

void ConditionWatch::fill(Summary& summary) const {
  summary.cond = cond_.summary();
  summary.probe_pcg = summarize(probes_);
}

}  // namespace bb
