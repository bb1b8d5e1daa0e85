#include "core/contact/executor/executor_barrier.hpp"

#include <map>
#include <mutex>

#include "core/barrier/launches.hpp"
#include "core/contact/executor/given_shape.hpp"
#include "core/contact/executor/shape_kernels.hpp"
#include "core/math/error.hpp"

namespace bb::exec {
namespace {

/// There as long as the code, since executors remember what they launched.
const KernelInfo& info_of(const DeviceCode& code) {
  static std::mutex mutex;
  static std::map<const DeviceCode*, KernelInfo> known;
  const std::lock_guard lock(mutex);
  KernelInfo info = each_info<EvaluateGivenShape>();
  info.code = &code;
  return known.emplace(&code, info).first->second;
}

}  // namespace

ExecutorBarrier::ExecutorBarrier(const BarrierFunction& barrier, bool potential, bool host_calls)
    : potential_(potential), argument_(barrier.argument), shape_(barrier.shape) {
  if (barrier.literal) {
    throw ConfigError("shape", "the article's literal evaluation", "the CPU path");
  }
  if (barrier.in_float) throw ConfigError("/precision", "float", "double on an executor");
  if (potential && argument_ != Argument::gap) {
    throw ConfigError("argument", "squared_gap with a potential", "gap");
  }
  if (shape_.launches && !(potential && !shape_.launches->folded_rows)) return;
  if (potential) {
    throw ConfigError("shape", "\"" + shape_.name + "\", which has no kernel of a potential",
                      "a shape of the program with a potential (cubic, quadratic)");
  }
  if (host_calls) return;
  if (!shape_.device_code) {
    throw ConfigError(
        "shape", "\"" + shape_.name + "\", which has no kernel of its own",
        "a shape that ./bench list shapes names, or a formula, on a card; shapes of plugins and "
        "other exponents run with device cpu or host");
  }
  given_ = &info_of(shape_.device_code(shape_, given_shape_layout));
}

void ExecutorBarrier::prepare(Executor& executor) const {
  if (given_) executor.prepare(*given_);
}

void ExecutorBarrier::evaluate(Executor& executor, ExecutorRows& rows) const {
  const RowView view = rows.view();
  if (potential_) return shape_.launches->folded_rows(executor, view);
  if (shape_.launches) return shape_.launches->rows(executor, view, argument_);
  const EvaluateGivenShape given{view, argument_, shape_.batch_double, shape_.self, shape_.infinite_at_zero};
  if (given_) return executor.each(view.n, given, *given_);
  executor.each(view.n, given);
}

}  // namespace bb::exec
