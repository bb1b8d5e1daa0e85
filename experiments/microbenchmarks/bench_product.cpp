// The product of PCG beside a plain read of as many bytes, on 1 and 2 threads: what of the memory's bandwidth it gets.
#include <tbb/global_control.h>

#include "core/linear/parallel.hpp"
#include "core/linear/symmetric_product.hpp"
#include "core/math/lanes.hpp"
#include "experiments/microbenchmarks/cloth_matrix.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

SymmetricProduct product_of(int side) {
  const Cloth cloth(side);
  const auto s = cloth.system();
  s->set_contacts({cloth.contacts_a.stencils()});
  SymmetricProduct a;
  a.update(cloth.assemble(*s, cloth.contacts_a));
  return a;
}

void set_bytes(benchmark::State& state, double bytes) {
  state.counters["bytes"] = bytes;
  state.counters["bytes_per_s"] = benchmark::Counter(bytes, benchmark::Counter::kIsIterationInvariantRate);
}

tbb::global_control threads_of(const benchmark::State& state) {
  return {tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(state.range(1))};
}

void product(benchmark::State& state) {
  const SymmetricProduct a = product_of(static_cast<int>(state.range(0)));
  const tbb::global_control threads = threads_of(state);
  const VecXd x = VecXd::LinSpaced(a.n(), -1, 1);
  VecXd y;
  for (auto _ : state) {
    a.multiply(x, y);
    benchmark::DoNotOptimize(y.data());
  }
  set_bytes(state, a.bytes());
}

/// Sums as many numbers as the matrix of that size has bytes.
void read(benchmark::State& state) {
  const double bytes = product_of(static_cast<int>(state.range(0))).bytes();
  const tbb::global_control threads = threads_of(state);
  const VecXd numbers = VecXd::Ones(static_cast<Eigen::Index>(bytes / sizeof(double)));
  const std::size_t n = static_cast<std::size_t>(numbers.size());
  std::vector<double> sums(n_blocks(n));
  for (auto _ : state) {
    parallel_blocks(n, [&](std::size_t b, std::size_t begin, std::size_t end) {
      Lanes<double, 4> even(0.0), odd(0.0);  // two chains: one would wait for its additions, not for memory
      for (std::size_t i = begin; i + 8 <= end; i += 8) {
        even += load_lanes<4>(numbers.data() + i);
        odd += load_lanes<4>(numbers.data() + i + 4);
      }
      sums[b] = (even + odd)[0];
    });
    benchmark::DoNotOptimize(sums.data());
  }
  set_bytes(state, static_cast<double>(n * sizeof(double)));
}

}  // namespace

void register_product() {
  for (const auto& [name, run] :
       {std::pair{"product/multiply", &product}, std::pair{"product/read", &read}}) {
    add(name, run)
        ->ArgNames({"side", "threads"})
        ->ArgsProduct({{16, 107, 320}, {1, 2}})
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace bb::bench
