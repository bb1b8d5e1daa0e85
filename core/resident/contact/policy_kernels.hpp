// A stiffness policy on rows in an executor's memory: its kernel, and the columns that it needs.
#pragma once

#include <string>

#include "core/contact/stiffness_update.hpp"
#include "core/resident/contact/row_kappa.hpp"

namespace bb::resident {

/// The columns that rows need for a policy.
inline KappaColumns columns_of(const StiffnessPolicy& policy) {
  if (policy.uniform()) return KappaColumns::uniform;
  if (policy.has_potential()) return KappaColumns::potential;
  return policy.refresh() == Refresh::per_iteration ? KappaColumns::compared : KappaColumns::kept;
}

/// Errors: ConfigError at `where` for a policy that has no kernel: one of a plugin.
void require_kernel(const StiffnessPolicy& policy, const std::string& where);

/// What computes kappa of these rows in a StiffnessUpdate, by the policy's kernel. mass: [n_vertices] kg. elastic: the matrix that the
/// policy reads. All of it outlives the call that it is handed to.
StiffnessUpdate::Compute kappa_of(ResidentRows& rows, exec::Executor& executor, const StiffnessPolicy& policy,
                                  const StiffnessTime& time, const double* mass, const MatrixPart& elastic);

}  // namespace bb::resident
