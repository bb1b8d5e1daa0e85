// Set-up, the state and its energies. The matrix and gradient are in newton_assembly.cpp.
#include "core/newton/newton_system.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "core/archive/archive.hpp"
#include "core/math/rounding_room.hpp"

namespace bb {

std::vector<std::uint8_t> fixed_dofs(const Scene& scene, const Plan& plan) {
  std::vector<std::uint8_t> fixed(3 * static_cast<std::size_t>(scene.n_vertices()), 0);
  for (const Pin& pin : scene.pins) {
    for (std::size_t k = 0; k < 3; ++k) fixed[3 * static_cast<std::size_t>(pin.vertex) + k] = 1;
  }
  if (plan.planar_lock.needed) {
    for (std::size_t i = 2; i < fixed.size(); i += 3) fixed[i] = 1;
  }
  return fixed;
}

std::vector<double> body_sizes(const Scene& scene) {
  std::vector<double> out(static_cast<std::size_t>(scene.n_vertices()), 0);
  for (const Body& body : scene.bodies) {
    if (body.n_vertices == 0) continue;
    const auto rest = scene.rest.middleCols(body.first_vertex, body.n_vertices);
    const double side = (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).maxCoeff();
    std::fill_n(out.begin() + body.first_vertex, body.n_vertices, side);
  }
  return out;
}

ExactHessians exact_hessians(const Plan& plan, const Method& method) {
  bool some = false, all = true;
  for (std::size_t i = 0; i < plan.terms.size(); ++i) {
    const TermEntry& entry = term_entries()[i];
    if (!plan.terms[i].needed || entry.convex) continue;
    const bool exact = first_projection(method.hessian_of(entry.name)) == Projection::none;
    some = some || exact;
    all = all && exact && knows_exact_hessian(entry.name, method);
  }
  if (all) return ExactHessians::all;
  return some ? ExactHessians::some : ExactHessians::none;
}

namespace {

std::vector<StepHessian> choices_of(const TermList& terms, const Method& method) {
  std::vector<StepHessian> out;
  for (const auto& term : terms) out.push_back(method.hessian_of(term->name()));
  return out;
}

}  // namespace

NewtonSystem::NewtonSystem(const Scene& scene, Method& method, const Plan& plan)
    : scene_(scene),
      plan_(plan),
      precision_(method.precision),
      fixed_(fixed_dofs(scene, plan_)),
      terms_(make_terms(plan_, {scene, method, plan_.contacts, fixed_})),
      level_(choices_of(terms_, method)),
      exact_hessians_(exact_hessians(plan_, method)),
      body_size_(body_sizes(scene)),
      blocks_(std::make_unique<BlockSystem>(scene.n_vertices(), fixed_)),
      solver_(make_linear_solver(plan_.linear)) {
  set_fixed_families(method);
}

PlanOptions plan_options(const Method& method) {
  PlanOptions options;
  options.linear = method.linear;
  return options;
}

NewtonSystem::NewtonSystem(const Scene& scene, Method& method)
    : NewtonSystem(scene, method, make_plan(scene, method, plan_options(method))) {}

// Families that come and go are numbered apart from those that stay.
void NewtonSystem::set_fixed_families(const Method& method) {
  std::vector<Stencils> families;
  std::size_t n_changing = 0;
  for (const auto& term : terms_) {
    const bool fixed = term->fixed_stencils();
    slots_.push_back(
        {term.get(), fixed ? families.size() : n_changing, method.hessian_of(term->name()), false});
    matrix_order_.push_back(matrix_order_.size());
    if (!fixed) {
      n_changing += term->families().size();
      continue;
    }
    for (const TermFamily& family : term->families()) families.push_back(family.stencils);
  }
  blocks_->set_elements(families);
  std::stable_partition(matrix_order_.begin(), matrix_order_.end(),
                        [this](std::size_t i) { return slots_[i].term->group() == TermGroup::elastic; });
}

void NewtonSystem::begin_step(const Positions& x_n, const Prediction& prediction, double dt,
                              double load_factor) {
  const ScopedPhase timer(clock(), Phase::prediction);
  frame_ = {x_n, prediction.x_tilde, dt, prediction.c, load_factor};
  x_ = x_n;
  level_.reset();
  served_at_once_ = false;
  solver_->begin_step();
  for (const auto& term : terms_) term->begin_step(frame_, clock());
}

void NewtonSystem::restart_step(const Prediction& prediction, double dt) {
  const ScopedPhase timer(clock(), Phase::prediction);
  frame_.x_tilde = prediction.x_tilde;
  frame_.dt = dt;
  frame_.c = prediction.c;
  for (const auto& term : terms_) term->change_frame(frame_);
}

void NewtonSystem::end_step() {
  for (const auto& term : terms_) term->end_step(clock());
}

void NewtonSystem::keep(Archive& archive) {
  for (const auto& term : terms_) {
    archive.section(term->name());
    term->keep(archive);
  }
}

// What is frozen for a step is frozen at its start: that state is assembled first.
void NewtonSystem::adopt(const StepFrame& frame, const Positions& x, const Positions& target,
                         const HessianLevel& level, const KnownStiffness& known) {
  begin_step(frame.x_n, {frame.c, frame.x_tilde}, frame.dt, frame.load_factor);
  for (const auto& term : terms_) term->adopt(known);
  go_to(x, target, level);
}

void NewtonSystem::adopt(const StepFrame& frame, const NewtonSystem& other) {
  begin_step(frame.x_n, {frame.c, frame.x_tilde}, frame.dt, frame.load_factor);
  for (std::size_t i = 0; i < slots_.size(); ++i) slots_[i].term->adopt_from(*other.slots_[i].term);
  go_to(other.x(), other.x(), other.level());
}

void NewtonSystem::go_to(const Positions& x, const Positions& target, const HessianLevel& level) {
  if (x != x_) {
    assemble();
    prepare(x, x - x_);
    if (!try_state(x)) throw std::logic_error("the state of another system is not feasible here");
    accept();
  }
  level_ = level;
  assemble();
  set_target(target);
  set_right_hand_side(target_, dx_);
  nnz_ = static_cast<std::size_t>(solved().lower.nonZeros());
}

void NewtonSystem::drop_caches() {
  solver_ = make_linear_solver(plan_.linear);
  blocks_->set_contacts({});
}

void NewtonSystem::keep_solver(Archive& archive) {
  archive.section("linear solver");
  blocks_->keep(archive);
  solver_->keep(archive);
}

void NewtonSystem::prepare(const Positions& x1, const Positions& dx, bool to_bound) {
  for (const auto& term : terms_) term->prepare({x_, x1, dx, to_bound}, clock());
}

double NewtonSystem::bound(const Positions& x1, const Positions& dx, IterationReport& report) {
  double smallest = 1;
  holder_ = nullptr;
  for (const auto& term : terms_) {
    const double said = term->bound({x_, x1, dx}, report, clock());
    const double alpha = said >= 0 ? said : 0;  // what is no number proves nothing
    if (!(alpha < 1) || alpha > smallest) continue;
    smallest = alpha;
    holder_ = term.get();
  }
  return smallest;
}

std::optional<EnergyChange> NewtonSystem::try_state(const Positions& x) {
  const ScopedPhase timer(clock(), Phase::line_search);
  trial_ = x;
  round_state(precision_, trial_);
  if (!trial_.allFinite()) return std::nullopt;
  for (const auto& term : terms_) {
    if (!term->admits(trial_, clock())) return std::nullopt;
  }
  for (const auto& term : terms_) term->evaluate(trial_, context());
  return sums_.change(terms_, x_, trial_);
}

bool NewtonSystem::at_target() const {
  for (const Pin& pin : scene_.pins) {
    if (x_.col(pin.vertex) != target_.col(pin.vertex)) return false;
  }
  return true;
}

DirectionSize NewtonSystem::direction_size() {
  DirectionSize size;
  for (Eigen::Index i = 0; i < dx_.size(); ++i) {
    if (fixed_[static_cast<std::size_t>(i)]) continue;
    size.slope_J += gradient_.data()[i] * dx_.data()[i];
    const double part = std::abs(dx_.data()[i]);
    size.inf_m = part > size.inf_m || std::isnan(part) ? part : size.inf_m;
    const Eigen::Index v = i / 3;
    const bool rounding = within_coordinate_rounding(
        part, x_.col(v).data(), body_size_[static_cast<std::size_t>(v)], value_epsilon(precision_));
    double& of = rounding ? size.rounding_m : size.beyond_m;
    of = part > of || std::isnan(part) ? part : of;
  }
  size.vertex_m = dx_.size() == 0 ? 0 : dx_.colwise().norm().maxCoeff();
  return size;
}

void NewtonSystem::prepare_motion(MotionEnd end, bool to_bound) {
  end_ = end;
  motion_end_.noalias() = x_ + dx_;
  if (end == MotionEnd::on_target) {
    for (const Pin& pin : scene_.pins) motion_end_.col(pin.vertex) = target_.col(pin.vertex);
  }
  prepare(motion_end_, dx_, to_bound);
}

std::optional<EnergyChange> NewtonSystem::try_motion(double alpha) {
  if (alpha == 1 && end_ == MotionEnd::on_target) return try_state(motion_end_);
  moved_.noalias() = x_ + alpha * dx_;
  return try_state(moved_);
}

void NewtonSystem::accept() {
  x_.swap(trial_);
  for (const auto& term : terms_) term->accept(clock());
}

double NewtonSystem::grad_inf() const {
  double largest = 0;
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    if (!fixed_[i]) largest = std::max(largest, std::abs(gradient_.data()[i]));
  }
  return largest;
}

