// A barrier of the registry on an executor.
#pragma once

#include "core/barrier/shape.hpp"
#include "core/contact/executor/executor_rows.hpp"
#include "core/exec/executor.hpp"

namespace bb::exec {

class ExecutorBarrier {
 public:
  /// potential: whether kappa depends on the gap and is folded in. host_calls: columns are in the host's memory, so that a
  /// shape without a kernel (of a plugin, of a formula, with an exponent) is called for every row. Elsewhere it needs device
  /// code of its own. Errors: ConfigError where it has none, for the article's literal evaluation, for float, and for a
  /// potential that the shape has not.
  ExecutorBarrier(const BarrierFunction& barrier, bool potential, bool host_calls = false);
  /// Fills energy, force and stiffness of the rows from d, d_hat and kappa.
  void evaluate(Executor& executor, ExecutorRows& rows) const;
  /// Loads device code that the shape brings, so that nothing has begun when it cannot be. Errors: ExecutionError.
  void prepare(Executor& executor) const;

 private:
  bool potential_;
  const KernelInfo* given_ = nullptr;  // of a shape without launches: its device code; null: its calls
  Argument argument_;
  Shape shape_;
};

}  // namespace bb::exec
