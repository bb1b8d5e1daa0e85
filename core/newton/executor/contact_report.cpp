// What contact in an executor's memory says of a state, numbers of rows in one pass, and what it remembers from step to step.
#include "core/base/archive/archive.hpp"
#include "core/newton/executor/executor_contact.hpp"
#include "core/terms/known_step.hpp"
#include "core/terms/row_report.hpp"

namespace bb::exec {

void ExecutorContact::report(const PositionsView& x, IterateNumbers& out, PhaseClock&) {
  out.kappa_change_rel = says_change_ ? stiffness_.change() : 0;
  if (rows(x).size() > 0) report_rows(totals(x), rows_.min_gap, out);
}

void ExecutorContact::report_end(const PositionsView& x, StepNumbers& out, PhaseClock&) {
  if (rows(x).size() == 0) return;
  report_rows(totals(x), rows_.min_gap, vectors_.max(x), Precision::full, out);
  const HostRows of = rows_.on_host();
  out.contact_loads.clear();
  for (std::size_t r = 0; r < of.size(); ++r) {
    if (of.kind[r] != mollified_kind) add_load(of.key(r), of.d[r] / of.d_hat[r], -of.force[r], out);
  }
}

void ExecutorContact::add_known(KnownStep& out) const { out.stiffness = stiffness_.known(); }

// As ContactTerm::keep, which reads it.
void ExecutorContact::keep(Archive& archive) {
  bool started = policy_start_.started();
  archive(started);
  policy_start_.set_started(started);
  gaps_.keep(archive);
  options_.stiffness->keep(archive);
}

}  // namespace bb::exec
