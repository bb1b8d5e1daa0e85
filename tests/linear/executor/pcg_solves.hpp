// How the tests of conjugate gradients on an executor solve a system: there, and by pcg of the host.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/linear/executor/block_jacobi.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "tests/executor/tested_executor.hpp"
#include "tests/linear/executor/linear_cases.hpp"

namespace bb::exec::pcg_solves {

using test::TestedExecutor;

struct Solved {
  LinearReport report;
  VecXd x;
  Index fault;
};

struct How {
  Order order = Order::threads;
  bool split = false, plainly = false;
  double tolerance = 1e-11;
  int cap = 10000;
};

inline Solved solve(const ReducedSystem& system, const VecXd& b, const std::vector<FixedMask>& fixed,
                    How how) {
  TestedExecutor executor(how.order);
  const OwnedSystem owned(executor, system, fixed, how.split);
  Buffer<double> rhs(executor, "b"), x(executor, "x", 3 * owned.n());
  rhs.upload(plain(b));
  ExecutorPcg pcg(executor, owned.n(), std::make_unique<BlockJacobi>(executor));
  pcg.launch_plainly(how.plainly);
  Solved out;
  out.report = pcg.solve(owned.matrix(), owned.fixed.data(), rhs.data(), x.data(), how.tolerance, how.cap);
  out.fault = pcg.fault();
  const std::vector<double> numbers = x.download();
  out.x = Eigen::Map<const VecXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
  return out;
}

inline LinearReport host_pcg(const ReducedSystem& system, const VecXd& b, double tolerance, VecXd& x,
                             int cap = 10000) {
  LinearOptions options;
  options.name = "pcg";
  options.parameters = {{"preconditioner", std::string("block_jacobi")},
                        {"forcing", std::string("fixed")},
                        {"tol_rel", tolerance},
                        {"max_iterations", std::int64_t{cap}}};
  return make_linear_solver(options)->solve(system, b, x);
}

}  // namespace bb::exec::pcg_solves
