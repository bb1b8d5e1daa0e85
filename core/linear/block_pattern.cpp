// Columns are independent: count, prefix sum, write.
#include "core/linear/block_pattern.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "core/linear/parallel.hpp"
#include "core/math/at.hpp"

namespace bb {
namespace {

/// Rows present in both of two ascending ranges.
int count_common(const int* a, const int* a_end, const int* b, const int* b_end) {
  int n = 0;
  while (a != a_end && b != b_end) {
    n += *a == *b;
    const bool step_a = *a <= *b, step_b = *b <= *a;
    a += step_a;
    b += step_b;
  }
  return n;
}

}  // namespace

int BlockPattern::find(int r, int c) const {
  const auto begin = row.begin() + column_start[at(c)], end = row.begin() + column_start[at(c) + 1];
  const auto it = std::lower_bound(begin, end, r);
  return it != end && *it == r ? static_cast<int>(it - row.begin()) : -1;
}

BlockPattern diagonal_pattern(int n_vertices) {
  BlockPattern pattern;
  pattern.column_start.resize(at(n_vertices) + 1);
  pattern.row.resize(at(n_vertices));
  std::iota(pattern.column_start.begin(), pattern.column_start.end(), 0);
  std::iota(pattern.row.begin(), pattern.row.end(), 0);
  return pattern;
}

void unite(const BlockPattern& a, std::span<const int> start, std::span<const int> row, BlockPattern& out) {
  const int n = a.n_vertices();
  out.column_start.resize(at(n) + 1);
  out.column_start[0] = 0;
  const auto a_begin = [&](int c) { return a.row.data() + a.column_start[at(c)]; };
  const auto b_begin = [&](int c) { return row.data() + start[at(c)]; };
  parallel_items(n, 512, [&](int c) {
    const int total = static_cast<int>((a_begin(c + 1) - a_begin(c)) + (b_begin(c + 1) - b_begin(c)));
    out.column_start[at(c) + 1] =
        total - count_common(a_begin(c), a_begin(c + 1), b_begin(c), b_begin(c + 1));
  });
  for (int c = 0; c < n; ++c) out.column_start[at(c) + 1] += out.column_start[at(c)];
  out.row.resize(at(out.column_start[at(n)]));
  parallel_items(n, 512, [&](int c) {
    std::set_union(a_begin(c), a_begin(c + 1), b_begin(c), b_begin(c + 1),
                   out.row.begin() + out.column_start[at(c)]);
  });
}

}  // namespace bb
