// One Newton iteration of the drape scene, part by part. `per_factorization` is a part's time over that of
// one numeric factorisation of the same matrix. The goal: everything but the linear solve costs at most
// half of one.
#include "core/linear/cholmod_factor.hpp"
#include "core/terms/strain_limit.hpp"
#include "experiments/microbenchmarks/drape_state.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

DrapeState& drape_of(benchmark::State& state) {
  DrapeState& drape = drape_state(static_cast<int>(state.range(0)));
  if (!drape.all_layers_touch) state.SkipWithError("not all layers came into contact");
  return drape;
}

template <class T>
T& term_of(DrapeState& drape) {
  return *drape.system().terms().find<T>();
}

/// The step bound of one term.
template <class T>
void bound_of(DrapeState& drape, IterateNumbers& report) {
  term_of<T>(drape).bound({drape.x(), drape.x1, drape.dx}, report, drape.system().clock());
}

/// Runs `part` in the loop and reports its time per factorisation.
template <class Part>
void measure(benchmark::State& state, const DrapeState& drape, const Part& part) {
  double seconds = 0;
  for (auto _ : state) {
    const double start = now_s();
    part();
    seconds += now_s() - start;
  }
  state.counters["per_factorization"] =
      benchmark::Counter(seconds / drape.factor_s, benchmark::Counter::kAvgIterations);
}

void symbolic_analysis(benchmark::State& state) {
  DrapeState& drape = drape_of(state);
  const ReducedSystem& matrix = drape.system().solved();
  double seconds = 0;
  for (auto _ : state) {
    CholmodFactor factor;
    factor.factorize(matrix);
    state.SetIterationTime(factor.analyze_s());
    seconds += factor.analyze_s();
  }
  state.counters["per_factorization"] =
      benchmark::Counter(seconds / drape.factor_s, benchmark::Counter::kAvgIterations);
}

void numeric_factorization(benchmark::State& state) {
  DrapeState& drape = drape_of(state);
  const ReducedSystem& matrix = drape.system().solved();
  CholmodFactor factor;
  factor.factorize(matrix);
  measure(state, drape, [&] { factor.factorize(matrix); });
  state.counters["nonzeros"] = static_cast<double>(matrix.lower.nonZeros());
  state.counters["factor_nonzeros"] = factor.factor_nonzeros();
  state.counters["flops"] = factor.factor_flops();
}

void triangular_solve(benchmark::State& state) {
  DrapeState& drape = drape_of(state);
  CholmodFactor factor;
  factor.factorize(drape.system().solved());
  const VecXd b = VecXd::LinSpaced(drape.system().n_free(), -1, 1);
  VecXd x;
  measure(state, drape, [&] { factor.solve(b, x); });
}

/// Elements, contact terms, gradient and matrix at a state whose contact pattern is known,
/// and its restriction.
void assembly(benchmark::State& state) {
  DrapeState& drape = drape_of(state);
  measure(state, drape, [&] {
    drape.system().assemble();
    benchmark::DoNotOptimize(&drape.system().solved());
  });
  state.counters["rows"] = static_cast<double>(drape.n_rows());
}

void broad_phase(benchmark::State& state) {
  DrapeState& drape = drape_of(state);
  measure(state, drape, [&] { drape.system().prepare(drape.x1, drape.dx); });
  const ContactSystem::Counts counts = term_of<ContactTerm>(drape).contacts().candidate_counts();
  state.counters["candidates"] =
      static_cast<double>(counts.point_triangle + counts.edge_edge + counts.obstacle);
}

void drape_bound(benchmark::State& state) {
  DrapeState& drape = drape_of(state);
  drape.system().prepare(drape.x1, drape.dx);
  IterateNumbers report;
  measure(state, drape, [&] { bound_of<ContactTerm>(drape, report); });
  state.counters["accd_queries"] = static_cast<double>(report.bound.queries);
  state.counters["probes"] = static_cast<double>(report.bound.probes);
}

void drape_strain_bound(benchmark::State& state) {
  DrapeState& drape = drape_of(state);
  IterateNumbers report;
  measure(state, drape, [&] { bound_of<StrainLimitTerm>(drape, report); });
  state.counters["alpha"] = report.alpha_strain;
}

/// A trial of the line search: rows, kappa and every energy at the largest feasible step.
void energy_evaluation(benchmark::State& state) {
  DrapeState& drape = drape_of(state);
  NewtonSystem& system = drape.system();
  system.prepare(drape.x1, drape.dx);
  IterationReport report;
  const double alpha = system.bound(drape.x1, drape.dx, report);
  const Positions trial = system.x() + 0.5 * alpha * drape.dx;
  bool feasible = true;
  measure(state, drape, [&] { feasible = system.try_state(trial).has_value(); });
  if (!feasible) state.SkipWithError("the trial is not feasible");
}

/// Real iterations, one step of them: patterns change, trials are repeated. Every phase in seconds an
/// iteration, and all phases but the linear ones per factorisation. Moves the state on, so it comes last.
void newton_iteration(benchmark::State& state) {
  DrapeState& drape = drape_of(state);
  StepObserver nobody;
  StepReport report;
  for (auto _ : state) report = drape.simulation->step(nobody);
  const PhaseTimes& times = report.time;
  const double n = report.newton_iterations;
  const double linear_s =
      times[Phase::linear_analyze] + times[Phase::linear_factor] + times[Phase::linear_solve];
  for (std::size_t phase = 0; phase < kPhases; ++phase) {
    if (times.s[phase] > 0) state.counters[std::string(kPhaseNames[phase]) + "_s"] = times.s[phase] / n;
  }
  state.counters["iterations"] = n;
  state.counters["trials"] = static_cast<double>(report.line_search_trials) / n;
  state.counters["analyses"] = static_cast<double>(report.analyses) / n;
  state.counters["all_but_linear_per_factorization"] =
      (times.solve_s() - linear_s) / times[Phase::linear_factor];
}

}  // namespace

void register_drape() {
  const auto sizes = [](benchmark::internal::Benchmark* b) {
    return b->ArgName("n")->Arg(8)->Arg(48)->Unit(benchmark::kMillisecond);
  };
  sizes(benchmark::RegisterBenchmark("drape/symbolic_analysis", symbolic_analysis)->UseManualTime());
  sizes(add("drape/numeric_factorization", numeric_factorization));
  sizes(add("drape/triangular_solve", triangular_solve));
  sizes(add("drape/assembly", assembly));
  sizes(add("drape/broad_phase", broad_phase));
  sizes(add("drape/step_bound", drape_bound));
  sizes(add("drape/strain_bound", drape_strain_bound));
  sizes(add("drape/energy_evaluation", energy_evaluation));
  sizes(add("drape/newton_iteration", newton_iteration))->Iterations(1);
}

}  // namespace bb::bench
