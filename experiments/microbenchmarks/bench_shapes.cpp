// Every shape of the registry on every argument, in both precisions, over columns of gaps inside (0, d_hat).
#include <random>
#include <vector>

#include "barriers/shapes/registry.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

constexpr std::size_t kRows = 4096;  // six columns of doubles: fits the second-level cache

template <class T>
void evaluate(benchmark::State& state, const BarrierFunction& barrier) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<T> relative_gap(T(1e-3), T(1));
  std::vector<T> d(kRows), d_hat(kRows, T(1e-2)), b(kRows), db(kRows), d2b(kRows);
  for (std::size_t i = 0; i < kRows; ++i) d[i] = relative_gap(random) * d_hat[i];
  for (auto _ : state) {
    barrier.eval(kRows, d.data(), d_hat.data(), b.data(), db.data(), d2b.data());
    benchmark::DoNotOptimize(b.data());
    benchmark::ClobberMemory();
  }
  count_items(state, kRows);
}

}  // namespace

void register_shapes() {
  for (const Shape& shape : all_shapes()) {
    for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
      const BarrierFunction barrier{shape, argument};
      const std::string name = "shape/" + shape.name + "/" + std::string(to_string(argument));
      add(name + "/double", [barrier](benchmark::State& state) { evaluate<double>(state, barrier); });
      add(name + "/float", [barrier](benchmark::State& state) { evaluate<float>(state, barrier); });
    }
  }
}

}  // namespace bb::bench
