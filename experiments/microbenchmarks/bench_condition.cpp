// Condition estimators on the matrix of a cloth: what each costs in triangular solves, products and numeric
// factorisations of the same matrix.
#include <algorithm>

#include "core/base/record/phase_times.hpp"
#include "core/linear/cholmod_factor.hpp"
#include "core/linear/condition.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "experiments/microbenchmarks/cloth_matrix.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

constexpr Scaling kScalings[] = {Scaling::none, Scaling::jacobi, Scaling::block_jacobi};

struct Matrix {
  Cloth cloth;
  std::unique_ptr<BlockSystem> blocks;
  const ReducedSystem* system;
  double factor_s;  // the fastest of five numeric factorisations

  explicit Matrix(int side) : cloth(side), blocks(cloth.system()) {
    blocks->set_contacts({cloth.contacts_a.stencils()});
    system = &cloth.assemble(*blocks, cloth.contacts_a);
    CholmodFactor factor;
    factor.factorize(*system);
    factor_s = factor.factor_s();
    for (int i = 0; i < 4; ++i) {
      factor.factorize(*system);
      factor_s = std::min(factor_s, factor.factor_s());
    }
  }
};

void count(benchmark::State& state, const Matrix& matrix, const ConditionEstimate& estimate, double seconds) {
  state.counters["solves"] = estimate.solves;
  state.counters["products"] = estimate.products;
  state.counters["factorizations"] = estimate.factorizations;
  state.counters["cond"] = estimate.cond;
  state.counters["per_factorization"] =
      benchmark::Counter(seconds / matrix.factor_s, benchmark::Counter::kAvgIterations);
  state.SetLabel(std::string(to_string(estimate.status)));
}

/// ritz is what a PCG solve leaves behind: its time is that of the solve.
void ritz(benchmark::State& state, const std::string& preconditioner) {
  const Matrix matrix(static_cast<int>(state.range(0)));
  LinearOptions options;
  options.name = "pcg";
  options.parameters["preconditioner"] = preconditioner;
  const auto solver = make_linear_solver(options);
  const VecXd b = VecXd::LinSpaced(matrix.system->lower.rows(), -1, 1);
  VecXd x;
  double seconds = 0;
  ConditionEstimate estimate;
  for (auto _ : state) {
    const double start = now_s();
    const LinearReport report = solver->solve(*matrix.system, b, x);
    estimate = condition_from_ritz(report.ritz_min, report.ritz_max);
    estimate.products = report.iterations;
    seconds += now_s() - start;
  }
  count(state, matrix, estimate, seconds);
}

/// The factor is shared with a direct solver's: `per_factorization` includes it, so 1 is the price
/// of the factor.
void estimated(benchmark::State& state, Estimator estimator, Scaling scaling) {
  const Matrix matrix(static_cast<int>(state.range(0)));
  ConditionEstimator conditions;
  double seconds = 0;
  ConditionEstimate estimate =
      conditions.estimate(*matrix.system, {estimator, scaling, 1});  // warm-up: analysis
  for (auto _ : state) {
    estimate = conditions.estimate(*matrix.system, {estimator, scaling, 1});
    seconds += estimate.seconds;
  }
  count(state, matrix, estimate, seconds);
}

}  // namespace

void register_condition() {
  const auto sizes = [](benchmark::internal::Benchmark* b) {
    b->ArgName("side")->Arg(16)->Arg(107)->Unit(benchmark::kMillisecond);
  };
  for (const std::string& label : preconditioners().names()) {
    sizes(add("condition/ritz/" + label, [label](benchmark::State& state) { ritz(state, label); }));
  }
  for (const Estimator estimator : {Estimator::inverse_power, Estimator::spectra}) {
    for (const Scaling scaling : kScalings) {
      sizes(add("condition/" + std::string(to_string(estimator)) + "/" + std::string(to_string(scaling)),
                [estimator, scaling](benchmark::State& state) { estimated(state, estimator, scaling); }));
    }
  }
}

}  // namespace bb::bench
