// What every subject of the suite uses: registration by name and time per item.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <utility>

namespace bb::bench {

#define ENTRY(name, doc) void register_##name();
#include "experiments/microbenchmarks/registry.inc"
#undef ENTRY

/// Adds one benchmark. Wall time counts: the loops under test run on several threads.
template <class F>
benchmark::internal::Benchmark* add(const std::string& name, F&& run) {
  return benchmark::RegisterBenchmark(name.c_str(), std::forward<F>(run))->UseRealTime();
}

/// Each iteration handles n items: the report shows seconds per item.
inline void count_items(benchmark::State& state, std::size_t n) {
  using benchmark::Counter;
  state.counters["s_per_item"] =
      Counter(static_cast<double>(n), Counter::kIsIterationInvariantRate | Counter::kInvert);
  state.counters["items"] = static_cast<double>(n);
}

}  // namespace bb::bench
