// A stiffness policy on rows in an executor's memory: its kernel, and the columns that it needs.
#pragma once

#include <string>

#include "core/contact/executor/row_kappa.hpp"
#include "core/contact/stiffness_update.hpp"

namespace bb::exec {

/// The columns that rows need for a policy.
inline KappaColumns columns_of(const StiffnessPolicy& policy) {
  if (policy.uniform()) return KappaColumns::uniform;
  if (policy.has_potential()) return KappaColumns::potential;
  return policy.refresh() == Refresh::per_iteration ? KappaColumns::compared : KappaColumns::kept;
}

/// Errors: ConfigError at `where` for a policy that has no kernel: one of a plugin.
void require_kernel(const StiffnessPolicy& policy, const std::string& where);

/// A StiffnessUpdate::Compute: kappa of these rows by the policy's kernel. All of it outlives the call that it is handed to.
struct KernelKappa {
  ExecutorRows& rows;
  Executor& executor;
  const StiffnessPolicy& policy;
  const StiffnessTime& time;
  const double* mass;         // [n_vertices] kg
  const MatrixPart& elastic;  // the matrix that the policy reads
  void operator()(std::size_t table, const std::uint8_t* missing, bool at_d_hat) const;
};

}  // namespace bb::exec
