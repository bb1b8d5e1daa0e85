// What terms report of an iterate and of the end of a step: the part of the trace row and of the step's record
// that they fill. A number that no term fills is absent: there are no contacts, there is no limit.
#pragma once

#include <string>
#include <vector>

#include "core/base/record/step_record.hpp"
#include "core/contact/contact_system.hpp"

namespace bb {

/// How many iterations in a row something has held, after one more.
inline int in_a_row(int before, bool holds) { return holds ? before + 1 : 0; }

struct IterateNumbers : TraceRow {
  StepBound bound;  // that of contact, with its pair and counters

  IterateNumbers();
  /// In the first iteration of a step kappa has not changed yet.
  void forget_changes();
};

/// A contact without mollifier that carries a load.
struct ContactLoad {
  ContactKey key;
  double gap_rel = 0;  // d/d_hat
  double load_N = 0;   // kappa |b'| > 0
};

struct StepNumbers : StepRecord {
  double kappa_change = 0, limit_kappa_change = 0;  // of the last iteration, max/min - 1
  /// Last iterations in a row in which a contact's kappa, a limited element's, changed by more than 1 %.
  int kappa_unsettled = 0, limit_kappa_unsettled = 0;
  std::string contact_overload_at,
      limit_overload_at;                   // the pair, the element, with the largest; may be empty
  std::vector<ContactLoad> contact_loads;  // at its end

  StepNumbers();
  /// Loads are measured from here on: 0 where no term reports more.
  void begin_overload() { contact_overload = limit_overload = 0; }
  /// Adds up what an iteration says.
  void add(const IterateNumbers& iterate);
  /// After report_end, with the status known: the last state counts among the iterates, and gaps and loads
  /// that a step of this status does not have say why.
  void close();
  /// Names whose kappa still changes after the last iteration; empty when all have settled.
  std::string describe_unsettled() const;
};

}  // namespace bb
