#include "experiments/run/pcg_probe.hpp"

#include <random>

#include "core/linear/solvers/linear_solvers.hpp"

namespace bb {

PcgProbe::PcgProbe(std::uint64_t seed) : seed_(seed) {
  LinearOptions options;
  options.name = "pcg";
  options.parameters = {{"preconditioner", "block_jacobi"}, {"forcing", "fixed"}, {"tol_rel", 1e-6}};
  solver_ = make_linear_solver(options);
}

Number PcgProbe::iterations(const ReducedSystem& system) {
  if (b_.size() != system.lower.rows()) {
    std::mt19937_64 random(seed_);
    b_.resize(system.lower.rows());
    for (double& value : b_) value = static_cast<double>(random() >> 11) * 0x1p-52 - 1;  // in [-1, 1)
  }
  const LinearReport report = solver_->solve(system, b_, x_);
  if (report.status != LinearStatus::ok)
    return Number::missing(to_string(report.status).data());  // a literal
  return Number(report.iterations);
}

}  // namespace bb
