#include "core/contact/executor/contact_pattern.hpp"

#include <bit>
#include <stdexcept>

#include "core/contact/executor/slot_kernels.hpp"

namespace bb::exec {
namespace {

int bits_below(Index n) {
  return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(n > 1 ? n - 1 : 1)));
}

}  // namespace

/// Blocks of one chunk.
struct ContactPattern::Piece {
  Buffer<int> column;
  Buffer<std::uint32_t> begin;
};

ContactPattern::ContactPattern(Executor& executor, int n_vertices, Index chunk)
    : executor_(executor),
      n_vertices_(n_vertices),
      chunk_(chunk),
      touched_(executor, "contact counts of vertices"),
      slot_begin_(executor, "rows of vertices, starts", n_vertices + 1),
      row_begin_(executor, "contact matrix rows", n_vertices + 1),
      slot_(executor, "rows of vertices"),
      column_(executor, "contact matrix columns"),
      begin_(executor, "contact matrix contributions, starts"),
      code_(executor, "contact matrix contributions"),
      places_(executor, "pattern"),
      key_(executor, "pattern sort keys"),
      value_(executor, "pattern sort values") {}

Index ContactPattern::slot_begin(int vertex) const {
  if (vertex == 0) return 0;
  if (vertex == n_vertices_) return n_.slots;
  if (!executor_.counts_only()) return slot_begin_.get(vertex);
  const double share = static_cast<double>(vertex) / n_vertices_;
  return static_cast<Index>(share * static_cast<double>(n_.slots));
}

