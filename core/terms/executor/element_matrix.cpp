#include "core/terms/executor/element_matrix.hpp"

#include "core/math/at.hpp"
#include "core/math/lower_blocks.hpp"

namespace bb::exec {

ElementMatrix::ElementMatrix(Executor& executor, int n_vertices, Index piece)
    : executor_(executor),
      n_vertices_(n_vertices),
      piece_(piece),
      row_begin_(executor, "element matrix rows"),
      column_(executor, "element matrix columns"),
      mirror_to_(executor, "mirrored blocks"),
      mirror_from_(executor, "mirrored blocks"),
      value_(executor, "element matrix values"),
      local_(executor, "local terms of elements") {}

std::size_t ElementMatrix::add_family(int width, std::vector<int> vertices) {
  const auto w = static_cast<std::size_t>(width);
  const auto n = static_cast<Index>(vertices.size() / w);
  const auto numbers = static_cast<Index>(n_lower_numbers(w));
  local_.resize(std::max(local_.size(), numbers * std::min(piece_, n)));
  families_.push_back({width, n, std::move(vertices), {}});
  return families_.size() - 1;
}

void ElementMatrix::finish() {
  std::vector<Stencils> stencils;
  stencils.reserve(families_.size());
  for (const Family& of : families_) stencils.push_back({of.width, of.vertices});
  const BlockRows rows = block_rows(static_cast<int>(n_vertices_), stencils);
  row_begin_.upload(rows.row_begin);
  column_.upload(rows.column);
  list_mirrored(rows);
  value_.resize(value_count(n_blocks()));
  for (std::size_t i = 0; i < families_.size(); ++i) {
    Family& of = families_[i];
    const auto width = static_cast<std::size_t>(of.width);
    for (Index begin = 0; begin < of.size; begin += piece_) {
      const auto n = static_cast<std::size_t>(std::min(piece_, of.size - begin));
      const Stencils part{of.width,
                          stencils[i].vertices.subspan(width * static_cast<std::size_t>(begin), width * n)};
      of.gathers.emplace_back(executor_, part, rows);
    }
  }
  for (Family& of : families_) of.vertices = {};
}

void ElementMatrix::list_mirrored(const BlockRows& rows) {
  std::vector<std::uint32_t> to, from;
  to.reserve(rows.column.size() / 2), from.reserve(rows.column.size() / 2);
  for (Index row = 0; row < n_vertices_; ++row) {
    for (Index above = rows.row_begin[at(row + 1)] - 1; rows.column[at(above)] > row; --above) {
      to.push_back(static_cast<std::uint32_t>(above));
      from.push_back(static_cast<std::uint32_t>(find_block(rows.row_begin.data(), rows.column.data(),
                                                           rows.column[at(above)], static_cast<int>(row))));
    }
  }
  mirror_to_.upload(to), mirror_from_.upload(from);
}

void ElementMatrix::mirror() {
  executor_.each(mirror_to_.size(), MirrorBlock{mirror_to_.data(), mirror_from_.data(), value_.data()});
}

}  // namespace bb::exec
