// The linear module on a generated cloth grid with contacts: assembly, factorisation, every solver
// with every preconditioner.
#include <memory>
#include <vector>

#include "core/linear/block_system.hpp"
#include "core/linear/cholmod_factor.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "experiments/microbenchmarks/cloth_matrix.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

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

void assemble_cloth(benchmark::State& state) {
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
  state.counters["flop_per_s"] =
      benchmark::Counter(factor.factor_flops(), benchmark::Counter::kIsIterationInvariantRate);
}

void solve(benchmark::State& state, const std::string& name, const std::string& preconditioner) {
  const Cloth cloth(static_cast<int>(state.range(0)));
  const auto s = cloth.system();
  s->set_contacts({cloth.contacts_a.stencils()});
  const ReducedSystem& system = cloth.assemble(*s, cloth.contacts_a);
  LinearOptions options;
  options.name = name;
  options.parameters = {{"forcing", "fixed"}, {"tol_rel", 1e-6}};
  set_preconditioner(linear_solvers().require(name, "solver"), preconditioner, options.parameters);
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

void register_sizes(const std::string& name, void (*run)(benchmark::State&)) {
  add(name, run)->ArgName("side")->Arg(16)->Arg(107)->Unit(benchmark::kMillisecond);
}

}  // namespace

void register_linear() {
  register_sizes("linear/set_elements", set_elements);
  register_sizes("linear/set_contacts", set_contacts);
  register_sizes("linear/assemble", assemble_cloth);
  register_sizes("linear/cholmod_analyze_and_factorize", cholmod_analyze_and_factorize);
  register_sizes("linear/cholmod_refactorize", cholmod_refactorize);
  for (const LinearSolverEntry& solver : linear_solvers()) {
    if (!missing_for(solver.name).empty()) continue;
    for (const std::string& label : preconditioner_choices(solver)) {
      const std::string& name = solver.name;
      add("linear/solve/" + name + (preconditioner_parameter(solver) ? "/" + label : ""),
          [name, label](benchmark::State& state) { solve(state, name, label); })
          ->ArgName("side")
          ->Arg(16)
          ->Arg(107)
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace bb::bench
