// The step bound on an executor: that of StepBoundFinder (core/contact/step_bound.hpp), alpha and the pair that limits
// bit for bit.
#pragma once

#include "core/contact/executor/bound_kernels.hpp"
#include "core/contact/executor/executor_broad_phase.hpp"
#include "core/contact/step_bound.hpp"
#include "core/exec/sums/compaction.hpp"
#include "core/exec/sums/executor_sum.hpp"

namespace bb::exec {

/// How many pairs are looked at before what they found is used for the next ones. They change counters and memory,
/// never alpha or the pair.
struct BoundBatches {
  Index chunk = 1 << 20;  // pairs that are screened at a time
  Index first_asked = 1 << 12,
        most_asked = 1 << 18;  // pairs that are queried at a time, doubling from the first
};

/// Pairs are screened in chunks of their lists: axes and planes prove of most that they come later than the smallest
/// time known. The rest is queried in batches, in the order of what is proven of it. Counters are the same in any order
/// of a launch; they differ from the CPU path's, whose batches are others. Keeps its buffers: 7 B a pair of a
/// chunk, 8 B a pair that has to be queried.
class ExecutorStepBound {
 public:
  using Column = Buffer<double>;

  /// surface must outlive this.
  ExecutorStepBound(Executor& executor, const ExecutorSurface& surface, const StopLevel& level,
                    const BoundBatches& batches = {});

  /// Of all candidates of x0 -> x1 ([3 n_vertices] m). A motion that is not finite: alpha 0, without a pair.
  StepBound find(const ExecutorCandidates& candidates, const PositionsView& x0, const PositionsView& x1) {
    look(candidates, x0, x1);
    return finish();
  }
  /// The same in two calls: what is launched before the second one is read together.
  void look(const ExecutorCandidates& candidates, const PositionsView& x0, const PositionsView& x1);
  StepBound finish();
  /// The same without lists, for when they would need too much memory: pairs are queried where the search of the trees
  /// finds them. source: of a count of the same motion.
  StepBound find_without_list(const CandidateSource& source, const PositionsView& x0,
                              const PositionsView& x1);

 private:
  void start(const PositionsView& x0, const PositionsView& x1);
  void look_at_chunk(Index begin);
  void ask_rest(Index begin);
  template <PairKind K>
  void ask_tree(const PairSearch& search);
  template <int N>
  void ask_all_obstacles();
  template <class Ask>
  void in_batches(Index n, const Ask& ask);
  Index pairs_of_chunk(Index begin) const;
  StepBound result();
  ContactKey key_of(int list, Key pair) const;

  Executor& executor_;
  const ExecutorSurface& surface_;
  const StopLevel level_;
  const BoundBatches batches_;
  BoundQuery query_{};
  ExecutorSums<BoundTotal> total_;
  Reading<Key> largest_;  // complemented bits of the largest coordinate
  Buffer<float> proven_;
  Compaction places_;
  Buffer<Key> asked_;
  CandidateLists lists_{};  // of the last look()
};

}  // namespace bb::exec
