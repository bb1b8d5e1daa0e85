// The step as solvers of constraints see it: where inertia and loads alone lead, and the constraints that all other
// terms offer. On the host.
#pragma once

#include <vector>

#include "core/energy/constraint_batch.hpp"
#include "core/terms/host_term.hpp"

namespace bb {

class ContactTerm;
class HostEngine;
class LinearContact;
struct Method;
struct NewtonState;

class ConstraintSystem {
 public:
  /// All must outlive it.
  ConstraintSystem(HostEngine& potential, const NewtonState& state, const Method& method)
      : potential_(potential), state_(state), method_(method) {}

  /// Errors: ConfigError for a term that neither is a load of vertices nor offers constraints, for a stiffness policy that
  /// reads what only a matrix or a barrier's gradient has.
  void require_constraints() const;

  /// What inertia and loads would do alone in the step that has begun.
  struct FreeMotion {
    Positions x;        // [3 x n] m, the minimum of their energy; `given` at fixed degrees of freedom
    Positions inverse;  // [3 x n] m/N, c h^2/m of a vertex; 0 at fixed degrees of freedom
  };
  /// given: [3 x n] m, read at fixed degrees of freedom.
  FreeMotion free_motion(const Positions& given);
  /// All constraints at x [3 x n] m in the order of the terms, always as many batches; those that come and go are found anew.
  /// They are valid until the next call.
  const std::vector<const ConstraintBatch*>& find(const Positions& x, Inequalities inequalities);

  /// The contact term whose multipliers a step solver updates, with a barrier and without; null where nothing can touch.
  ContactTerm* contact();
  LinearContact* linear_contact();
  /// Largest diagonal entry of the matrix of an assembled iterate without contact, N/m. Cost: an assembly.
  double stiffest() const;

 private:
  HostEngine& potential_;
  const NewtonState& state_;
  const Method& method_;
  std::vector<const ConstraintBatch*> found_;
};

}  // namespace bb
