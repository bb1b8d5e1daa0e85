// Set-up, the step and its motions, and what is reported of a state. The matrix is in executor_matrix.cpp.
#include "core/newton/executor/executor_engine.hpp"

#include <algorithm>

#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/error.hpp"
#include "core/model/scene/pinned_vertices.hpp"
#include "core/newton/executor/term_list.hpp"
#include "core/newton/newton_system.hpp"
#include "core/terms/known_step.hpp"

namespace bb::exec {
namespace {

/// Of conjugate gradients on an executor, complete. Errors: ConfigError for another one.
ParameterMap linear_parameters(const Method& method) {
  const LinearSolverEntry& entry = linear_solvers().require(method.linear.name, "/linear_solver/name");
  if (entry.matrix != MatrixPlace::executor) {
    throw ConfigError(
        "/linear_solver/name", method.linear.name,
        linear_solver_at(MatrixPlace::executor).name + ": the matrix stays where it is assembled");
  }
  return own_parameters(entry.parameters, method.linear.parameters, "/linear_solver");
}

void require_double(const Method& method) {
  if (method.precision == Precision::full) return;
  throw ConfigError("precision", "of the terms", "double: kernels have no other");
}

}  // namespace

ExecutorEngine::ExecutorEngine(std::unique_ptr<Executor> executor, const Scene& scene, Method& method,
                               const Plan& plan, const std::vector<std::uint8_t>& fixed, PhaseClock& clock)
    : IncrementalPotential(clock),
      executor_(std::move(executor)),
      scene_(scene),
      method_(method),
      plan_(plan),
      vectors_(*executor_, fixed, pinned_vertices(scene)),
      mass_(*executor_, "vertex masses"),
      elements_(*executor_, scene.n_vertices()),
      forcing_(linear_parameters(method)),
      max_pcg_iterations_(integer(linear_parameters(method), "max_iterations")),
      product_partial_(*executor_, "partial products", Partition::most_blocks),
      sum_(*executor_),
      energy_(*executor_),
      least_(*executor_) {
  require_double(method);
  mass_.upload(scene.mass);
  terms_ =
      make_terms_on_executor(plan, {*executor_, scene, method, plan.contacts, vectors_, mass_, elements_});
  set_terms(terms_);
  elements_.finish();
  pcg_ = std::make_unique<ExecutorPcg>(*executor_, scene.n_vertices(),
                                       make_preconditioner(*executor_, linear_parameters(method)));
}

ExecutorEngine::~ExecutorEngine() { clock().wait_at_ends({}); }

void ExecutorEngine::synchronize_phases() {
  clock().wait_at_ends([this] {
    try {
      executor_->synchronize();
    } catch (const ExecutionError&) {
    }
  });
}

// The clusters of a preconditioner go with the pattern that they were made for.
void ExecutorEngine::drop_caches() {
  for (const auto& term : terms_) term->drop_caches();
  ++pattern_id_;
}

EnergyChange ExecutorEngine::sum_change(const Column& x, const Column& trial) {
  sum_.clear();
  ExecutorChange change(sum_);
  for (const auto& term : terms_) term->add_change(x, trial, change);
  change.launch();
  const Compensated parts = sum_.get();
  RowEnergies rows;
  for (const auto& term : terms_) term->add_rows(rows);
  const Compensated &before = rows.before, &after = rows.after;
  return EnergyChange{(parts.sum + (after.sum - before.sum)) + (parts.carry + (after.carry - before.carry)),
                      parts.magnitude + before.magnitude + after.magnitude};
}

void ExecutorEngine::sum_energies(TermSet set, const Column& x, ExecutorSum& sum) {
  sum.clear();
  ExecutorEnergy energy(sum);
  for (const auto& term : terms_) {
    if (set.has(term->group())) term->add_energy(x, energy);
  }
  energy.launch();
}

double ExecutorEngine::sum_energy(TermSet set, const Column& x, bool announced) {
  if (!announced) sum_energies(set, x, sum_);
  Compensated rows = Compensated::zero();
  const double parts = (announced ? energy_ : sum_).get().value();
  for (const auto& term : terms_) {
    if (set.has(term->group())) rows = rows + term->row_energy();
  }
  return parts + rows.value();
}

std::string ExecutorEngine::describe_non_finite() {
  for (const auto& term : terms_) {
    const Index element = term->first_not_finite(least_);
    if (element >= 0) return "element " + std::to_string(element) + " of term " + std::string(term->name());
  }
  return {};
}

KnownStep ExecutorEngine::known_step() const {
  KnownStep out;
  for (const auto& term : terms_) term->add_known(out);
  return out;
}

void ExecutorEngine::expect(const ExpectedContacts& expected) {
  for (const auto& term : terms_) term->expect(expected);
}

void ExecutorEngine::set_frugal_from(Index rows) {
  for (const auto& term : terms_) term->set_frugal_from(rows);
}

void ExecutorEngine::set_list_budget(std::size_t bytes) {
  for (const auto& term : terms_) term->set_list_budget(bytes);
}

// No kernel looks for what next to no step has: the elements of the host do, at the positions of the end of a step.
Cusps ExecutorEngine::cusps(const Column& x, double t_end) {
  if (executor_->counts_only()) return {};
  if (!cusps_) cusps_ = std::make_unique<CuspSearch>(scene_, method_.precision);
  Positions at(3, x.size() / 3);
  x.download({at.data(), static_cast<std::size_t>(at.size())});
  return cusps_->find(at, t_end);
}

void count_memory(NewtonSystem& system, ExecutorEngine& potential, const Scene& scene,
                  const ExpectedContacts& expected) {
  potential.expect(expected);
  system.begin_step(scene.x0, {1, scene.x0}, 1, 1);
  for (int iterate = 0; iterate < 2; ++iterate) {  // the second finds the columns of the first in place
    system.assemble();
    system.find_direction();
    system.check_end();
    system.prepare_motion(MotionEnd::free, false);
    IterationReport unread;
    system.bound_motion(unread);
    system.try_motion(1);
    system.accept();
  }
  system.end_step();
}

}  // namespace bb::exec
