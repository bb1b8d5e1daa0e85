// The regularised Hessian of an iterate: how far it is from the exact one. The regularisation grows while the matrix is not positive
// definite and shrinks again in the iterations that follow.
#pragma once

#include <span>
#include <vector>

#include "core/linear/local_hessians.hpp"
#include "core/terms/host_term.hpp"
#include "core/terms/step_hessian.hpp"

namespace bb {

class HessianRegularisation {
 public:
  /// Of the terms with a choice.
  explicit HessianRegularisation(const std::vector<StepHessian>& choices);

  /// A step begins: exact.
  void reset();
  /// The attempt failed. Requires that it was not the last. residual: largest force on a vertex, N.
  void raise(double residual);
  /// The first attempt of an iterate served.
  void lower(double residual);
  /// No choice leads to another matrix than that of the last attempt: everything is clamped.
  bool last() const;
  /// The Hessian is the exact one.
  bool exact() const;
  /// Every term is clamped at this level, whatever its choice begins with.
  bool all_clamped() const;

  /// The blend factor t: part of the way from the exact matrix to the clamped one, 0 to 1.
  double t() const { return t_; }
  /// progressive: elements are clamped at vertices whose force is at least that, N; infinity: none.
  double threshold() const { return threshold_; }

 private:
  bool has(StepHessian choice) const;

  std::vector<StepHessian> choices_;
  double t_, threshold_;
};

/// The local Hessians of a family at a level; `buffer` is used where no stored column serves.
/// force: [n_vertices] N, read by progressive. Requires family.clamped wherever the level is above exact.
LocalHessians hessian_at(const TermFamily& family, StepHessian choice, const HessianRegularisation& level,
                         std::span<const double> force, std::vector<double>& buffer);
/// Whether hessian_at needs family.clamped.
bool needs_clamped(StepHessian choice, const HessianRegularisation& level);

}  // namespace bb
