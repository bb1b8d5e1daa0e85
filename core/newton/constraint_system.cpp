#include "core/newton/constraint_system.hpp"

#include "core/math/error.hpp"
#include "core/newton/host_engine.hpp"
#include "core/newton/newton_state.hpp"
#include "core/terms/contact.hpp"
#include "core/terms/linear_contact.hpp"

namespace bb {
namespace {

bool is_vertex_load(const HostTerm& term) { return term.group() == TermGroup::load && term.on_vertices(); }

}  // namespace

void ConstraintSystem::require_constraints() const {
  for (const auto& term : potential_.terms_) {
    if (is_vertex_load(*term) || term->offers_constraints()) continue;
    throw ConfigError("/step_solver/name",
                      method_.step_solver.name + " with the term " + std::string(term->name()),
                      "a scene without it, since it offers no constraints, or another step solver");
  }
  const bool contact = state_.plan.term("contact").needed;
  if (contact && (method_.stiffness->needs_hessian() || method_.stiffness->needs_globals())) {
    throw ConfigError("/formulation/stiffness_policy/name",
                      "one that reads matrix or gradient with the step solver " + method_.step_solver.name,
                      "fixed");
  }
}

// Energies of loads are quadratic, with a diagonal Hessian: one Newton step from any state ends in their minimum.
ConstraintSystem::FreeMotion ConstraintSystem::free_motion(const Positions& given) {
  const PositionsView from = state_.x_tilde;
  Positions force = Positions::Zero(3, from.cols()), stiffness = force;
  for (const auto& term : potential_.terms_) {
    if (!is_vertex_load(*term)) continue;
    term->linearise(from, potential_.context(force));
    for (const TermFamily& family : term->families()) {
      for (std::size_t e = 0; e < family.stencils.size(); ++e) {
        const int v = family.stencils.vertices[e];
        force.col(v) -= Vec3d::Map(&family.local.grad[3 * e]);
        if (family.local.hess.empty()) continue;
        for (std::size_t k = 0; k < 3; ++k)
          stiffness(static_cast<Eigen::Index>(k), v) += family.local.hess[9 * e + 4 * k];
      }
    }
  }
  FreeMotion out{given, Positions::Zero(3, from.cols())};
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    if (state_.fixed[static_cast<std::size_t>(i)] != 0) continue;
    if (!(stiffness.data()[i] > 0)) {
      throw ConfigError("/step_solver", "constraints where a vertex has no inertia",
                        "an integrator with inertia, and vertices with mass");
    }
    out.inverse.data()[i] = 1 / stiffness.data()[i];
    out.x.data()[i] = from.data()[i] + force.data()[i] / stiffness.data()[i];
  }
  return out;
}

const std::vector<const ConstraintBatch*>& ConstraintSystem::find(const Positions& x,
                                                                  Inequalities inequalities) {
  found_.clear();
  const ConstraintRequest request{x, inequalities, potential_.clock()};
  for (const auto& term : potential_.terms_) term->add_constraints(request, found_);
  return found_;
}

ContactTerm* ConstraintSystem::contact() { return potential_.terms_.find<ContactTerm>(); }
LinearContact* ConstraintSystem::linear_contact() { return potential_.terms_.find<LinearContact>(); }

double ConstraintSystem::stiffest() const {
  potential_.sum_clamped(TermSet::all().without(TermGroup::contact));
  return potential_.blocks_->reduce(potential_.blocks_->values()).lower.diagonal().maxCoeff();
}

}  // namespace bb
