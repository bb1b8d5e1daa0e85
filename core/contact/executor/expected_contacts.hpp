// What an executor that only counts buffers is to take the contacts of a scene for.
#pragma once

#include "core/contact/executor/executor_broad_phase.hpp"

namespace bb::exec {

/// Vertices count as free, and as touched by equally many rows.
struct ExpectedContacts {
  Index rows = 0, mollified = 0;
  CandidateCounts candidates;
  double upper_blocks_a_row = 0.49;  // stored 3x3 blocks on and above the diagonal

  /// Blocks of the contact matrix, both triangles; n_vertices diagonal blocks among them.
  Index n_blocks(Index n_vertices) const {
    const auto upper = static_cast<Index>(upper_blocks_a_row * static_cast<double>(rows));
    return upper > n_vertices ? 2 * upper - n_vertices : upper;
  }
};

}  // namespace bb::exec
