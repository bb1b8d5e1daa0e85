// What the contact term passes to its stiffness policy at its start and between steps
// (docs/theory/barriers.md, Stiffness policies).
#include <algorithm>

#include "core/base/archive/archive.hpp"
#include "core/terms/contact.hpp"

namespace bb {
namespace {

// Local gradients onto the vertices, in the order of the rows.
void scatter(const TermFamily& family, PositionsSpan gradient) {
  const std::span<const int> vertices = family.stencils.vertices;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i] >= 0) gradient.col(vertices[i]) += Vec3d::Map(&family.local.grad[3 * i]);
  }
}

}  // namespace

std::optional<StartSums> ContactTerm::start_sums(const PositionsView& x, const PositionsView& others) {
  std::fill(state_.rows.kappa.begin(), state_.rows.kappa.end(), 1.0);
  std::fill(state_.mollified.kappa.begin(), state_.mollified.kappa.end(), 1.0);
  fill_local(x, Projection::none);
  StartSums sums;
  Positions own = Positions::Zero(3, others.cols());
  for (const TermFamily& family : families_) scatter(family, own);
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    if (fixed_[i]) continue;
    sums.grad_b_dot_grad_e += own.data()[i] * others.data()[i];
    sums.grad_b_sq += own.data()[i] * own.data()[i];
  }
  double mass = 0;
  int count = 0;
  for (const std::vector<int>* vertices : {&state_.rows.vertex, &state_.mollified.free_vertex}) {
    for (const int vertex : *vertices) {
      if (vertex < 0) continue;
      mass += scene_.mass[static_cast<std::size_t>(vertex)];
      ++count;
    }
  }
  sums.mean_contact_mass = mass / count;
  return sums;
}

void ContactTerm::end_step(const PositionsView& x, PhaseClock& clock) {
  if (has_multipliers()) carry_loads(x);
  ContactSteps::end_step(x, clock);
}

// The rows of a state that was reached without energies have none of their shape.
void ContactTerm::carry_loads(const PositionsView& x) {
  fill_shape(state_);
  ContactLoads now;
  bb::add_loads(state_.rows, now);
  bb::add_loads(state_.mollified, x, now);
  carried_.take(now);
}

void ContactTerm::keep(Archive& archive) {
  ContactSteps::keep(archive);
  if (has_multipliers()) carried_.keep(archive);
}

}  // namespace bb
