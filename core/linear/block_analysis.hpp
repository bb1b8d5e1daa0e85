// Ordering and symbolic Cholesky analysis of a matrix whose degrees of freedom come in small blocks: made on the
// graph of the blocks and then expanded, at about a seventh of the time of an analysis of the degrees of freedom.
#pragma once

#include <cholmod.h>

#include <vector>

#include "core/linear/block_system.hpp"

namespace bb {

/// A supernodal symbolic factor, and what a numeric factorisation with it takes.
struct BlockAnalysis {
  cholmod_factor* factor =
      nullptr;        // owned by the caller; null when CHOLMOD failed, and its status reports why
  int orderings = 0;  // that were tried: 1, or 2 where METIS ordered too
  bool nested_dissection = false;  // the ordering is that of METIS
  // Without the zeros of relaxed supernodes. Where vertices differ in size, every block but the diagonal one counts
  // with their mean size.
  double nonzeros = 0, flops = 0;
};

/// Analyses patterns one after the other; keeps its workspace. The result depends on the pattern alone, so that
/// nothing has to be remembered when a run is stopped and goes on.
class BlockAnalyzer {
 public:
  BlockAnalyzer();
  ~BlockAnalyzer();
  BlockAnalyzer(const BlockAnalyzer&) = delete;
  BlockAnalyzer& operator=(const BlockAnalyzer&) = delete;

  /// Orders by approximate minimum degree. Where that leaves so many operations a vertex that a fifth of them
  /// would pay for METIS, METIS orders too, and the ordering with fewer operations is taken.
  /// `owner` allocates the factor. Errors: ConfigError as lower_block_columns; else the status of owner or common().
  BlockAnalysis analyze(const ReducedSystem& system, cholmod_common& owner);
  const cholmod_common& common() const { return common_; }

 private:
  cholmod_factor* best_ordering(BlockAnalysis& out);

  cholmod_common common_{};
  std::vector<int> start_, row_;  // the graph: lower block columns
};

}  // namespace bb
