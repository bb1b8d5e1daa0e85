// Every shape of the registry on every argument, in both precisions, over columns of gaps inside (0, d_hat); and three
// of them as formulas, where this machine can compile them.
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "barriers/formulas.hpp"
#include "barriers/shapes/registry.hpp"
#include "core/math/error.hpp"
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

void add_shape(const std::string& label, const Shape& shape) {
  for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
    const BarrierFunction barrier{shape, argument};
    const std::string name = "shape/" + label + "/" + std::string(to_string(argument));
    add(name + "/double", [barrier](benchmark::State& state) { evaluate<double>(state, barrier); });
    add(name + "/float", [barrier](benchmark::State& state) { evaluate<float>(state, barrier); });
  }
}

struct AsFormula {
  const char *label, *text;
};
constexpr AsFormula as_formulas[] = {{"log_as_formula", "-(d - d_hat)^2*log(d/d_hat)"},
                                     {"cubic_as_formula", "2/(3*d_hat)*(d_hat - d)^3"},
                                     {"quadratic_as_formula", "(d - d_hat)^2"}};

}  // namespace

void register_shapes() {
  for (const Shape& shape : all_shapes()) add_shape(shape.name, shape);
  try {
    for (const AsFormula& one : as_formulas)
      add_shape(one.label, require_formula(one.text, {}, one.label).shape);
  } catch (const ConfigError& error) {
    std::fprintf(stderr, "no formulas here: %s\n", error.what());
  }
}

}  // namespace bb::bench
