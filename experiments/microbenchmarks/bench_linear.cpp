// Google Benchmark of the linear room on a generated cloth grid with contacts: assembly, factorisation,
// solves, condition estimates. The default size is 107 x 107 vertices: 22k triangles, 34k hinges, 20k
// contacts.
#include <benchmark/benchmark.h>

#include <memory>
#include <random>
#include <vector>

#include "core/linear/block_system.hpp"
#include "core/linear/cholmod_factor.hpp"
#include "core/linear/condition.hpp"

namespace bb {
namespace {

/// A family of stencils, each with one positive semi-definite local Hessian kappa w w^T (x) (n n^T + I / 10).
struct Family {
  int width = 0;
  std::vector<int> vertices;
  std::vector<double> hess;
  Stencils stencils() const { return {width, vertices}; }

  void add(const std::vector<int>& v, const VecXd& weights, const Vec3d& n, double kappa) {
    width = static_cast<int>(v.size());
    vertices.insert(vertices.end(), v.begin(), v.end());
    const Mat3d block = kappa * (n * n.transpose() + 0.1 * Mat3d::Identity());
    for (int j = 0; j < width; ++j) {
      for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < width; ++i) {
          for (int r = 0; r < 3; ++r) hess.push_back(weights[i] * weights[j] * block(r, c));
        }
      }
    }
  }
};

struct Cloth {
  int side, n;
  Family triangles, hinges, contacts_a, contacts_b;

  explicit Cloth(int m) : side(m), n(m * m) {
    const auto id = [m](int i, int j) { return i * m + j; };
    const Vec3d up = Vec3d::UnitZ(), across = Vec3d(1, 1, 0).normalized();
    for (int i = 0; i + 1 < m; ++i) {
      for (int j = 0; j + 1 < m; ++j) {
        const int a = id(i, j), b = id(i + 1, j), c = id(i, j + 1), d = id(i + 1, j + 1);
        triangles.add({a, b, c}, Vec3d(1, -0.4, -0.6), across, 1e3);
        triangles.add({d, c, b}, Vec3d(1, -0.6, -0.4), across, 1e3);
        const Eigen::Vector4d w(1, 1, -1, -1);
        hinges.add({b, c, a, d}, w, up, 1e-1);
        if (j + 2 < m) hinges.add({c, d, b, id(i + 1, j + 2)}, w, up, 1e-1);
        if (i + 2 < m) hinges.add({b, d, c, id(i + 2, j)}, w, up, 1e-1);
      }
    }
    fill_contacts(contacts_a, 1);
    fill_contacts(contacts_b, 2);
  }

  /// A fold: vertices touch triangles in the other half of the sheet.
  void fill_contacts(Family& contacts, unsigned seed) const {
    std::mt19937_64 random(seed);
    const auto below = [&random](int k) { return static_cast<int>(random() % static_cast<unsigned>(k)); };
    for (int k = 0; k < 2 * n - n / 4; ++k) {
      const int i = below(side / 2 - 1), j = below(side - 1);
      const int p = i * side + j, t = (side - 2 - i) * side + std::min(j + below(3), side - 2);
      contacts.add({p, t, t + 1, t + side}, Eigen::Vector4d(1, -0.3, -0.3, -0.4), Vec3d::UnitZ(), 1e4);
    }
  }

  std::unique_ptr<BlockSystem> system() const {
    auto s = std::make_unique<BlockSystem>(n, std::vector<std::uint8_t>(3 * static_cast<std::size_t>(n), 0));
    s->set_elements({triangles.stencils(), hinges.stencils()});
    return s;
  }
  const ReducedSystem& assemble(BlockSystem& s, const Family& contacts) const {
    s.clear();
    s.add_diagonal(std::vector<double>(static_cast<std::size_t>(n), 1.0));
    s.add_elements(0, triangles.hess);
    s.add_elements(1, hinges.hess);
    s.add_contacts(0, contacts.hess);
    return s.reduce(s.values());
  }
};

