// Narrow phase on an executor: candidate pairs to contact rows.
#pragma once

#include "core/contact/executor/executor_rows.hpp"
#include "core/contact/executor/executor_surface.hpp"
#include "core/contact/executor/expected_contacts.hpp"
#include "core/contact/executor/row_kernels.hpp"
#include "core/exec/sums/compaction.hpp"

namespace bb::exec {

/// Keeps its buffers: 3 B a candidate.
class RowFinder {
 public:
  /// surface must outlive the finder. mollifier: whether edge-edge rows close to parallel are mollified.
  RowFinder(Executor& executor, const ExecutorSurface& surface, bool mollifier);

  /// One row a candidate pair with d < d_hat at x [3n] m, sorted by PairId; kappa and the barrier are not set,
  /// kappa_before is 0. Sets min_gap: the smallest gap, infinity without rows; x that is not finite: no rows and
  /// -infinity. Errors: OutOfMemory.
  void find(const PositionsView& x, const ExecutorCandidates& candidates, ExecutorRows& rows) {
    look(x, candidates);
    finish(rows);
  }
  /// The same in two calls: what is launched before the second one is read together. x and the candidates stay until then.
  void look(const PositionsView& x, const ExecutorCandidates& candidates);
  void finish(ExecutorRows& rows);
  /// Gives back what it keeps between two calls.
  void free() { places_.free(); }
  /// What an executor that only counts buffers is to take the rows for.
  void expect(const ExpectedContacts& expected) { expected_ = expected; }

  /// Looks whether two tables have the same stencils and free vertices, so that one pattern serves both; same() says it.
  void compare(ExecutorRows& a, ExecutorRows& b);
  bool same() const { return comparable_ && differs_.get() == 0; }

 private:
  Executor& executor_;
  const ExecutorSurface& surface_;
  bool mollifier_;
  ExpectedContacts expected_;
  Compaction places_;
  Reading<RowNumbers> numbers_;
  Reading<std::uint32_t> differs_;
  bool comparable_ = false;
  NarrowPhase phase_{};  // of the last look()
  CandidateLists lists_{};
};

}  // namespace bb::exec
