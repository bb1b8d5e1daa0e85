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
      numbers_(executor, "numbers of the pattern", 1),
      places_(executor, "pattern"),
      upper_(executor, "pattern upper"),
      key_(executor, "pattern sort keys"),
      value_(executor, "pattern sort values") {}

void ContactPattern::starts(const exec::Buffer<std::uint32_t>& counts, exec::Buffer<Index>& begin) {
  executor_.each(n_vertices_ + 1, WidenCounts{counts.data(), begin.data(), n_vertices_});
  executor_.exclusive_scan(begin.data(), n_vertices_ + 1);
}

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

void ContactPattern::build_slots(ResidentRows& rows) {
  count(rows, false);
  fill_all_slots(rows.view());
}

/// How many slots there are, and contributions to blocks.
void ContactPattern::count(ResidentRows& rows, bool blocks) {
  if (rows.size() >= Index{1} << 28) {
    throw std::length_error("contact matrix: " + std::to_string(rows.size()) + " rows; at most " +
                            std::to_string((1 << 28) - 1));
  }
  const RowView view = rows.view();
  touched_.fill_zero();
  executor_.each(view.n, CountTouched{view, touched_.data()});
  starts(touched_, slot_begin_);
  executor_.copy(&numbers_.data()->slots, slot_begin_.data() + n_vertices_, sizeof(Index));
  if (blocks) {
    executor_.each(view.n, CountUpperPairs{view, places_.counts(view.n)});
    places_.rank_to(&numbers_.data()->contributions);
  }
  n_ = executor_.counts_only() ? Numbers{4 * expected_.rows, 10 * expected_.rows} : numbers_.get(0);
}

void ContactPattern::fill_all_slots(const RowView& rows) {
  slot_.fit(n_.slots);
  if (slot_.size() == 0) return;
  for (int first = 0, last; first < n_vertices_; first = last) {
    last = end_of_chunk(first, chunk_);
    fill_slots(rows, first, last);
  }
}

void ContactPattern::fill_slots(const RowView& rows, int first, int last) {
  executor_.each(rows.n, CountSlots{rows, first, last, places_.counts(rows.n)});
  places_.rank_to(nullptr);
  const Index begin = slot_begin(first), n = slot_begin(last) - begin;
  if (n == 0) return;
  key_.fit(n);
  std::uint32_t* const slot = slot_.data() + begin;
  executor_.each(rows.n, FillSlots{rows, first, last, places_.places(), key_.data(), slot});
  executor_.sort(key_.data(), slot, n, bits_below(last - first));
}

void ContactPattern::build(ResidentRows& rows) {
  count(rows, true);
  const RowView view = rows.view();
  fill_all_slots(view);
  code_.fit(n_.contributions);
  touched_.fill_zero();  // blocks of a row from now on
  column_.resize(0), begin_.fit(1);
  begin_.fill_zero();
  if (slot_.size() > 0 && end_of_chunk(0, chunk_ / 4) == n_vertices_) {
    const Index n = 2 * n_.contributions - n_.slots;  // of both triangles, less the diagonal's second ones
    fill_blocks(view, {0, n_vertices_, n, 0}, column_, begin_);
  } else if (slot_.size() > 0) {
    build_in_pieces(view);
  }
  if (slot_.size() >= exact_from) key_.free(), value_.free(), places_.free(), upper_.free();
  starts(touched_, row_begin_);
}

void ContactPattern::build_in_pieces(const RowView& rows) {
  std::vector<Piece> pieces;
  Index n_before = 0;
  for (int first = 0, last; first < n_vertices_; first = last) {
    last = end_of_chunk(first, chunk_ / 4);
    const Index from = slot_begin(first), n_slots = slot_begin(last) - from;
    if (n_slots == 0) continue;
    executor_.each(n_slots, CountBlockPairs{rows, slot_.data() + from, places_.counts(n_slots)});
    const Chunk chunk{first, last, places_.rank(4 * n_slots), n_before};
    pieces.push_back(
        {{executor_, "contact matrix columns"}, {executor_, "contact matrix contributions, starts"}});
    n_before += fill_blocks(rows, chunk, pieces.back().column, pieces.back().begin);
  }
  join(pieces);
}

/// Blocks of the vertices of a chunk; begin gets one number more. Returns how many contributions they have.
Index ContactPattern::fill_blocks(const RowView& rows, const Chunk& chunk, exec::Buffer<int>& column,
                                  exec::Buffer<std::uint32_t>& begin) {
  const int first = chunk.first, last = chunk.last;
  const Index from = slot_begin(first), n_slots = slot_begin(last) - from, n = chunk.n_pairs;
  const std::uint32_t* const slot = slot_.data() + from;
  executor_.each(n_slots, CountBlockPairs{rows, slot, places_.counts(n_slots)});
  places_.rank_to(nullptr);
  key_.fit(n), value_.fit(n);
  const int bits = bits_below(n_vertices_);
  executor_.each(n_slots,
                 FillPairKeys{rows, slot, first, bits, places_.places(), key_.data(), value_.data()});
  executor_.sort(key_.data(), value_.data(), n, bits + bits_below(last - first));

  std::uint8_t *const head = places_.counts(n), *const upper = upper_.counts(n);
  executor_.each(n, MarkBlocks{key_.data(), first, bits, head, upper});
  places_.rank_to(&numbers_.data()->slots), upper_.rank_to(&numbers_.data()->contributions);
  const double share = static_cast<double>(last - first) / n_vertices_;
  const Numbers found =
      executor_.counts_only()
          ? Numbers{static_cast<Index>(share * static_cast<double>(expected_.n_blocks(n_vertices_))),
                    n * 10 / 16}
          : numbers_.get(0);
  const Index n_blocks = found.slots;
  column.fit(n_blocks), begin.fit(n_blocks + 1);
  executor_.each(n, FillBlocks{key_.data(), value_.data(), n, first, bits, head, upper, places_.places(),
                               upper_.places(), chunk.n_before, column.data(), begin.data(), code_.data(),
                               touched_.data()});
  return found.contributions;
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

}  // namespace bb::resident
