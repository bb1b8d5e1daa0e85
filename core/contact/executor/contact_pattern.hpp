// Where contact rows go: the rows of every vertex, the blocks of the matrix, and what adds up to each of them.
#pragma once

#include "core/contact/executor/executor_rows.hpp"
#include "core/contact/executor/expected_contacts.hpp"
#include "core/contact/executor/pattern_view.hpp"
#include "core/exec/sums/compaction.hpp"

namespace bb::exec {

/// Of a view vertices are read, and which of them are free; how many free points, and pairs a <= b of them in one row, all rows
/// have together.
struct RowStencils {
  RowView rows;
  Index n_slots, n_contributions;
};

/// Rebuilt when the stencils of the rows change. Sorted in chunks of vertices, so that scratch memory is 24 B times the
/// contributions of a chunk, and 3 B a row; results do not depend on the chunks.
class ContactPattern {
 public:
  /// chunk: pairs of points that are sorted at a time; a vertex with more is a chunk of its own.
  ContactPattern(Executor& executor, int n_vertices, Index chunk = Index{1} << 28);

  /// The slots alone: all that gradients need. Errors: std::length_error for 2^28 rows or more; OutOfMemory.
  void build_slots(ExecutorRows& rows) { build_slots(stencils_of(rows)); }
  void build_slots(const RowStencils& rows);
  /// Slots and blocks. Errors: as above.
  void build(ExecutorRows& rows) { build(stencils_of(rows)); }
  void build(const RowStencils& rows);

  /// What an executor that only counts buffers is to take the rows for.
  void expect(const ExpectedContacts& expected) { expected_ = expected; }

  int n_vertices() const { return n_vertices_; }
  Index n_blocks() const { return column_.size(); }
  VertexSlots slots() const { return {slot_begin_.data(), slot_.data()}; }
  BlockSources blocks() const { return {row_begin_.data(), column_.data(), begin_.data(), code_.data()}; }

 private:
  /// Slots that scratch memory is given back from, 16 million.
  static constexpr Index exact_from = Index{1} << 24;
  struct Piece;
  struct Numbers {
    Index slots, contributions;
  };
  /// The vertices [first, last): pairs of points, blocks and contributions of those before.
  struct Chunk {
    int first, last;
    Index n_pairs, blocks_before, n_before;
  };
  /// The first slot of a vertex, read.
  Index slot_begin(int vertex) const;
  int end_of_chunk(int first, Index most) const;
  static RowStencils stencils_of(ExecutorRows& rows) {
    return {rows.view(), rows.n_slots, rows.n_contributions};
  }
  void count(const RowStencils& rows);
  void count_slots(const RowView& rows);
  void fill_all_slots(const RowView& rows);
  void fill_slots(const RowView& rows, int first, int last);
  void build_in_pieces(const RowView& rows);
  Index fill_blocks(const RowView& rows, const Chunk& chunk, Buffer<int>& column,
                    Buffer<std::uint32_t>& begin);
  void join(std::vector<Piece>& pieces);

  Executor& executor_;
  int n_vertices_;
  Index chunk_;
  ExpectedContacts expected_;
  Buffer<std::uint32_t> touched_;  // [n_vertices] counts
  Buffer<Index> slot_begin_, row_begin_;
  Buffer<std::uint32_t> slot_;
  Buffer<int> column_;
  Buffer<std::uint32_t> begin_;
  Buffer<std::uint32_t> code_;
  Numbers n_{0, 0};  // of all rows
  Compaction places_;
  Buffer<Key> key_;
  Buffer<std::uint32_t> value_;
};

}  // namespace bb::exec