double NewtonSystem::energy(TermGroup group) const {
  double sum = 0;
  for (const auto& term : terms_) {
    if (term->group() != group) continue;
    for (const TermFamily& family : term->families()) {
      sum += std::accumulate(family.local.energy.begin(), family.local.energy.end(), 0.0);
    }
  }
  return sum;
}

bool NewtonSystem::active(TermGroup group) const {
  return std::any_of(terms_.begin(), terms_.end(),
                     [group](const auto& term) { return term->group() == group && term->size() > 0; });
}

void NewtonSystem::report(IterateNumbers& out) const {
  for (const auto& term : terms_) term->report(x_, out, clock());
}

void NewtonSystem::report_end(StepNumbers& out) const {
  for (const auto& term : terms_) term->report_end(x_, out, clock());
}

void NewtonSystem::report_overload(bool with_direction, StepNumbers& out) {
  if (!with_direction) dx_.setZero(3, x_.cols());
  report_overload(dx_, out);
}

void NewtonSystem::report_overload(const Positions& dx, StepNumbers& out) const {
  Positions own;
  for (const Slot& slot : slots_) {
    own.setZero(3, x_.cols());
    add_families(slot, own);
    slot.term->report_overload(x_, gradient_ - own, dx, out);
  }
}

}  // namespace bb
