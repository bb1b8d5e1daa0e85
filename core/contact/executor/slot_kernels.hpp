// Which rows touch a vertex, and which blocks of the matrix the rows touch: kernels behind contact_pattern.hpp.
#pragma once

#include "core/contact/executor/executor_rows.hpp"
#include "core/exec/sums/compaction_kernels.hpp"
#include "core/exec/sums/search.hpp"

namespace bb::exec {

/// Vertex k of a row, as one number: 4 row + k.
BB_HD inline Index slot_row(std::uint32_t slot) { return slot >> 2; }
BB_HD inline int slot_point(std::uint32_t slot) { return static_cast<int>(slot & 3); }

/// Points (a, b) of a row, as one number: 16 row + 4 a + b.
BB_HD inline Index pair_row_of(std::uint32_t code) { return code >> 4; }
BB_HD inline int pair_a(std::uint32_t code) { return static_cast<int>(code >> 2 & 3); }
BB_HD inline int pair_b(std::uint32_t code) { return static_cast<int>(code & 3); }

/// touched[v]: free points of rows that are vertex v.
struct CountTouched {
  RowView rows;
  std::uint32_t* touched;
  BB_HD void operator()(Index r) const {
    for (int k = 0; k < 4; ++k) {
      if (rows.is_free(r, k)) atomic_add(&touched[rows.vertex[k * rows.n + r]], 1);
    }
  }
};

/// to[i] = from[i] for i < n, 0 at n: what a scan turns into starts.
struct WidenCounts {
  const std::uint32_t* from;
  Index* to;
  Index n;
  BB_HD void operator()(Index i) const { to[i] = i < n ? static_cast<Index>(from[i]) : 0; }
};

/// Counts of RankItems: free points of every row among the vertices [first, last).
struct CountSlots {
  static constexpr bool two = false;
  RowView rows;
  int first, last;
  BB_HD int operator()(Index r) const {
    int n = 0;
    for (int k = 0; k < 4; ++k) {
      const int v = rows.vertex[k * rows.n + r];
      n += rows.is_free(r, k) && v >= first && v < last ? 1 : 0;
    }
    return n;
  }
};

/// begin[v]: the first of n sorted keys that is not below v; behind the last vertex n.
struct SlotStarts {
  const Key* key;
  Index n;
  Index* begin;
  BB_HD void operator()(Index v) const { begin[v] = first_not_below(key, Index{0}, n, static_cast<Key>(v)); }
};

struct FillSlots {
  RowView rows;
  int first, last;
  Places places;
  Key* vertex;
  std::uint32_t* slot;
  BB_HD void operator()(Index r) const {
    Index at = places.of(r);
    for (int k = 0; k < 4; ++k) {
      const int v = rows.vertex[k * rows.n + r];
      if (!rows.is_free(r, k) || v < first || v >= last) continue;
      vertex[at] = static_cast<Key>(v - first);
      slot[at] = static_cast<std::uint32_t>(4 * r + k);
      ++at;
    }
  }
};

/// Counts of RankItems: pairs of points that the slots make with the free points of their rows.
struct CountBlockPairs {
  static constexpr bool two = false;
  RowView rows;
  const std::uint32_t* slot;
  BB_HD int operator()(Index i) const { return rows.n_free(slot_row(slot[i])); }
};

struct FillPairKeys {
  RowView rows;
  const std::uint32_t* slot;
  int first, bits;  // key: row - first in the bits above `bits`, then the column
  Places places;
  Key* key;
  std::uint32_t* code;
  BB_HD void operator()(Index i) const {
    const Index r = slot_row(slot[i]);
    const int a = slot_point(slot[i]);
    const Key row = static_cast<Key>(rows.vertex[a * rows.n + r] - first) << bits;
    Index at = places.of(i);
    for (int b = 0; b < 4; ++b) {
      if (!rows.is_free(r, b)) continue;
      key[at] = row | static_cast<Key>(rows.vertex[b * rows.n + r]);
      code[at] = static_cast<std::uint32_t>(16 * r + 4 * a + b);
      ++at;
    }
  }
};

/// In sorted keys of pairs: where a block begins, and which belong to the upper triangle.
struct PairKeys {
  const Key* key;
  int first, bits;  // as in FillPairKeys
  BB_HD bool begins_block(Index i) const { return i == 0 || key[i] != key[i - 1]; }
  BB_HD int row(Index i) const { return static_cast<int>(key[i] >> bits) + first; }
  BB_HD int column(Index i) const { return static_cast<int>(key[i] & ((Key{1} << bits) - 1)); }
  BB_HD bool upper(Index i) const { return column(i) >= row(i); }
};

/// Counts of RankItems: blocks that begin, and contributions to upper ones.
struct CountBlocks {
  static constexpr bool two = true;
  PairKeys keys;
  BB_HD int operator()(Index i) const {
    return (keys.begins_block(i) ? 1 : 0) + (keys.upper(i) ? 1 << 16 : 0);
  }
};

/// Columns and contributions of the blocks of a chunk of vertices, behind those of the chunks before; begin [blocks + 1].
/// The items behind the n pairs are the vertices of the chunk: row_begin, that of the next one included.
struct FillBlocks {
  PairKeys keys;
  const std::uint32_t* code;
  Index n;
  TwoPlaces places;
  Index n_blocks;                 // of the chunk
  Index blocks_before, n_before;  // blocks and contributions of the chunks before
  int* column;
  std::uint32_t *begin, *contribution;
  Index* row_begin;  // from the first vertex of the chunk on
  BB_HD void operator()(Index i) const {
    if (i >= n) return start_row(i - n);
    const Index to = n_before + places.second(i), j = places.first(i);
    const bool head = keys.begins_block(i), upper = keys.upper(i);
    if (upper) contribution[to] = code[i];
    if (i == n - 1) begin[j + (head ? 1 : 0)] = static_cast<std::uint32_t>(to + (upper ? 1 : 0));
    if (!head) return;
    column[j] = keys.column(i);
    begin[j] = static_cast<std::uint32_t>(to);
  }

 private:
  BB_HD void start_row(Index v) const {
    const Index at = first_not_below(keys.key, Index{0}, n, static_cast<Key>(v) << keys.bits);
    row_begin[v] = blocks_before + (at < n ? places.first(at) : n_blocks);
  }
};

}  // namespace bb::exec
