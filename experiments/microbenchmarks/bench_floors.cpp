// Elements and contact terms beside what they have to compute: operations counted (counted.hpp), and what this processor does of
// these in a second where nothing waits, side by side in lanes and without fused multiply-adds, as all of the program's code.
#include <tbb/global_control.h>

#include <random>
#include <vector>

#include "core/contact/row_hessian.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/hinge.hpp"
#include "core/energy/membrane_list.hpp"
#include "core/energy/rest_shapes.hpp"
#include "core/exec/host_executor.hpp"
#include "core/math/lanes.hpp"
#include "experiments/microbenchmarks/cloth_stack.hpp"
#include "experiments/microbenchmarks/counted.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

using Four = Lanes<double, 4>;

/// One product and one sum a lane and chain, chains enough to hide what each waits for.
void peak(benchmark::State& state) {
  constexpr int chains = 8, rounds = 1024;
  const Four f(1.0 + 1e-9);
  Four a(1.0), b(1.1), c(1.2), d(1.3), e(1.4), g(1.5), h(1.6), i(1.7);
  for (auto _ : state) {
    for (int k = 0; k < rounds; ++k) {
      a = a * f + f, b = b * f + f, c = c * f + f, d = d * f + f;
      e = e * f + f, g = g * f + f, h = h * f + f, i = i * f + f;
    }
    benchmark::DoNotOptimize(a + b + c + d + e + g + h + i);
  }
  state.counters["flop_per_s"] =
      benchmark::Counter(2.0 * 4 * chains * rounds, benchmark::Counter::kIsIterationInvariantRate);
}

/// flops: of one item, counted. The report shows seconds an item beside it, and operations a second.
void set_flops(benchmark::State& state, std::size_t items, double flops) {
  count_items(state, items);
  state.counters["flop"] = flops;
  state.counters["flop_per_s"] =
      benchmark::Counter(flops * static_cast<double>(items), benchmark::Counter::kIsIterationInvariantRate);
}

void run_family(benchmark::State& state, ElementFamily& family, const Positions& x, Projection projection,
                double flops) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  LocalTerms terms;
  for (auto _ : state) {
    family.derivatives(x.data(), projection, terms);
    benchmark::DoNotOptimize(terms.hess.data());
    benchmark::ClobberMemory();
  }
  set_flops(state, static_cast<std::size_t>(family.size()), flops);
}

template <std::size_t W>
void gather_points(const Positions& x, const std::array<int, W>& vertices, Vec<Counted, 3> (&out)[W]) {
  for (std::size_t k = 0; k < W; ++k) {
    for (int c = 0; c < 3; ++c) out[k][c] = x(c, vertices[k]);
  }
}

void membrane(benchmark::State& state, Projection projection) {
  const Scene scene = cloth_stack(1, 64);
  MembranePart part = scene.membranes.front();
  part.model = "corotational";
  const auto rests = triangle_rests(part.triangles, scene.rest, false, part.warp);
  const double flops = flops_of(rests.size(), [&](std::size_t e) {
    Vec<Counted, 3> p[3];
    gather_points(scene.x0, part.triangles[e], p);
    TriangleRest<Counted> rest;
    for (int k = 0; k < 4; ++k) rest.dm_inv.data()[k] = rests[e].dm_inv.data()[k];
    rest.area = rests[e].area;
    const auto terms = membrane_terms<membrane::corotational, 3, Counted>(rest, p, part.lame_mu[e],
                                                                          part.lame_lambda[e], projection);
    benchmark::DoNotOptimize(&terms);
  });
  exec::HostExecutor executor;
  run_family(state, *membrane_family({executor}, part, scene.rest, false), scene.x0, projection, flops);
}

/// Without the arc tangent of the angle.
void hinge(benchmark::State& state, Projection projection) {
  const Scene scene = cloth_stack(1, 64);
  const HingePart& part = scene.hinges;
  const double flops = flops_of(part.hinges.size(), [&](std::size_t e) {
    Vec<Counted, 3> p[4];
    gather_points(scene.x0, part.hinges[e], p);
    Vec3d x[4];
    for (std::size_t k = 0; k < 4; ++k) x[k] = scene.x0.col(part.hinges[e][k]);
    const HingeEnergy<double> of = hinge_energy<double>(x, part.stiffness[e], part.rest_angle[e]);
    const auto terms = hinge_terms_of<Counted>(p, {of.energy, of.stiffness, of.deviation}, projection);
    benchmark::DoNotOptimize(&terms);
  });
  exec::HostExecutor executor;
  run_family(state, *hinge_family({executor}, part), scene.x0, projection, flops);
}

/// A row whose closest points slide along two edges, as those of point and triangle do inside.
template <class T>
RowShape<T, 2> row_shape(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  RowShape<T, 2> row;
  for (int i = 0; i < 4; ++i)
    row.w[i] = T(unit(random)), row.g[0][i] = T(unit(random)), row.g[1][i] = T(unit(random));
  row.n = Vec<T, 3>(T(0.0), T(0.0), T(1.0));
  row.q[0] = Vec<T, 3>(T(1.0), T(0.0), T(0.0));
  row.q[1] = Vec<T, 3>(T(0.0), T(1.0), T(0.0));
  row.distance = T(1e-3), row.stiffness = T(2.0 + unit(random)), row.force = T(-1e-3);
  return row;
}

void contact_row(benchmark::State& state) {
  constexpr std::size_t n = 1024;
  std::mt19937_64 random(3);
  const double flops = flops_of(n, [&](std::size_t) {
    Counted blocks[n_lower_numbers(4)];
    row_hessian<Counted, 2>(row_shape<Counted>(random), Projection::psd, blocks);
    benchmark::DoNotOptimize(&blocks);
  });
  std::vector<RowShape<Four, 2>> rows;
  for (std::size_t r = 0; r < n / 4; ++r) rows.push_back(row_shape<Four>(random));
  Four blocks[n_lower_numbers(4)];
  for (auto _ : state) {
    for (const RowShape<Four, 2>& row : rows) {
      row_hessian<Four, 2>(row, Projection::psd, blocks);
      benchmark::DoNotOptimize(&blocks);
    }
  }
  set_flops(state, n, flops);
}

}  // namespace

void register_floors() {
  add("floors/peak", peak);
  for (const auto& [projection, word] :
       {std::pair{Projection::none, "exact"}, std::pair{Projection::psd, "clamped"}}) {
    add(std::string("floors/membrane/") + word,
        [projection](benchmark::State& state) { membrane(state, projection); });
    add(std::string("floors/hinge/") + word,
        [projection](benchmark::State& state) { hinge(state, projection); });
  }
  add("floors/contact_row_hessian", contact_row);
}

}  // namespace bb::bench
