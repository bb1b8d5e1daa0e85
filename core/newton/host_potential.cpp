// Steps, energies and motions. The matrix is in host_matrix.cpp.
#include "core/newton/host_potential.hpp"

#include <algorithm>
#include <vector>

#include "core/archive/archive.hpp"
#include "core/newton/element_name.hpp"
#include "core/solvers/linear_solvers.hpp"
#include "core/terms/cusps.hpp"
#include "core/terms/known_step.hpp"

namespace bb {

HostPotential::HostPotential(const Scene& scene, Method& method, const Plan& plan,
                             const std::vector<std::uint8_t>& fixed, PhaseClock& clock)
    : IncrementalPotential(clock),
      scene_(scene),
      plan_(plan),
      precision_(method.precision),
      terms_(make_terms(plan, {executor_, scene, method, plan.contacts, fixed})),
      blocks_(std::make_unique<BlockSystem>(scene.n_vertices(), fixed)) {
  make_solver();
  set_fixed_families(method);
}

void HostPotential::make_solver() {
  if (plan_.linear_solver.needed) solver_ = make_linear_solver(plan_.linear);
}

// Families that come and go are numbered apart from those that stay.
void HostPotential::set_fixed_families(const Method& method) {
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
  if (solver_ && solver_->wants_mesh()) blocks_->set_mesh(scene_.x0);
  std::stable_partition(matrix_order_.begin(), matrix_order_.end(),
                        [this](std::size_t i) { return slots_[i].term->group() == TermGroup::elastic; });
}

void HostPotential::begin_step(const StepColumns& step) {
  frame_ = {points(step.x_n), points(step.x_tilde), step.dt,      step.c,
            step.load_factor, step.t_end,           step.at_start};
  energies_known_ = trial_evaluated_ = false;
  if (solver_) solver_->begin_step();
  for (const auto& term : terms_) term->begin_step(frame_, clock());
}

void HostPotential::change_step(const StepColumns& step) {
  frame_.x_tilde = points(step.x_tilde);
  frame_.dt = step.dt;
  frame_.c = step.c;
  energies_known_ = false;
  frame_.t_end = step.t_end;
  for (const auto& term : terms_) term->change_frame(frame_);
}

// One term at a time: what friction takes from contact, and how often, does not depend on how often contact was renewed.
bool HostPotential::renew_lag(const Column& x) {
  const bool renewed = std::any_of(terms_.begin(), terms_.end(),
                                   [&x](const auto& term) { return term->renew_lag(points(x)); });
  energies_known_ = energies_known_ && !renewed;
  return renewed;
}

void HostPotential::end_step(const Column& x) {
  for (const auto& term : terms_) term->end_step(points(x), clock());
}

void HostPotential::keep(Archive& archive) {
  for (const auto& term : terms_) {
    archive.section(term->name());
    term->keep(archive);
  }
}

void HostPotential::keep_solver(Archive& archive) {
  archive.section("linear solver");
  blocks_->keep(archive);
  if (solver_) solver_->keep(archive);
}

void HostPotential::drop_caches() {
  make_solver();
  blocks_->set_contacts({});
}

void HostPotential::adopt(const KnownStep& known) {
  for (const auto& term : terms_) term->adopt(known);
}

void HostPotential::adopt(const HostPotential& other) {
  for (std::size_t i = 0; i < slots_.size(); ++i) slots_[i].term->adopt_from(*other.slots_[i].term);
}

void HostPotential::prepare(const Column& x0, const Column& x1, const Column& dx, bool to_bound) {
  for (const auto& term : terms_) term->prepare({points(x0), points(x1), points(dx), to_bound}, clock());
}

double HostPotential::bound(const Column& x0, const Column& x1, const Column& dx, IterationReport& report) {
  return smallest_bound({points(x0), points(x1), points(dx)}, report, false);
}

double HostPotential::bound_truncated(const Column& x0, const Column& x1, const Column& dx,
                                      IterationReport& report) {
  return smallest_bound({points(x0), points(x1), points(dx)}, report, true);
}

// truncated: what terms said of each vertex the motion keeps to already.
double HostPotential::smallest_bound(const Motion& motion, IterationReport& report, bool truncated) {
  double smallest = 1;
  holder_ = nullptr;
  for (const auto& term : terms_) {
    if (truncated && !term->vertex_parts().empty()) continue;
    const double said = term->bound(motion, report, clock());
    const double alpha = said >= 0 ? said : 0;  // what is no number proves nothing
    if (!(alpha < 1) || alpha > smallest) continue;
    smallest = alpha;
    holder_ = term.get();
  }
  return smallest;
}

bool HostPotential::bounds_each_vertex() const {
  return std::any_of(terms_.begin(), terms_.end(),
                     [](const auto& term) { return !term->vertex_parts().empty(); });
}

double HostPotential::truncate(Column& dx) {
  std::vector<double> part(static_cast<std::size_t>(dx.size()) / 3, 1);
  for (const auto& term : terms_) {
    const std::span<const double> own = term->vertex_parts();
    for (std::size_t i = 0; i < own.size(); ++i) part[i] = std::min(part[i], own[i]);
  }
  double of_pins = 1;
  for (const Pin& pin : scene_.pins) of_pins = std::min(of_pins, part[static_cast<std::size_t>(pin.vertex)]);
  for (const Pin& pin : scene_.pins) part[static_cast<std::size_t>(pin.vertex)] = of_pins;
  for (std::size_t i = 0; i < part.size(); ++i) points(dx).col(static_cast<int>(i)) *= part[i];
  return of_pins;
}

bool HostPotential::make_room(const Column& x, const Column& dx, double bound, Column& force) {
  force.fill_zero();
  bool held = false;
  for (const auto& term : terms_) {
    held = term->add_detour(points(x), points(dx), bound, points(force)) || held;
  }
  return held;
}

bool HostPotential::admits(const Column&, Column& trial) {
  trial_evaluated_ = false;
  round_state(precision_, points(trial));
  if (!points(trial).allFinite()) return false;
  for (const auto& term : terms_) {
    if (!term->admits(points(trial), clock())) return false;
  }
  for (const auto& term : terms_) term->freeze(*blocks_, elastic_, clock());
  return true;
}

EnergyChange HostPotential::change(const Column& x, const Column& trial) {
  know_energies(x);
  for (const auto& term : terms_) term->evaluate(points(trial));
  trial_evaluated_ = true;
  return sums_.change(terms_, points(x), points(trial));
}

void HostPotential::accept() {
  for (const auto& term : terms_) {
    term->accept(clock());
    if (trial_evaluated_) term->take_energies();
  }
  energies_known_ = trial_evaluated_;
  trial_evaluated_ = false;
}

// A step that compares no energies ends with a state that has none, which the record asks for.
void HostPotential::know_energies(const Column& x) {
  if (energies_known_) return;
  const WholePhase timer(clock(), Phase::output);
  for (const auto& term : terms_) term->evaluate_iterate(points(x));
  energies_known_ = true;
}

double HostPotential::energy(TermSet set, const Column& x) {
  know_energies(x);
  return total_energy(terms_, set);
}

void HostPotential::report(const Column& x, IterateNumbers& out) {
  for (const auto& term : terms_) term->report(points(x), out, clock());
}

void HostPotential::report_end(const Column& x, StepNumbers& out) {
  know_energies(x);
  for (const auto& term : terms_) term->report_end(points(x), out, clock());
}

void HostPotential::report_overload(const Column& x, const Column& g, const Column& dx, StepNumbers& out) {
  Positions own;
  for (const Slot& slot : slots_) {
    own.setZero(3, points(x).cols());
    add_families(slot, own);
    const Positions others = points(g) - own;
    slot.term->report_overload(points(x), others, points(dx), out);
  }
}

Cusps HostPotential::cusps(const Column& x) {
  Cusps out;
  for (const auto& term : terms_) term->add_cusps(points(x), out);
  return out;
}

std::string HostPotential::describe_non_finite() { return broken_element_name(scene_, terms_); }

KnownStep HostPotential::known_step() const { return {}; }

}  // namespace bb
