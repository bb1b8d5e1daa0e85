#include "core/terms/executor/element_matrix.hpp"

#include "core/math/lower_blocks.hpp"

namespace bb::exec {

ElementMatrix::ElementMatrix(Executor& executor, int n_vertices, Index piece)
    : executor_(executor),
      n_vertices_(n_vertices),
      piece_(piece),
      row_begin_(executor, "element matrix rows"),
      column_(executor, "element matrix columns"),
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

void ElementMatrix::mirror() {
  executor_.each(n_vertices_, MirrorRow{row_begin_.data(), column_.data(), value_.data()});
}

}  // namespace bb::exec
