#include "core/resident/contact/resident_barrier.hpp"

#include <map>
#include <mutex>

#include "core/barrier/launches.hpp"
#include "core/math/error.hpp"
#include "core/resident/contact/given_shape.hpp"
#include "core/resident/contact/shape_kernels.hpp"

namespace bb::resident {
namespace {

/// There as long as the code, since executors remember what they launched.
const exec::KernelInfo& info_of(const DeviceCode& code) {
  static std::mutex mutex;
  static std::map<const DeviceCode*, exec::KernelInfo> known;
  const std::lock_guard lock(mutex);
  exec::KernelInfo info = exec::each_info<EvaluateGivenShape>();
  info.code = &code;
  return known.emplace(&code, info).first->second;
}

}  // namespace

ResidentBarrier::ResidentBarrier(const BarrierFunction& barrier, bool potential, bool host_calls)
    : potential_(potential), argument_(barrier.argument), shape_(barrier.shape) {
  if (barrier.literal) {
    throw ConfigError("shape", "the article's literal evaluation", "the CPU path");
  }
  if (barrier.in_float) throw ConfigError("/precision", "float", "double where the pipeline is resident");
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

void ResidentBarrier::prepare(exec::Executor& executor) const {
  if (given_) executor.prepare(*given_);
}

void ResidentBarrier::evaluate(exec::Executor& executor, ResidentRows& rows) const {
  const RowView view = rows.view();
  if (potential_) return shape_.launches->folded_rows(executor, view);
  if (shape_.launches) return shape_.launches->rows(executor, view, argument_);
  const EvaluateGivenShape given{view, argument_, shape_.batch_double, shape_.self, shape_.infinite_at_zero};
  if (given_) return executor.each(view.n, given, *given_);
  executor.each(view.n, given);
}

}  // namespace bb::resident
