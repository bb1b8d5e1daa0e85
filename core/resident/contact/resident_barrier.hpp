// A barrier of the registry on an executor.
#pragma once

#include "core/barrier/shape.hpp"
#include "core/exec/executor.hpp"
#include "core/resident/contact/resident_rows.hpp"

namespace bb::resident {

class ResidentBarrier {
 public:
  /// potential: whether kappa depends on the gap and is folded in. host_calls: columns are in the host's memory, so that a
  /// shape without a kernel (of a plugin, of a formula, with an exponent) is called for every row. Elsewhere it needs device
  /// code of its own. Errors: ConfigError where it has none, for the article's literal evaluation, for float, and for a
  /// potential that the shape has not.
  ResidentBarrier(const BarrierFunction& barrier, bool potential, bool host_calls = false);
  /// Fills energy, force and stiffness of the rows from d, d_hat and kappa.
  void evaluate(exec::Executor& executor, ResidentRows& rows) const;
  /// Loads device code that the shape brings, so that nothing has begun when it cannot be. Errors: ExecutionError.
  void prepare(exec::Executor& executor) const;

 private:
  bool potential_;
  const exec::KernelInfo* given_ = nullptr;  // of a shape without launches: its device code; null: its calls
  Argument argument_;
  Shape shape_;
};

}  // namespace bb::resident
