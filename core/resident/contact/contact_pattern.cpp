#include "core/resident/contact/contact_pattern.hpp"

#include <bit>
#include <stdexcept>

#include "core/resident/contact/slot_kernels.hpp"

namespace bb::resident {
namespace {

int bits_below(Index n) {
  return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(n > 1 ? n - 1 : 1)));
}

}  // namespace

/// Blocks of one chunk.
struct ContactPattern::Piece {
  exec::Buffer<int> column;
  exec::Buffer<std::uint32_t> begin;
  Index n_contributions;
};

ContactPattern::ContactPattern(exec::Executor& executor, int n_vertices, Index chunk)
    : executor_(executor),
      n_vertices_(n_vertices),
      chunk_(chunk),
      touched_(executor, "contact counts of vertices", n_vertices),
      slot_begin_(executor, "rows of vertices, starts", n_vertices + 1),
      row_begin_(executor, "contact matrix rows", n_vertices + 1),
      slot_(executor, "rows of vertices"),
      column_(executor, "contact matrix columns"),
      begin_(executor, "contact matrix contributions, starts"),
      code_(executor, "contact matrix contributions"),
      places_(executor, "pattern"),
      upper_(executor, "pattern upper"),
      key_(executor, "pattern sort keys"),
      value_(executor, "pattern sort values") {}

void ContactPattern::starts(const exec::Buffer<std::uint32_t>& counts, exec::Buffer<Index>& begin) {
  executor_.each(n_vertices_ + 1, WidenCounts{counts.data(), begin.data(), n_vertices_});
  executor_.exclusive_scan(begin.data(), n_vertices_ + 1);
}

Index ContactPattern::slot_begin(int vertex) const {
  if (!executor_.counts_only()) return slot_begin_.get(vertex);
  const double share = static_cast<double>(vertex) / n_vertices_;
  return static_cast<Index>(share * 4 * static_cast<double>(expected_.rows));
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

void ContactPattern::build_slots(ResidentRows& rows) {
  if (rows.size() >= Index{1} << 28) {
    throw std::length_error("contact matrix: " + std::to_string(rows.size()) + " rows; at most " +
                            std::to_string((1 << 28) - 1));
  }
  const RowView view = rows.view();
  touched_.fill_zero();
  executor_.each(view.n, CountTouched{view, touched_.data()});
  starts(touched_, slot_begin_);
  slot_.resize(slot_begin(n_vertices_));
  if (slot_.size() == 0) return;
  for (int first = 0, last; first < n_vertices_; first = last) {
    last = end_of_chunk(first, chunk_);
    fill_slots(view, first, last);
  }
}

void ContactPattern::fill_slots(const RowView& rows, int first, int last) {
  executor_.each(rows.n, CountSlots{rows, first, last, places_.counts(rows.n)});
  const Index n = places_.rank(slot_begin(last) - slot_begin(first));
  if (n == 0) return;
  key_.resize(n);
  std::uint32_t* const slot = slot_.data() + slot_begin(first);
  executor_.each(rows.n, FillSlots{rows, first, last, places_.places(), key_.data(), slot});
  executor_.sort(key_.data(), slot, n, bits_below(last - first));
}

void ContactPattern::build(ResidentRows& rows) {
  build_slots(rows);
  const RowView view = rows.view();
  Index n_contributions = 0;
  if (view.n > 0) {
    executor_.each(view.n, CountUpperPairs{view, places_.counts(view.n)});
    n_contributions = places_.rank(10 * view.n);
  }
  code_.resize(n_contributions);
  touched_.fill_zero();  // blocks of a row from now on
  std::vector<Piece> pieces;
  Index n_before = 0;
  for (int first = 0, last; first < n_vertices_ && slot_.size() > 0; first = last) {
    last = end_of_chunk(first, chunk_ / 4);
    pieces.push_back(fill_blocks(view, first, last, n_before));
    n_before += pieces.back().n_contributions;
  }
  key_.free();
  value_.free();
  places_.free();
  upper_.free();
  starts(touched_, row_begin_);
  join(pieces, n_contributions);
}

ContactPattern::Piece ContactPattern::fill_blocks(const RowView& rows, int first, int last, Index n_before) {
  Piece piece{{executor_, "contact matrix columns"}, {executor_, "contact matrix contributions, starts"}, 0};
  const Index from = slot_begin(first), n_slots = slot_begin(last) - from;
  if (n_slots == 0) return piece;
  const std::uint32_t* const slot = slot_.data() + from;
  executor_.each(n_slots, CountBlockPairs{rows, slot, places_.counts(n_slots)});
  const Index n = places_.rank(4 * n_slots);
  key_.resize(n), value_.resize(n);
  const int bits = bits_below(n_vertices_);
  executor_.each(n_slots,
                 FillPairKeys{rows, slot, first, bits, places_.places(), key_.data(), value_.data()});
  executor_.sort(key_.data(), value_.data(), n, bits + bits_below(last - first));

  std::uint8_t *const head = places_.counts(n), *const upper = upper_.counts(n);
  executor_.each(n, MarkBlocks{key_.data(), first, bits, head, upper});
  const double share = static_cast<double>(last - first) / n_vertices_;
  const Index n_blocks =
      places_.rank(static_cast<Index>(share * static_cast<double>(expected_.n_blocks(n_vertices_))));
  piece.n_contributions = upper_.rank(n * 10 / 16);
  piece.column.resize(n_blocks), piece.begin.resize(n_blocks);
  executor_.each(
      n, FillBlocks{key_.data(), value_.data(), first, bits, head, upper, places_.places(), upper_.places(),
                    n_before, piece.column.data(), piece.begin.data(), code_.data(), touched_.data()});
  return piece;
}

void ContactPattern::join(std::vector<Piece>& pieces, Index n_contributions) {
  Index n = 0;
  for (const Piece& piece : pieces) n += piece.column.size();
  column_.resize(n), begin_.resize(n + 1);
  Index at = 0;
  for (Piece& piece : pieces) {
    const auto size = static_cast<std::size_t>(piece.column.size());
    executor_.copy(column_.data() + at, piece.column.data(), size * sizeof(int));
    executor_.copy(begin_.data() + at, piece.begin.data(), size * sizeof(std::uint32_t));
    executor_.synchronize();
    at += piece.column.size();
    piece.column.free(), piece.begin.free();
  }
  begin_.set(n, static_cast<std::uint32_t>(n_contributions));
}

}  // namespace bb::resident
