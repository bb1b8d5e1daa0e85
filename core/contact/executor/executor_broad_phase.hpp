// Broad phase on an executor: the candidate pairs of a motion, those of BroadPhase (core/contact/candidates.hpp).
#pragma once

#include "core/contact/executor/box_tree.hpp"
#include "core/contact/executor/candidate_kernels.hpp"
#include "core/exec/sums/compaction.hpp"
#include "core/model/scene/contact_plan.hpp"

namespace bb::exec {

/// Candidate pairs by kind.
struct CandidateCounts {
  Index point_point = 0, point_edge = 0, point_triangle = 0, edge_edge = 0, obstacle = 0, obstacle_edge = 0,
        obstacle_triangle = 0;
  Index total() const {
    return point_point + point_edge + point_triangle + edge_edge + obstacle + obstacle_edge +
           obstacle_triangle;
  }
  /// Of their lists, with the spare capacity that they are given.
  std::size_t bytes() const { return static_cast<std::size_t>(total() + total() / 4) * sizeof(Key); }
};

class ExecutorBroadPhase {
 public:
  using Column = Buffer<double>;

  /// on_executor: that surface there; must outlive this. surface: read here only. plan: of the same scene.
  ExecutorBroadPhase(Executor& executor, const ExecutorSurface& on_executor, const Surface& surface,
                     const ContactPlan& plan);

  /// Fits the trees to x0 -> x1 ([3 n_vertices] m; the same buffer: a state). Errors: OutOfMemory.
  void fit(const PositionsView& x0, const PositionsView& x1);
  /// Fits, and counts the candidates: how long their lists are is known before they are. What fits into the lists is put
  /// there on the way; before, they get memory for what was counted last, where that takes `most` bytes at most.
  CandidateCounts count(const PositionsView& x0, const PositionsView& x1, ExecutorCandidates& out,
                        std::size_t most = 0);
  /// The candidates of the last count; positions unchanged since. A search of one round is not made again where the lists
  /// was too short for it, one of several is. Errors: OutOfMemory.
  void fill(ExecutorCandidates& out);
  /// Both. The lists are those of BroadPhase::update in double, entry by entry.
  void update(const PositionsView& x0, const PositionsView& x1, ExecutorCandidates& out);
  /// Places of a leaf, 1 to 255, in the stead of places_of_an_item(). Lists do not depend on it.
  void hold(int places) { places_each_ = places; }
  /// Of the last count: how often walks stopped where the places of a leaf were full, and one.
  int rounds() const { return rounds_; }

  /// Of the last fit; for ExecutorStepBound::find_without_list.
  CandidateSource source() const;
  /// Gives the trees back; source() needs another count then.
  void free();
  /// Whether lists get spare capacity to grow; not where they are given back after every motion.
  void keep_room(bool keep) { room_ = keep; }
  /// What an executor that only counts buffers is to take the candidates for.
  void expect(const CandidateCounts& counts) { counts_ = counts; }

 private:
  void find_frame(const PositionsView& x0, const PositionsView& x1);
  template <PairKind K>
  PairSearch search() const;
  Askers askers(const CandidateSource& from, int round) const;
  HeldPairs held();
  Index* totals() { return reinterpret_cast<Index*>(total_.to_write()); }
  bool size_lists(ExecutorCandidates& out, bool next) const;
  void search(ExecutorCandidates& out);
  void look(const CandidateSource& from, const Askers& askers, ExecutorCandidates& out);
  void put(const CandidateSource& from, const Askers& askers, ExecutorCandidates& out);

  Executor& executor_;
  const ExecutorSurface& surface_;
  const ContactPlan plan_;
  Buffer<int> connected_, opposite_;
  Buffer<MotionFrame> frame_;
  BoxTrees trees_;
  ExecutorPrimitives<2> lone_;  // edges without triangles in space
  Buffer<int> edge_of_;         // what they are in the surface
  Compaction places_;           // of the candidates of each item in a round
  Buffer<std::uint32_t> held_;  // HeldPairs
  Buffer<std::uint8_t> n_held_;
  Buffer<std::uint32_t> next_;
  Reading<CandidateCounts> total_;
  Reading<std::uint32_t> unfinished_;
  int places_each_ = 0, rounds_ = 0;
  CandidateCounts counts_;
  bool room_ = true;
  const double *x0_ = nullptr, *x1_ = nullptr;
};

}  // namespace bb::exec
