#include "core/resident/contact/resident_barrier.hpp"

#include "barriers/shapes/shape_list.hpp"
#include "core/math/error.hpp"
#include "core/resident/contact/shape_kernels.hpp"

namespace bb::resident {
namespace {

/// EvaluateShape of a shape that is known as a batch call alone: of a plugin, of a formula. It runs in the memory of the host, so
/// kernels.inc has no line of it.
struct EvaluateGivenShape {
  RowView rows;
  Argument argument;
  ShapeBatch<double> call;
  void* self;
  bool infinite_at_zero;
  void operator()(Index r) const {
    const double d = rows.d[r], d_hat = rows.d_hat[r];
    ShapeTerms<double> terms{};
    if (argument == Argument::gap) {
      call(self, 1, &d, &d_hat, &terms.b, &terms.db, &terms.d2b);
    } else {
      const double d_sq = d * d, d_hat_sq = d_hat * d_hat;
      call(self, 1, &d_sq, &d_hat_sq, &terms.b, &terms.db, &terms.d2b);
      chain_squared_gap(infinite_at_zero, d, d_sq, d_hat_sq, terms.b, terms.db, terms.d2b);
    }
    const double kappa = rows.kappa ? rows.kappa[r] : rows.uniform_kappa;
    rows.energy[r] = kappa * terms.b;
    rows.push[r] = kappa * terms.db;
    rows.stretch[r] = kappa * terms.d2b;
  }
};

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

template <std::size_t n>
Launch find(const Entry (&entries)[n], const std::string& name, const char* what, bool host_calls) {
  std::string names;
  for (const Entry& entry : entries) {
    if (entry.name == name) return entry.launch;
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  }
  if (host_calls) return nullptr;
  throw ConfigError(
      "shape", "\"" + name + "\", which has no kernel " + what,
      "one of " + names +
          " on a card; shapes of plugins, formulas and other exponents run with device cpu or host");
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
  launch_ = potential ? find(folded, barrier.shape.name, "of a potential", false)
                      : find(plain, barrier.shape.name, "of its own", host_calls);
}

void ResidentBarrier::evaluate(exec::Executor& executor, ResidentRows& rows) const {
  const RowView view = rows.view();
  if (launch_) return launch_(executor, view, argument_);
  executor.each(
      view.n, EvaluateGivenShape{view, argument_, shape_.batch_double, shape_.self, shape_.infinite_at_zero});
}

}  // namespace bb::resident
