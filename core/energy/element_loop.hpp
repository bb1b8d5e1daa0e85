// Parallel loops over elements: gather points, call the element function, write the element's own slots.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/energy/element_batch.hpp"
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

/// Of elements first to first + n - 1, n of the L lanes.
template <class T, int L, int W>
void store_abreast(const TermsAbreast<T, L, W>& terms, std::size_t first, std::size_t n, PassParts parts,
                   LocalTerms& out) {
  constexpr std::size_t numbers = n_lower_numbers(W), size = 3 * W;
  for (std::size_t lane = 0; lane < n; ++lane) {
    const std::size_t e = first + lane;
    if (parts.values) {
      out.energy[e] = terms.energy[lane];
      for (std::size_t k = 0; k < size; ++k) out.grad[size * e + k] = terms.grad[k][lane];
    }
    if (!parts.hessians) continue;
    for (std::size_t k = 0; k < numbers; ++k) out.hess[numbers * e + k] = terms.hess[k][lane];
  }
}

/// terms.operator()<T>(e), the ElementTerms of element e in the scalar T, of n elements: each part in the scalar that
/// the precision has for it.
template <class Terms>
void store_elements(std::size_t n, Precision precision, const Terms& terms, LocalTerms& out) {
  for_each_pass(precision, [&]<class T>(PassParts parts) {
    for_each_element(n, [&](std::size_t e) { store_terms(terms.template operator()<T>(e), e, parts, out); });
  });
}

/// value.operator()<T>(e), J, of n elements.
template <class Value>
void store_energies(std::size_t n, Precision precision, const Value& value, double* energy) {
  with_value_scalar(precision, [&]<class T>() {
    for_each_element(n, [&](std::size_t e) { energy[e] = value.template operator()<T>(e); });
  });
}

/// Those of n elements for which is.operator()<T>(e) holds, in the scalar of energies, ascending.
template <class Is>
std::vector<std::size_t> elements_where(std::size_t n, Precision precision, const Is& is) {
  std::vector<std::size_t> out;
  with_value_scalar(precision, [&]<class T>() {
    for (std::size_t e = 0; e < n; ++e) {
      if (is.template operator()<T>(e)) out.push_back(e);
    }
  });
  return out;
}

/// ConfigError unless a column has one entry an element and, where `positive`, no entry that is not > 0.
inline void check_column(const char* where, std::size_t n, const std::vector<double>& column, bool positive) {
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
