#include "experiments/run/linear_choice.hpp"

#include <fmt/format.h>

#include "core/linear/solvers/linear_solvers.hpp"
#include "experiments/config/parse.hpp"

namespace bb {
namespace {

constexpr std::size_t fewest_unknowns_of_pcg = 1000;

}  // namespace

void decide_linear_solver(RunConfig& config) {
  if (config.linear_solver.name != linear_solver_auto) return;
  const std::size_t unknowns = free_dofs(build_scene(config));
  config.linear_solver.name = unknowns < fewest_unknowns_of_pcg ? "lagged_cholesky" : "pcg";
  config.linear_solver_reason =
      fmt::format("by auto: {} unknowns; lagged_cholesky has fewer than {}, pcg those or more", unknowns,
                  fewest_unknowns_of_pcg);
}

RunConfig load_run(const std::string& path, std::span<const std::string> overrides) {
  RunConfig config = load_config(path, overrides);
  decide_linear_solver(config);
  return config;
}

}  // namespace bb
