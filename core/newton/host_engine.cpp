// Steps, energies and motions. The matrix is in host_matrix.cpp.
#include "core/newton/host_engine.hpp"

#include <algorithm>
#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/newton/element_name.hpp"
#include "core/terms/cusps.hpp"
#include "core/terms/known_step.hpp"

namespace bb {

HostEngine::HostEngine(const Scene& scene, Method& method, const Plan& plan,
                       const std::vector<std::uint8_t>& fixed, PhaseClock& clock)
    : IncrementalPotential(clock),
      scene_(scene),
      plan_(plan),
      precision_(method.precision),
      terms_(make_terms(plan, {executor_, scene, method, plan.contacts, fixed})),
      blocks_(std::make_unique<BlockSystem>(scene.n_vertices(), fixed)) {
  set_terms(terms_);
  for (const auto& term : terms_) term->set_matrix(*blocks_, elastic_);
  make_solver();
  set_fixed_families(method);
}

void HostEngine::make_solver() {
  if (plan_.linear_solver.needed) solver_ = make_linear_solver(plan_.linear);
}

// Contact families change every iteration and are numbered separately from those that stay.
void HostEngine::set_fixed_families(const Method& method) {
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

void HostEngine::solver_begins_step() {
  if (solver_) solver_->begin_step();
}

void HostEngine::keep_solver(Archive& archive) {
  archive.section("linear solver");
  blocks_->keep(archive);
  if (solver_) solver_->keep(archive);
}

void HostEngine::drop_caches() {
  make_solver();
  blocks_->set_contacts({});
}

void HostEngine::adopt(const KnownStep& known) {
  for (const auto& term : terms_) term->adopt(known);
}

void HostEngine::adopt(const HostEngine& other) {
  for (std::size_t i = 0; i < slots_.size(); ++i) slots_[i].term->adopt_from(*other.slots_[i].term);
}

double HostEngine::truncate(Column& dx) {
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

bool HostEngine::bounds_each_vertex_of(const Term& term) const {
  return !static_cast<const HostTerm&>(term).vertex_parts().empty();
}

bool HostEngine::is_finite(Column& trial, bool) {
  round_state(precision_, points(trial));
  return points(trial).allFinite();
}

EnergyChange HostEngine::sum_change(const Column& x, const Column& trial) {
  return sums_.change(terms_, x, trial);
}

double HostEngine::sum_energy(TermSet set, const Column&, bool) { return total_energy(terms_, set); }

void HostEngine::report_overload(const Column& x, const Column& g, const Column& dx, StepNumbers& out) {
  Positions own;
  for (const Slot& slot : slots_) {
    own.setZero(3, points(x).cols());
    add_families(slot, own);
    const Positions others = points(g) - own;
    slot.term->report_overload(points(x), others, points(dx), out);
  }
}

Cusps HostEngine::cusps(const Column& x, double) {
  Cusps out;
  for (const auto& term : terms_) term->add_cusps(points(x), out);
  return out;
}

std::string HostEngine::describe_non_finite() { return broken_element_name(scene_, terms_); }

KnownStep HostEngine::known_step() const { return {}; }

}  // namespace bb
