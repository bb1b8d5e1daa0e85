// Which 3x3 blocks of the lower triangle exist: compressed columns of vertex indices. No values here.
#pragma once

#include <span>
#include <vector>

namespace bb {

/// Lower block columns: the rows of column v are row[column_start[v] .. column_start[v + 1]), ascending; the
/// first one is v itself, so block column_start[v] is the diagonal block of vertex v.
struct BlockPattern {
  std::vector<int> column_start;  // [n_vertices + 1]
  std::vector<int> row;           // [n_blocks]

  int n_vertices() const { return static_cast<int>(column_start.size()) - 1; }
  int n_blocks() const { return static_cast<int>(row.size()); }
  /// Index of block (r, c), r >= c, or -1. Cost: one binary search in the column.
  int find(int r, int c) const;
  bool operator==(const BlockPattern&) const = default;
};

/// The diagonal blocks only.
BlockPattern diagonal_pattern(int n_vertices);

/// out = the union of a and of the columns (start [n + 1], row), both ascending within a column.
/// out must be neither input. Cost: O(blocks), no allocation once out is large enough.
void unite(const BlockPattern& a, std::span<const int> start, std::span<const int> row, BlockPattern& out);

}  // namespace bb
