// Set-up, the step and its motions. Matrix and direction are in resident_direction.cpp, what is said of the state in
// resident_report.cpp.
#include "core/resident/system/resident_system.hpp"

#include <algorithm>

#include "core/math/error.hpp"
#include "core/resident/linear/block_jacobi.hpp"
#include "core/resident/linear/schwarz.hpp"
#include "core/resident/system/system_kernels.hpp"

namespace bb::resident {
namespace {

std::vector<StepHessian> choices_of(const Plan& plan, const Method& method) {
  std::vector<StepHessian> out;
  for (std::size_t i = 0; i < plan.terms.size(); ++i) {
    if (!plan.terms[i].needed) continue;
    out.push_back(method.hessian_of(term_entries()[i].name));
  }
  return out;
}

/// Of the resident solver, complete. Errors: ConfigError for another one.
ParameterMap linear_parameters(const Method& method) {
  if (method.linear.name != "pcg_resident") {
    throw ConfigError("/linear_solver/name", method.linear.name,
                      "pcg_resident: the matrix stays where it is assembled");
  }
  const LinearSolverEntry& entry = linear_solvers().require(method.linear.name, "/linear_solver/name");
  return own_parameters(entry.parameters, method.linear.parameters, "/linear_solver");
}

// The clusters of Schwarz are made from the matrix, which an executor that only counts does not have.
std::unique_ptr<ResidentPreconditioner> make_preconditioner(exec::Executor& executor, const Method& method) {
  const ParameterMap parameters = linear_parameters(method);
  if (text(parameters, "resident_preconditioner") == "schwarz" && !executor.counts_only()) {
    return std::make_unique<Schwarz>(executor, integer(parameters, "resident_cluster_vertices"));
  }
  return std::make_unique<BlockJacobi>(executor);
}

std::span<const double> numbers_of(const Positions& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

}  // namespace

ResidentSystem::ResidentSystem(std::unique_ptr<exec::Executor> executor, const Scene& scene, Method& method,
                               const Plan& plan)
    : executor_(std::move(executor)),
      scene_(scene),
      method_(method),
      plan_(plan),
      fixed_(fixed_dofs(scene, plan)),
      n_free_(static_cast<int>(std::count(fixed_.begin(), fixed_.end(), 0))),
      vectors_(*executor_, fixed_, scene.pins),
      elements_(*executor_, scene, method),
      forcing_(linear_parameters(method)),
      max_pcg_iterations_(integer(linear_parameters(method), "max_iterations")),
      level_(choices_of(plan, method)),
      x_(*executor_, "positions"),
      trial_(*executor_, "trial positions"),
      end_(*executor_, "end of the motion"),
      dx_(*executor_, "Newton direction"),
      g_(*executor_, "gradient"),
      x_n_(*executor_, "positions at the start of the step"),
      x_tilde_(*executor_, "predicted positions"),
      b_(*executor_, "right-hand side"),
      step_(*executor_, "solution"),
      work_(*executor_, "work column"),
      escape_(*executor_, "direction of negative curvature"),
      body_size_(*executor_, "sizes of bodies"),
      exact_hessians_(exact_hessians(plan, method)),
      force_(*executor_, "force norms"),
      elastic_value_(*executor_, "elastic matrix of the iterate"),
      product_partial_(*executor_, "partial products", Partition::most_blocks),
      sum_(*executor_),
      row_totals_(*executor_) {
  const Index n = scene.n_vertices();
  for (Column* column : {&x_, &trial_, &end_, &dx_, &g_, &x_n_, &x_tilde_, &b_, &step_, &work_, &escape_})
    column->resize(3 * n);
  body_size_.upload(body_sizes(scene));
  if (plan.term("contact").needed) {
    contact_ = std::make_unique<ResidentContact>(*executor_, scene, method, plan.contacts, vectors_.fixed());
  }
  pcg_ = std::make_unique<ResidentPcg>(*executor_, n, make_preconditioner(*executor_, method));
}

ResidentSystem::~ResidentSystem() = default;

void ResidentSystem::begin_step(const Positions& x_n, const Prediction& prediction, double dt,
                                double load_factor) {
  const ScopedPhase timer(clock(), Phase::prediction);
  x_start_ = x_n;
  x_n_.upload(numbers_of(x_n));
  x_.upload(numbers_of(x_n));
  forget_copies();
  level_.reset();
  served_at_once_ = has_step_elastic_ = false;
  forcing_.begin_step();
  frame_ = {x_n_.data(), x_tilde_.data(), dt, prediction.c, load_factor};
  prediction_ = prediction;
  x_tilde_.upload(numbers_of(prediction.x_tilde));
  elements_.begin_step(frame_);
  if (contact_) contact_->begin_step(x_, dt, prediction.c);
}

void ResidentSystem::count_memory(const ExpectedContacts& expected) {
  if (contact_) contact_->expect(expected);
  begin_step(scene_.x0, {1, scene_.x0}, 1, 1);
  for (int iterate = 0; iterate < 2; ++iterate) {  // the second finds the columns of the first in place
    assemble();
    find_direction();
    check_end();
    prepare_motion(MotionEnd::free, false);
    IterationReport unread;
    bound_motion(unread);
    try_motion(1);
    accept();
  }
  end_step();
}

void ResidentSystem::restart_step(const Prediction& prediction, double dt) {
  const ScopedPhase timer(clock(), Phase::prediction);
  prediction_ = prediction;
  x_tilde_.upload(numbers_of(prediction.x_tilde));
  frame_.dt = dt;
  frame_.c = prediction.c;
  elements_.change_frame(frame_);
  if (contact_) contact_->change_time(dt, prediction.c);
}

void ResidentSystem::end_step() {
  const ScopedPhase timer(clock(), Phase::stiffness);
  if (contact_) contact_->end_step();
}

void ResidentSystem::set_target(const Positions& target) {
  target_ = target;
  vectors_.set_targets(target);
}
bool ResidentSystem::at_target() const { return vectors_.first_short_pin(x_) < 0; }

void ResidentSystem::prepare_motion(MotionEnd end, bool) {
  const ScopedPhase timer(clock(), Phase::broad_phase);
  motion_ = end;
  move(1, end_);
  if (contact_) contact_->prepare(x_, end_);
}

// x + alpha dx; prescribed vertices exactly on target at the end of a motion that leads there.
void ResidentSystem::move(double alpha, Column& to) {
  if (motion_ == MotionEnd::on_target) {
    vectors_.move(x_, dx_, alpha, to);
  } else {
    executor_->each(to.size(), MoveAlong{x_.data(), dx_.data(), alpha, to.data()});
  }
}

double ResidentSystem::bound_motion(IterationReport& report) {
  double smallest = 1;
  holder_.clear();
  if (plan_.term("strain_limit").needed) {
    const ScopedPhase timer(clock(), Phase::strain_bound);
    smallest = report.alpha_strain = elements_.bound(x_.data(), dx_.data(), method_.contact_options.ccd_park);
    if (smallest < 1) holder_ = "the strain limit";
  }
  if (contact_) {
    const ScopedPhase timer(clock(), Phase::step_bound);
    report.bound = contact_->bound(x_, end_);
    report.alpha_ccd = report.bound.alpha;
    if (report.bound.alpha < 1 && report.bound.alpha <= smallest) holder_ = contact_->describe_bound();
    smallest = std::min(smallest, report.bound.alpha);
  }
  return smallest;
}

std::optional<EnergyChange> ResidentSystem::try_motion(double alpha) {
  const ScopedPhase timer(clock(), Phase::line_search);
  move(alpha, trial_);
  if (!contact_ && vectors_.first_not_finite(trial_) >= 0) return std::nullopt;  // else contact looks
  if (!elements_.admits(trial_.data())) return std::nullopt;
  if (contact_) {
    const ScopedPhase rows(clock(), Phase::contact_rows);
    if (!contact_->admits(x_, trial_)) return std::nullopt;
  }
  elements_.evaluate(trial_.data());
  sum_.clear();
  elements_.add_change(x_.data(), trial_.data(), sum_);
  const Compensated fixed = sum_.get();
  EnergyChange out{fixed.value(), fixed.magnitude};
  if (!contact_) return out;
  contact_->evaluate(trial_, kept_elastic());
  // rows come and go: their energies are compared as sums
  const auto before = contact_->energy(x_), after = contact_->trial_energy(trial_);
  const double change = (fixed.sum + (after.sum - before.sum)) + (fixed.carry + (after.carry - before.carry));
  return EnergyChange{change, fixed.magnitude + before.magnitude + after.magnitude};
}

void ResidentSystem::accept() {
  x_.swap(trial_);
  forget_copies();
  elements_.accept();
  if (contact_) contact_->accept();
}

void ResidentSystem::forget_copies() {
  for (HostCopy* each : {&host_x_, &host_before_, &host_g_}) each->valid = false;
}

const Positions& ResidentSystem::copy(const Column& column, HostCopy& to) const {
  if (!to.valid) {
    to.values.resize(3, column.size() / 3);
    column.download({to.values.data(), static_cast<std::size_t>(to.values.size())});
    to.valid = true;
  }
  return to.values;
}

const Positions& ResidentSystem::x() const { return copy(x_, host_x_); }
const Positions& ResidentSystem::x_before() const { return copy(trial_, host_before_); }
const Positions& ResidentSystem::gradient() const { return copy(g_, host_g_); }

}  // namespace bb::resident
