// How an executor runs a shape or a policy that the program was built with: launches of the kernels that are made of its struct.
// Whoever has the struct fills them in (barriers/), so that what launches names no shape and no policy. Null where there is no
// such kernel.
#pragma once

#include "core/barrier/shape.hpp"
#include "core/barrier/stiffness_policy.hpp"

namespace bb {

namespace exec {
class Executor;
}
namespace exec {
struct RowView;
struct RowKappaInputs;
}  // namespace exec
struct MeasureAt;
template <int N>
struct LimitColumns;
template <int N>
struct ElementKappaInputs;

/// Of a shape, on the barrier of limited elements with N singular values.
template <int N>
struct LimitLaunches {
  /// Barrier terms at the measured pseudo-gaps. parts: [n] J where kappa has a potential, else null.
  void (*terms)(exec::Executor&, const LimitColumns<N>&, const BarrierFunction&, const KappaParts* parts);
  /// Pseudo-gaps, barrier terms and energies of a state whose kappa is known.
  void (*measure)(exec::Executor&, const LimitColumns<N>&, const BarrierFunction&, const KappaParts* parts,
                  const MeasureAt&);
};

struct ShapeLaunches {
  /// Energy, force and stiffness of contact rows whose kappa is a number.
  void (*rows)(exec::Executor&, const exec::RowView&, Argument) = nullptr;
  /// The same where kappa depends on the gap; null without a potential.
  void (*folded_rows)(exec::Executor&, const exec::RowView&) = nullptr;
  LimitLaunches<2> planar_triangles = {}, triangles = {};  // of a strain limit in the x-y plane and in space
  LimitLaunches<3> tetrahedra = {};
};

/// What a refusal allows where a policy has no launches.
inline constexpr const char* host_policy_words =
    "a policy with a device form; this one runs with device cpu only";

struct PolicyLaunches {
  /// kappa of contact rows; null where the policy does not compute it row by row.
  void (*rows)(exec::Executor&, const StiffnessPolicy&, const exec::RowKappaInputs&) = nullptr;
  /// kappa of limited triangles and tetrahedra; null where the policy serves no strain limit.
  void (*triangles)(exec::Executor&, const StiffnessPolicy&, const ElementKappaInputs<2>&) = nullptr;
  void (*tetrahedra)(exec::Executor&, const StiffnessPolicy&, const ElementKappaInputs<3>&) = nullptr;
};

}  // namespace bb
