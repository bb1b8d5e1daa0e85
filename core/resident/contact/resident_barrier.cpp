#include "core/resident/contact/resident_barrier.hpp"

#include <map>
#include <mutex>

#include "barriers/shapes/shape_list.hpp"
#include "core/math/error.hpp"
#include "core/resident/contact/given_shape.hpp"
#include "core/resident/contact/shape_kernels.hpp"

namespace bb::resident {
namespace {

template <class S>
void launch_shape(exec::Executor& executor, const RowView& rows, Argument argument) {
  executor.each(rows.n, EvaluateShape<S>{rows, argument});
}
template <class S>
void launch_folded(exec::Executor& executor, const RowView& rows, Argument) {
  executor.each(rows.n, EvaluateFoldedShape<S>{rows});
}

using Launch = void (*)(exec::Executor&, const RowView&, Argument);
struct Entry {
  std::string_view name;
  Launch launch;
};
#define BB_ENTRY(name, S) {#name, &launch_shape<shapes::S>},
constexpr Entry plain[] = {BB_FOR_EACH_SHAPE(BB_ENTRY)};
#undef BB_ENTRY
#define BB_ENTRY(name, S) {#name, &launch_folded<shapes::S>},
constexpr Entry folded[] = {BB_FOR_EACH_FOLDED_SHAPE(BB_ENTRY)};
#undef BB_ENTRY

// In case a shape and its list disagree.
#define BB_ENTRY(name, S) static_assert(shapes::HasPotential<shapes::S>);
BB_FOR_EACH_FOLDED_SHAPE(BB_ENTRY)
#undef BB_ENTRY

/// Null where there is none and the shape may be called or has device code of its own. also: what else would do.
template <std::size_t n>
Launch find(const Entry (&entries)[n], const std::string& name, const char* what, bool otherwise,
            const char* also) {
  std::string names;
  for (const Entry& entry : entries) {
    if (entry.name == name) return entry.launch;
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  }
  if (otherwise) return nullptr;
  throw ConfigError("shape", "\"" + name + "\", which has no kernel " + what, "one of " + names + also);
}

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
    : argument_(barrier.argument), shape_(barrier.shape) {
  if (barrier.literal) {
    throw ConfigError("shape", "the article's literal evaluation", "the CPU path");
  }
  if (barrier.in_float) throw ConfigError("/precision", "float", "double where the pipeline is resident");
  if (potential && argument_ != Argument::gap) {
    throw ConfigError("argument", "squared_gap with a potential", "gap");
  }
  const bool own_code = barrier.shape.device_code && !host_calls;
  launch_ = potential ? find(folded, barrier.shape.name, "of a potential", false, "")
                      : find(plain, barrier.shape.name, "of its own", host_calls || own_code,
                             ", or a formula, on a card; shapes of plugins and other exponents run with "
                             "device cpu or host");
  if (launch_ || !own_code) return;
  given_ = &info_of(barrier.shape.device_code(barrier.shape, given_shape_layout));
}

void ResidentBarrier::prepare(exec::Executor& executor) const {
  if (given_) executor.prepare(*given_);
}

void ResidentBarrier::evaluate(exec::Executor& executor, ResidentRows& rows) const {
  const RowView view = rows.view();
  if (launch_) return launch_(executor, view, argument_);
  const EvaluateGivenShape given{view, argument_, shape_.batch_double, shape_.self, shape_.infinite_at_zero};
  if (given_) return executor.each(view.n, given, *given_);
  executor.each(view.n, given);
}

}  // namespace bb::resident
