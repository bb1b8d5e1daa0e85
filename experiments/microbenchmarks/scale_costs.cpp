// scale_costs CONFIG STEPS: runs steps of a config on a host executor that counts, and prints one line of JSON a Newton
// iteration: launches, sorts, waits and allocations outside conjugate gradients, candidates and rows. What one
// iteration costs a card besides its kernels, measured without one.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "core/exec/metered_executor.hpp"
#include "core/linear/executor/solver_launches.hpp"
#include "core/newton/executor/executor_engine.hpp"
#include "core/step_solvers/simulation.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/calibration.hpp"

namespace {

using namespace bb;

/// Prints what was required of the executor since the last iteration.
class Printer final : public StepObserver {
 public:
  exec::MeteredExecutor* executor = nullptr;
  bool watches_motions() const override { return false; }
  void on_iteration(const IterationReport& report) override {
    const exec::ExecutionCounts& c = executor->counts();
    const exec::Index of_solver = exec::solver_launches(c), launches = c.launches - of_solver,
                      candidates = c.items("FillRows");
    std::printf("{\"step\": %d, \"iteration\": %d, \"launches\": %lld, \"solver_launches\": %lld, ",
                report.step, report.iteration, static_cast<long long>(launches),
                static_cast<long long>(c.replayed + of_solver));
    std::printf(
        "\"sorts\": %lld, \"scans\": %lld, \"downloads\": %lld, \"uploads\": %lld, \"graphs\": %lld, "
        "\"allocations\": %lld, ",
        static_cast<long long>(c.sorts), static_cast<long long>(c.scans), static_cast<long long>(c.downloads),
        static_cast<long long>(c.uploads), static_cast<long long>(c.graphs),
        static_cast<long long>(c.allocations));
    std::printf("\"candidates\": %lld, \"rows\": %zu}\n", static_cast<long long>(candidates),
                report.contacts.total());
    if (std::getenv("SCALE_COSTS_KERNELS")) print_kernels(c);
    executor->clear();
  }

 private:
  static void print_kernels(const exec::ExecutionCounts& counts) {
    for (const auto& [name, of] : counts.by_kernel) {
      std::fprintf(stderr, "%4lld %10lld  %s\n", static_cast<long long>(of.launches),
                   static_cast<long long>(of.items), name.c_str());
    }
  }
};

int run(const std::string& path, int steps) {
  const RunConfig config = load_config(path);
  const Scene scene = build_scene(config);
  MatchingRecord record;
  Method method = make_method(config, calibrate(config, scene, RunOptions{}, record));
  Printer printer;
  method.make_potential = [&printer](const Scene& of, Method& with, const Plan& plan,
                                     const std::vector<std::uint8_t>& fixed, PhaseClock& clock) {
    auto executor = std::make_unique<exec::MeteredExecutor>();
    printer.executor = executor.get();
    return std::make_unique<exec::ExecutorEngine>(std::move(executor), of, with, plan, fixed, clock);
  };
  Simulation simulation(scene, method, config.time.dt, steps);
  for (int i = 0; i < steps; ++i) simulation.step(printer);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: scale_costs CONFIG STEPS\n", stderr);
    return 2;
  }
  try {
    return run(argv[1], std::atoi(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