/// The largest last > first for which the vertices [first, last) have at most `most` slots, or first + 1.
int ContactPattern::end_of_chunk(int first, Index most) const {
  const Index level = slot_begin(first) + most;
  if (slot_begin(n_vertices_) <= level) return n_vertices_;
  int low = first + 1, high = n_vertices_;
  while (low < high) {
    const int middle = low + (high - low + 1) / 2;
    if (slot_begin(middle) <= level) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

void ContactPattern::build_slots(const RowStencils& rows) {
  count(rows);
  fill_all_slots(rows.rows);
}

/// How many slots there are, and contributions to blocks.
void ContactPattern::count(const RowStencils& rows) {
  if (rows.rows.n >= Index{1} << 28) {
    throw std::length_error("contact matrix: " + std::to_string(rows.rows.n) + " rows; at most " +
                            std::to_string((1 << 28) - 1));
  }
  n_ = {rows.n_slots, rows.n_contributions};
}

/// Where the slots of each vertex begin, known before there are any.
void ContactPattern::count_slots(const RowView& rows) {
  touched_.resize(n_vertices_);
  touched_.fill_zero();
  executor_.each(rows.n, CountTouched{rows, touched_.data()});
  executor_.each(n_vertices_ + 1, WidenCounts{touched_.data(), slot_begin_.data(), n_vertices_});
  executor_.exclusive_scan(slot_begin_.data(), n_vertices_ + 1);
}

void ContactPattern::fill_all_slots(const RowView& rows) {
  slot_.fit(n_.slots);
  const bool one_chunk = n_.slots <= chunk_;
  if (!one_chunk) count_slots(rows);
  for (int first = 0, last; first < n_vertices_ && n_.slots > 0; first = last) {
    last = one_chunk ? n_vertices_ : end_of_chunk(first, chunk_);
    fill_slots(rows, first, last);
  }
  if (one_chunk) executor_.each(n_vertices_ + 1, SlotStarts{key_.data(), n_.slots, slot_begin_.data()});
}

void ContactPattern::fill_slots(const RowView& rows, int first, int last) {
  const Index begin = slot_begin(first), n = slot_begin(last) - begin;
  if (n == 0) return;
  places_.rank_by(rows.n, CountSlots{rows, first, last});
  key_.fit(n);
  std::uint32_t* const slot = slot_.data() + begin;
  executor_.each(rows.n, FillSlots{rows, first, last, places_.places(), key_.data(), slot});
  executor_.sort(key_.data(), slot, n, bits_below(last - first));
}

void ContactPattern::build(const RowStencils& rows) {
  count(rows);
  const RowView& view = rows.rows;
  fill_all_slots(view);
  code_.fit(n_.contributions);
  column_.resize(0), begin_.fit(1);
  if (slot_.size() == 0) {
    begin_.fill_zero(), row_begin_.fill_zero();
  } else if (end_of_chunk(0, chunk_ / 4) == n_vertices_) {
    const Index n = 2 * n_.contributions - n_.slots;  // of both triangles, less the diagonal's second ones
    fill_blocks(view, {0, n_vertices_, n, 0, 0}, column_, begin_);
  } else {
    build_in_pieces(view);
  }
  if (slot_.size() >= exact_from) key_.free(), value_.free(), places_.free();
}

void ContactPattern::build_in_pieces(const RowView& rows) {
  std::vector<Piece> pieces;
  Index n_before = 0, blocks_before = 0;
  for (int first = 0, last; first < n_vertices_; first = last) {
    last = end_of_chunk(first, chunk_ / 4);
    const Index from = slot_begin(first), n_slots = slot_begin(last) - from;
    places_.rank_by(n_slots, CountBlockPairs{rows, slot_.data() + from});
    const Index n_pairs = executor_.counts_only() ? 4 * n_slots : n_slots > 0 ? places_.sum() : 0;
    pieces.push_back(
        {{executor_, "contact matrix columns"}, {executor_, "contact matrix contributions, starts"}});
    Piece& piece = pieces.back();
    n_before += fill_blocks(rows, {first, last, n_pairs, blocks_before, n_before}, piece.column, piece.begin);
    blocks_before += piece.column.size();
    if (n_slots == 0) pieces.pop_back();  // where its rows begin was all that it had
  }
  join(pieces);
}

/// Blocks of the vertices of a chunk; begin gets one number more. Returns how many contributions they have.
Index ContactPattern::fill_blocks(const RowView& rows, const Chunk& chunk, Buffer<int>& column,
                                  Buffer<std::uint32_t>& begin) {
  const int first = chunk.first, last = chunk.last;
  const Index from = slot_begin(first), n_slots = slot_begin(last) - from, n = chunk.n_pairs;
  const std::uint32_t* const slot = slot_.data() + from;
  places_.rank_by(n_slots, CountBlockPairs{rows, slot});
  key_.fit(n), value_.fit(n);
  const int bits = bits_below(n_vertices_);
  executor_.each(n_slots,
                 FillPairKeys{rows, slot, first, bits, places_.places(), key_.data(), value_.data()});
  executor_.sort(key_.data(), value_.data(), n, bits + bits_below(last - first));

  const PairKeys keys{key_.data(), first, bits};
  places_.rank_by(n, CountBlocks{keys});
  const double share = static_cast<double>(last - first) / n_vertices_;
  Index n_blocks = static_cast<Index>(share * static_cast<double>(expected_.n_blocks(n_vertices_))),
        n_contributions = n * 10 / 16;
  if (!executor_.counts_only()) {
    n_blocks = TwoPlaces::first_of(places_.sum()), n_contributions = TwoPlaces::second_of(places_.sum());
  }
  column.fit(n_blocks), begin.fit(n_blocks + 1);
  executor_.each(n + (last - first) + 1, FillBlocks{keys, value_.data(), n, places_.two_places(), n_blocks,
                                                    chunk.blocks_before, chunk.n_before, column.data(),
                                                    begin.data(), code_.data(), row_begin_.data() + first});
  return n_contributions;
}

void ContactPattern::join(std::vector<Piece>& pieces) {
  Index n = 0;
  for (const Piece& piece : pieces) n += piece.column.size();
  column_.resize(n), begin_.resize(n + 1);
  Index at = 0;
  for (Piece& piece : pieces) {  // the last number of one is the first of the next
    const auto size = static_cast<std::size_t>(piece.column.size());
    executor_.copy(column_.data() + at, piece.column.data(), size * sizeof(int));
    executor_.copy(begin_.data() + at, piece.begin.data(), (size + 1) * sizeof(std::uint32_t));
    executor_.synchronize();
    at += piece.column.size();
    piece.column.free(), piece.begin.free();
  }
}

}  // namespace bb::exec
