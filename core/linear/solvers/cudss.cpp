// The linear solver cudss: a Cholesky factor on a card (core/linear/cudss).
#include "core/linear/cudss/cudss.hpp"
#include "core/linear/solvers/linear_solvers.hpp"

namespace bb {

LinearSolverEntry linear_solver_cudss() {
  LinearSolverEntry entry;
  entry.matrix = MatrixPlace::card;
  entry.missing = &cudss::missing;
  entry.make = [](const ParameterMap&) { return cudss::make_solver(); };
  return entry;
}

}  // namespace bb
