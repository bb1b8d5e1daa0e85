// Launches of the kernels of a policy, from its struct of values.
#pragma once

#include "core/barrier/launches.hpp"
#include "core/contact/executor/row_kappa.hpp"
#include "core/energy/families/limit_kernels.hpp"
#include "core/exec/executor.hpp"

namespace bb {

/// Policy has scaled(), a ScaledPolicy of its Values.
template <class Policy>
PolicyLaunches policy_launches() {
  using P = typename Policy::Values;
  PolicyLaunches out;
  if constexpr (ServesContacts<P>) {
    out.rows = [](exec::Executor& executor, const StiffnessPolicy& policy, const exec::RowKappaInputs& of) {
      executor.each(of.rows.n, exec::RowKappa<P>{of, static_cast<const Policy&>(policy).scaled()});
    };
  }
  if constexpr (ServesLimits<P>) {
    const auto launch = []<int N>(exec::Executor& executor, const StiffnessPolicy& policy,
                                  const ElementKappaInputs<N>& of) {
      executor.each(of.limit.n, ElementKappa<N, P>{of, static_cast<const Policy&>(policy).scaled()});
    };
    out.triangles = launch;
    out.tetrahedra = launch;
  }
  return out;
}

}  // namespace bb
