// Parallel loops over elements: gather points, call the element function, write the element's own slots.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/energy/local_terms.hpp"
#include "core/energy/terms.hpp"
#include "core/math/error.hpp"
#include "core/math/lower_blocks.hpp"
#include "core/math/parallel.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// Calls f(e) for every e in [0, n), in any order, on any thread.
template <class F>
void for_each_element(std::size_t n, const F& f) {
  parallel_items(n, 64, f);
}

/// The W points of element e, in the scalar T.
template <int W, class T = double>
struct Points {
  Vec<T, 3> x[W];
  Points(const PositionsView& all, std::span<const int> vertices, std::size_t e) {
    for (std::size_t i = 0; i < W; ++i) x[i] = all.col(vertices[W * e + i]).template cast<T>();
  }
};

template <class T, int N>
void store_terms(const ElementTerms<T, N>& terms, std::size_t e, PassParts parts, LocalTerms& out) {
  if (parts.values) {
    out.energy[e] = terms.energy;
    std::copy_n(terms.grad.data(), N, out.grad.data() + N * e);
  }
  if (parts.hessians) {
    store_lower_blocks(N / 3, terms.hess, out.hess.data() + n_lower_numbers(N / 3) * e,
                       [](T entry) -> double { return entry; });
  }
}

/// ConfigError unless a column has one entry an element and, where `positive`, no entry that is not > 0.
inline void check_column(const char* where, std::size_t n, std::span<const double> column, bool positive) {
  if (column.size() != n) {
    throw ConfigError(where, std::to_string(column.size()) + " entries",
                      std::to_string(n) + ", one an element");
  }
  for (std::size_t e = 0; e < n; ++e) {
    if (positive && !(column[e] > 0)) {
      throw ConfigError(where, std::to_string(column[e]) + " in element " + std::to_string(e),
                        "a number > 0");
    }
  }
}

}  // namespace bb
