#include "core/terms/executor/gather_lists.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "core/linear/gather_map.hpp"
#include "core/math/at.hpp"
#include "core/math/error.hpp"
#include "core/math/lower_blocks.hpp"
#include "core/math/stop_request.hpp"

namespace bb::exec {
namespace {

std::uint32_t narrow(std::size_t i) { return static_cast<std::uint32_t>(i); }

/// Both triangles of a pattern of lower columns, as rows.
BlockRows both_triangles(const BlockPattern& lower) {
  const int n = lower.n_vertices();
  BlockRows rows;
  rows.row_begin.assign(at(n) + 1, 0);
  const auto for_each_block = [&](const auto& f) {
    for (int c = 0; c < n; ++c) {
      for (int b = lower.column_start[at(c)]; b < lower.column_start[at(c) + 1]; ++b) f(lower.row[at(b)], c);
    }
  };
  for_each_block([&](int r, int c) {
    ++rows.row_begin[at(r) + 1];
    if (r != c) ++rows.row_begin[at(c) + 1];
  });
  for (std::size_t r = 1; r < rows.row_begin.size(); ++r) rows.row_begin[r] += rows.row_begin[r - 1];
  if (rows.row_begin.back() > std::numeric_limits<std::uint32_t>::max()) {
    throw ConfigError("matrix of elements", std::to_string(rows.row_begin.back()) + " blocks", "2^32");
  }
  rows.column.resize(at(rows.row_begin.back()));
  std::vector<Index> next(rows.row_begin.begin(), rows.row_begin.end() - 1);
  // by columns: what is left of the diagonal comes first, in ascending order; then the column's own blocks as its row
  for_each_block([&](int r, int c) {
    if (r != c) rows.column[at(next[at(r)]++)] = c;
  });
  for_each_block([&](int r, int c) { rows.column[at(next[at(c)]++)] = r; });
  return rows;
}

/// The stencils of a piece with their vertices counted from `first`: the maps of a piece are as long as the range of its vertices.
struct Ranged {
  int first = 0, n_vertices = 0;
  std::vector<int> vertices;

  /// Errors: ConfigError for a vertex that is no row of n_rows.
  Ranged(const Stencils& stencils, int n_rows)
      : vertices(stencils.vertices.begin(), stencils.vertices.end()) {
    int least = std::numeric_limits<int>::max(), largest = -1;
    for (const int v : vertices) {
      if (v < 0) continue;
      least = std::min(least, v), largest = std::max(largest, v);
    }
    if (largest >= n_rows)
      throw ConfigError("Stencils", "vertex " + std::to_string(largest), "-1 to n_vertices - 1");
    if (largest < 0) return;
    first = least, n_vertices = largest - least + 1;
    for (int& v : vertices) {
      if (v >= 0) v -= first;
    }
  }
};

}  // namespace

BlockRows block_rows(int n_vertices, std::span<const Stencils> families) {
  BlockPattern pattern = diagonal_pattern(n_vertices), next;
  for (const Stencils& stencils : families) {
    heed_stop();
    GatherMap map;
    map.build(stencils, n_vertices);
    unite(pattern, map.column_start(), map.rows(), next);
    std::swap(pattern, next);
  }
  return both_triangles(pattern);
}

GatherLists::Lists::Lists(Executor& executor, const char* name)
    : target(executor, std::string(name) + " targets"),
      start(executor, std::string(name) + " starts"),
      source(executor, std::string(name) + " sources") {}

void GatherLists::Lists::upload(std::span<const std::uint32_t> targets, std::span<const std::uint32_t> starts,
                                std::span<const std::uint32_t> sources) {
  target.upload(targets), start.upload(starts), source.upload(sources);
}

GatherLists::GatherLists(Executor& executor, const Stencils& stencils, const BlockRows& rows)
    : vertices_(executor, "element gradient gather"), blocks_(executor, "element matrix gather") {
  if (stencils.size() > std::size_t{1} << 27) {
    throw ConfigError("piece of elements", std::to_string(stencils.size()) + " elements", "2^27");
  }
  heed_stop();
  const Ranged own(stencils, static_cast<int>(rows.row_begin.size()) - 1);
  GatherMap map;
  map.build({stencils.width, own.vertices}, own.n_vertices);
  const std::size_t width = static_cast<std::size_t>(map.width()), size = n_lower_blocks(width);

  std::vector<std::uint32_t> target, start, source;
  const auto vertex_start = map.gradient_start();
  for (std::size_t v = 0; v + 1 < vertex_start.size(); ++v) {
    if (vertex_start[v] == vertex_start[v + 1]) continue;
    target.push_back(narrow(v + at(own.first)));
    start.push_back(narrow(vertex_start[v]));
  }
  for (const std::size_t from : map.gradient_sources()) {
    const std::size_t slot = from / 3;
    source.push_back(narrow(slot / width << 2 | slot % width));
  }
  start.push_back(narrow(source.size()));
  vertices_.upload(target, start, source);

  target.clear(), start.clear(), source.clear();
  for (int c = 0; c < own.n_vertices; ++c) {
    for (int t = map.column_start()[at(c)]; t < map.column_start()[at(c) + 1]; ++t) {
      const int r = own.first + map.rows()[at(t)];
      target.push_back(narrow(at(find_block(rows.row_begin.data(), rows.column.data(), r, own.first + c))));
      start.push_back(map.source_start()[at(t)]);
    }
  }
  for (const std::uint32_t from : map.sources()) {
    const std::size_t block = from / 2;
    source.push_back(narrow(block / size << 5 | block % size << 1 | from % 2));
  }
  start.push_back(narrow(source.size()));
  blocks_.upload(target, start, source);
}

void GatherLists::add_gradients(Executor& executor, Index n, const double* grad, double* g) const {
  executor.each(vertices_.target.size(), GatherVertices{vertices_.view(), grad, n, g});
}

void GatherLists::add_hessians(Executor& executor, Index n, const double* hess, double* value) const {
  executor.each(blocks_.target.size(), GatherBlocks{blocks_.view(), hess, n, value});
}

}  // namespace bb::exec
