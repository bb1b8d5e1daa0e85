#include "core/linear/block_starts.hpp"

#include <algorithm>

#include "core/math/at.hpp"
#include "core/math/error.hpp"

namespace bb {
void check_block_starts(const ReducedSystem& system) {
  const std::vector<int>& start = system.block_start;
  bool good = !start.empty() && start.front() == 0 && start.back() == system.lower.rows();
  for (std::size_t b = 0; good && b + 1 < start.size(); ++b) {
    const int size = start[b + 1] - start[b];
    good = size >= 1 && size <= 3;
  }
  if (!good) throw ConfigError("ReducedSystem block_start", "a list", "0 to n in steps of 1 to 3");
}

namespace {

/// Whether each column of [begin, end) has the rows of the first one from its own diagonal on.
bool has_full_column(int begin, int end, const int* outer, const int* inner) {
  for (int j = begin; j < end; ++j) {
    const int *first = inner + outer[begin] + (j - begin), *beyond = inner + outer[begin + 1];
    if (first >= beyond || *first != j) return false;
    if (!std::equal(first, beyond, inner + outer[j], inner + outer[j + 1])) return false;
  }
  return true;
}

}  // namespace

void lower_block_columns(const ReducedSystem& system, std::vector<int>& start, std::vector<int>& row) {
  check_block_starts(system);
  const std::vector<int>& first = system.block_start;
  const int *outer = system.lower.outerIndexPtr(), *inner = system.lower.innerIndexPtr();
  std::vector<int> block_of(first.empty() ? 0 : at(first.back())), mark(first.size(), -1);
  for (std::size_t b = 0; b + 1 < first.size(); ++b) {
    for (int i = first[b]; i < first[b + 1]; ++i) block_of[at(i)] = static_cast<int>(b);
  }
  start.assign(1, 0);
  row.clear();
  for (int c = 0; c + 1 < static_cast<int>(first.size()); ++c) {
    const bool full = has_full_column(first[at(c)], first[at(c) + 1], outer, inner);
    for (int j = first[at(c)]; j < (full ? first[at(c)] + 1 : first[at(c) + 1]); ++j) {
      for (int k = outer[j]; k < outer[j + 1]; ++k) {
        if (inner[k] < j) {
          throw ConfigError("ReducedSystem", "an entry above the diagonal", "lower triangle only");
        }
        const int r = block_of[at(inner[k])];
        if (mark[at(r)] == c) continue;
        mark[at(r)] = c;
        row.push_back(r);
      }
    }
    if (!std::is_sorted(row.begin() + start.back(), row.end())) {
      std::sort(row.begin() + start.back(), row.end());
    }
    start.push_back(static_cast<int>(row.size()));
  }
}

std::string vertex_text(const ReducedSystem& system, int dof) {
  const auto& start = system.block_start;
  const auto block =
      static_cast<std::size_t>(std::upper_bound(start.begin(), start.end(), dof) - start.begin()) - 1;
  const bool known = block < system.block_vertex.size();
  return known ? "vertex " + std::to_string(system.block_vertex[block])
               : "block row " + std::to_string(block);
}

std::string bad_diagonal_text(const ReducedSystem& system, int dof) {
  return "the diagonal block of " + vertex_text(system, dof) + " is 0 or singular; ";
}

std::string zero_diagonal_text(const ReducedSystem& system) {
  for (int i = 0; i < system.lower.rows(); ++i) {
    const Eigen::SparseMatrix<double>::InnerIterator first(system.lower, i);
    if (!first || first.row() != i || first.value() == 0) return bad_diagonal_text(system, i);
  }
  return {};
}

}  // namespace bb