void set_elements(benchmark::State& state) {
  const Cloth cloth(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(cloth.system());
}

/// New contact stencils and pattern in every iteration.
void set_contacts(benchmark::State& state) {
  const Cloth cloth(static_cast<int>(state.range(0)));
  const auto s = cloth.system();
  bool first = false;
  for (auto _ : state) {
    first = !first;
    benchmark::DoNotOptimize(s->set_contacts({(first ? cloth.contacts_a : cloth.contacts_b).stencils()}));
  }
  state.counters["contacts"] = static_cast<double>(cloth.contacts_a.stencils().size());
}

void assemble(benchmark::State& state) {
  const Cloth cloth(static_cast<int>(state.range(0)));
  const auto s = cloth.system();
  s->set_contacts({cloth.contacts_a.stencils()});
  for (auto _ : state) benchmark::DoNotOptimize(&cloth.assemble(*s, cloth.contacts_a));
  state.counters["nonzeros"] = static_cast<double>(cloth.assemble(*s, cloth.contacts_a).lower.nonZeros());
}

void cholmod_analyze_and_factorize(benchmark::State& state) {
  const Cloth cloth(static_cast<int>(state.range(0)));
  const auto s = cloth.system();
  s->set_contacts({cloth.contacts_a.stencils()});
  const ReducedSystem& system = cloth.assemble(*s, cloth.contacts_a);
  for (auto _ : state) {
    CholmodFactor factor;
    if (factor.factorize(system) != LinearStatus::ok) state.SkipWithError("not positive definite");
    state.counters["analyze_s"] = factor.analyze_s();
    state.counters["factor_s"] = factor.factor_s();
    state.counters["flops"] = factor.factor_flops();
  }
}

void cholmod_refactorize(benchmark::State& state) {
  const Cloth cloth(static_cast<int>(state.range(0)));
  const auto s = cloth.system();
  s->set_contacts({cloth.contacts_a.stencils()});
  const ReducedSystem& system = cloth.assemble(*s, cloth.contacts_a);
  CholmodFactor factor;
  for (auto _ : state) {
    if (factor.factorize(system) != LinearStatus::ok) state.SkipWithError("not positive definite");
  }
}

void solve(benchmark::State& state, const char* name, const char* preconditioner) {
  const Cloth cloth(static_cast<int>(state.range(0)));
  const auto s = cloth.system();
  s->set_contacts({cloth.contacts_a.stencils()});
  const ReducedSystem& system = cloth.assemble(*s, cloth.contacts_a);
  LinearOptions options;
  options.name = name;
  options.preconditioner = preconditioner;
  options.tol_rel = 1e-6;
  const auto solver = make_linear_solver(options);
  const VecXd b = VecXd::LinSpaced(system.lower.rows(), -1, 1);
  VecXd x;
  solver->solve(system, b, x);
  for (auto _ : state) {
    const LinearReport report = solver->solve(system, b, x);
    if (report.status != LinearStatus::ok) state.SkipWithError(std::string(to_string(report.status)).c_str());
    state.counters["iterations"] = report.iterations;
    state.counters["solve_s"] = report.solve_s;
    state.counters["residual"] = report.residual_true;
  }
}

/// One matrix, three scalings.
void condition(benchmark::State& state) {
  const Cloth cloth(static_cast<int>(state.range(0)));
  const auto s = cloth.system();
  s->set_contacts({cloth.contacts_a.stencils()});
  const ReducedSystem& system = cloth.assemble(*s, cloth.contacts_a);
  ConditionEstimator estimator;
  const int tier = static_cast<int>(state.range(1));
  estimator.estimate(system, {tier, Scaling::none, 1});
  for (auto _ : state) {
    const auto all = estimator.estimate_all(system, tier, 1);
    state.counters["cond"] = all[0].cond;
    state.counters["solves"] = all[0].solves + all[1].solves + all[2].solves;
    state.counters["extra_factors"] = all[0].factorizations + all[1].factorizations + all[2].factorizations;
  }
}

constexpr int kSide = 107;
BENCHMARK(set_elements)->Arg(kSide)->Unit(benchmark::kMillisecond);
BENCHMARK(set_contacts)->Arg(kSide)->Unit(benchmark::kMillisecond);
BENCHMARK(assemble)->Arg(kSide)->Unit(benchmark::kMillisecond);
BENCHMARK(cholmod_analyze_and_factorize)->Arg(kSide)->Unit(benchmark::kMillisecond);
BENCHMARK(cholmod_refactorize)->Arg(kSide)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve, cholmod, "cholmod", "none")->Arg(kSide)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve, pcg_jacobi, "pcg", "jacobi")->Arg(kSide)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve, pcg_block_jacobi, "pcg", "block_jacobi")->Arg(kSide)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(solve, pcg_ic0, "pcg", "ic0")->Arg(kSide)->Unit(benchmark::kMillisecond);
BENCHMARK(condition)->Args({kSide, 1})->Args({kSide, 2})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace bb
