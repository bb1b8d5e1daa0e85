// Where the blocks of a reduced system begin.
#pragma once

#include <string>
#include <vector>

#include "core/linear/block_system.hpp"

namespace bb {

/// Errors: ConfigError when block_start does not cut 0 .. n into blocks of 1 to 3.
void check_block_starts(const ReducedSystem& system);

/// The blocks that hold an entry, by block columns of ascending block rows: row[start[c] .. start[c + 1]).
/// Errors: ConfigError for an entry above the diagonal and for what check_block_starts refuses.
void lower_block_columns(const ReducedSystem& system, std::vector<int>& start, std::vector<int>& row);

/// "vertex 17", or "block row 17" where the system knows no vertices. dof: a degree of freedom of it.
std::string vertex_text(const ReducedSystem& system, int dof);
/// "the diagonal block of vertex 17 is 0 or singular; ", of a block row where the system knows no vertices.
/// dof: a degree of freedom of it.
std::string bad_diagonal_text(const ReducedSystem& system, int dof);
/// That text of the first degree of freedom whose entry on the diagonal is 0 or missing; empty without one.
std::string zero_diagonal_text(const ReducedSystem& system);

}  // namespace bb
