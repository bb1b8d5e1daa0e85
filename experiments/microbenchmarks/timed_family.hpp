// The timed loop of a kind of element: gradients and projected Hessians of a family.
#pragma once

#include <cmath>

#include "core/energy/families/element_family.hpp"
#include "core/energy/local_terms.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {

/// Counter `gradient`: mean sum of magnitudes of an element's gradient, J/m; 0: the elements are at rest, and nothing was timed that a
/// run has.
inline void report_gradient(benchmark::State& state, const LocalTerms& terms, std::size_t n) {
  double sum = 0;
  for (const double g : terms.grad) sum += std::abs(g);
  state.counters["gradient"] = sum / static_cast<double>(n);
}

inline void derivatives(benchmark::State& state, ElementFamily& family, const Positions& x) {
  LocalTerms terms;
  for (auto _ : state) {
    family.derivatives(x.data(), Projection::psd, terms);
    benchmark::DoNotOptimize(terms.hess.data());
    benchmark::DoNotOptimize(terms.grad.data());
    benchmark::ClobberMemory();
  }
  const auto n = static_cast<std::size_t>(family.size());
  count_items(state, n);
  report_gradient(state, terms, n);
}

}  // namespace bb::bench
