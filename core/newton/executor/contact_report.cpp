// What contact in an executor's memory reports of its rows, numbers of all rows in one pass.
#include "core/newton/executor/executor_contact.hpp"
#include "core/terms/known_step.hpp"

namespace bb::exec {

RowTotals ExecutorContact::totals(const PositionsView& x) {
  if (rows(x).size() == 0) return RowTotals::zero();
  look_at_rows(x);
  return totals_.get();
}

void ExecutorContact::visit_rows(const PositionsView& x, const std::function<void(const EndRow&)>& f) {
  const HostRows of = rows(x).on_host();
  for (std::size_t r = 0; r < of.size(); ++r)
    f({of.pair[r], of.key(r), of.d[r], of.d_hat[r], -of.force[r], of.kind[r] == mollified_kind});
}

void ExecutorContact::add_known(KnownStep& out) const { out.stiffness = stiffness_.known(); }

}  // namespace bb::exec
