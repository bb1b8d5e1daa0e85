// Numbers of the mollified rows, which are few: a column of them beside the list of their rows.
#pragma once

#include "core/linear/executor/find_block.hpp"

namespace bb::exec {

/// Numbers of mollified rows by row.
struct MollifiedColumn {
  const std::uint32_t* list;  // ascending rows
  Index n;
  const double* number;  // [12][n]
  BB_HD Index of(Index row) const {
    return first_not_below(list, Index{0}, n, static_cast<std::uint32_t>(row));
  }
};

}  // namespace bb::exec
