// A barrier of the registry on an executor.
#pragma once

#include "core/barrier/shape.hpp"
#include "core/exec/executor.hpp"
#include "core/resident/contact/resident_rows.hpp"

namespace bb::resident {

class ResidentBarrier {
 public:
  /// potential: whether kappa depends on the gap and is folded in. Errors: ConfigError for a shape without kernels
  /// (plugins have none), for the article's literal evaluation, for float, and for a potential that the shape has not.
  ResidentBarrier(const BarrierFunction& barrier, bool potential);
  /// Fills energy, push and stretch of the rows from d, d_hat and kappa.
  void evaluate(exec::Executor& executor, ResidentRows& rows) const;

 private:
  using Launch = void (*)(exec::Executor&, const RowView&, Argument);
  Launch launch_ = nullptr;
  Argument argument_;
};

}  // namespace bb::resident
