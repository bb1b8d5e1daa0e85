// kappa of contact rows from iterate to iterate, by their pairs: when it is computed anew, kept, or given to a pair that appears in a
// line search (docs/theory/barriers.md, Stiffness policies). It knows no policy by name, runs on any executor, and stands once.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/contact/stiffness_kernels.hpp"
#include "core/exec/sums/compaction.hpp"

namespace bb {

/// The stiffness of some pairs, ascending by pair.
struct KnownStiffness {
  std::vector<PairId> pair;
  std::vector<KappaParts> parts;
};

/// A pair keeps its kappa when its closest points cross to a neighbouring feature, and an edge-edge pair when it becomes mollified
/// and back, so B does not jump. Rows are one table or two, of which no pair is in both. Results do not depend on the executor, its
/// threads or its order.
class StiffnessUpdate {
 public:
  using Tables = std::span<const StiffnessRows>;
  /// Gives rows of table `of` the parts that the policy has for them: those that are marked, or all where missing is null; at their
  /// gap, or at d_hat. missing: [n], in the executor's memory.
  using Compute = std::function<void(std::size_t of, const std::uint8_t* missing, bool at_d_hat)>;

  /// Both outlive it.
  StiffnessUpdate(exec::Executor& executor, const StiffnessPolicy& policy);

  /// Forgets the kappa and the matrix of the step before.
  void begin_step() {
    n_known_ = 0;
    has_matrix_ = rows_have_kappa_ = false;
  }
  /// Whether the elastic matrix of this iterate is what the policy reads from now on, and has to be kept: a policy with a potential
  /// reads that of the step's first one all through the step.
  bool takes_matrix();

  /// kappa of the rows of an iterate: a policy that is refreshed in every iteration computes every row anew, one that is refreshed
  /// once a step those alone that had none. One that is uniform has nothing to do here: its kappa is StiffnessPolicy::state().kappa.
  void refresh(Tables rows, const Compute& compute);
  /// The largest relative_change of a row's kappa in the last refresh(), since its iterate was accepted; 0 where there is
  /// one kappa, or kappa is kept for the step. Waits.
  double change() const;
  /// kappa of the rows of a trial: known pairs keep theirs, new ones get the policy's value at d = d_hat, so that it does not depend
  /// on the trial. iterate: rows of the last refresh, or those accepted since; rows of the step's start that no refresh has
  /// seen have no kappa yet. What is known of a trial stays in its own rows; only
  /// of a policy with a potential a new pair is known from then on, whether the trial is accepted or not: its weights belong
  /// to the state where it was first met, and E has to be one function of x for the rest of the step.
  void freeze(Tables trial, Tables iterate, const Compute& compute);
  /// The pairs of an accepted trial keep their kappa for the rest of the step.
  void keep(Tables rows);

  /// The pairs whose kappa is frozen for the step, copied to the host.
  KnownStiffness known() const;
  /// What another one knows, in the place of what this one knew.
  void adopt(const KnownStiffness& known);

 private:
  struct KnownColumns {
    explicit KnownColumns(exec::Executor& executor)
        : pair(executor, "known pairs"),
          fixed(executor, "known kappa"),
          per_gap(executor, "known kappa per gap") {}
    exec::Buffer<PairId> pair;
    exec::Buffer<double> fixed, per_gap;
  };
  /// One kappa a pair and iterate: the rows of the iterate are the memory.
  bool rows_are_memory() const { return !policy_.frozen_in_step(); }
  KnownPairs memory() const;
  void keep(const StiffnessRows& rows);

  exec::Executor& executor_;
  const StiffnessPolicy& policy_;
  exec::Compaction missing_;
  KnownColumns known_, merged_;  // merged_: memory for what known_ becomes
  Index n_known_ = 0;
  exec::Reading<exec::Key> change_;
  bool compares_ = false;  // change_ is that of the last refresh()
  bool has_matrix_ = false;
  bool rows_have_kappa_ = false;  // of the iterate
};

}  // namespace bb
