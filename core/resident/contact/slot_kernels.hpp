// Which rows touch a vertex, and which blocks of the matrix the rows touch: kernels behind contact_pattern.hpp.
#pragma once

#include "core/resident/contact/compaction_kernels.hpp"
#include "core/resident/contact/resident_rows.hpp"
#include "core/resident/contact/stiffness_kernels.hpp"

namespace bb::resident {

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
      if (rows.is_free(r, k)) exec::atomic_add(&touched[rows.vertex[k * rows.n + r]], 1);
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

/// Free points of every row among the vertices [first, last).
struct CountSlots {
  RowView rows;
  int first, last;
  std::uint8_t* count;
  BB_HD void operator()(Index r) const {
    int n = 0;
    for (int k = 0; k < 4; ++k) {
      const int v = rows.vertex[k * rows.n + r];
      n += rows.is_free(r, k) && v >= first && v < last ? 1 : 0;
    }
    count[r] = static_cast<std::uint8_t>(n);
  }
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

/// Pairs of points that the slots make with the free points of their rows.
struct CountBlockPairs {
  RowView rows;
  const std::uint32_t* slot;
  std::uint8_t* count;
  BB_HD void operator()(Index i) const {
    count[i] = static_cast<std::uint8_t>(rows.n_free(slot_row(slot[i])));
  }
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

/// Pairs (a <= b) of free points of a row, counted by the upper blocks.
struct CountUpperPairs {
  RowView rows;
  std::uint8_t* count;
  BB_HD void operator()(Index r) const {
    const int n = rows.n_free(r);
    count[r] = static_cast<std::uint8_t>(n * (n + 1) / 2);
  }
};

/// In sorted keys: where a block begins, and which belong to the upper triangle.
struct MarkBlocks {
  const Key* key;
  int first, bits;
  std::uint8_t *head, *upper;
  BB_HD void operator()(Index i) const {
    head[i] = i == 0 || key[i] != key[i - 1] ? 1 : 0;
    const Key row = (key[i] >> bits) + static_cast<Key>(first), column = key[i] & ((Key{1} << bits) - 1);
    upper[i] = column >= row ? 1 : 0;
  }
};

/// Columns and contributions of the blocks of a chunk, behind those of the chunks before; begin [blocks + 1].
struct FillBlocks {
  const Key* key;
  const std::uint32_t* code;
  Index n;
  int first, bits;
  const std::uint8_t *head, *upper;
  Places blocks, contributions;
  Index n_before;  // contributions of the chunks before
  int* column;
  std::uint32_t* begin;
  std::uint32_t *contribution, *blocks_of_row;
  BB_HD void operator()(Index i) const {
    const Index to = n_before + contributions.of(i);
    if (upper[i] != 0) contribution[to] = code[i];
    if (i == n - 1) begin[blocks.of(i) + head[i]] = static_cast<std::uint32_t>(to + upper[i]);
    if (head[i] == 0) return;
    const Index j = blocks.of(i);
    column[j] = static_cast<int>(key[i] & ((Key{1} << bits) - 1));
    begin[j] = static_cast<std::uint32_t>(to);
    exec::atomic_add(&blocks_of_row[(key[i] >> bits) + static_cast<Key>(first)], 1);
  }
};

}  // namespace bb::resident
