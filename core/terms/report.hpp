// What terms say of an iterate and of the end of a step: plain numbers, the part of the reports of
// core/newton that terms fill. A number that no term fills keeps its value here.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "core/contact/contact_system.hpp"
#include "core/record/trace_row.hpp"

namespace bb {

/// How many iterations in a row something has held, after one more.
inline int in_a_row(int before, bool holds) { return holds ? before + 1 : 0; }

struct IterateNumbers {
  double alpha_ccd = 1, alpha_limit = 1;  // bounds of the step
  StepBound bound;                        // that of contact, with its pair and counters
  ContactCounts contacts;
  double gap_min = std::numeric_limits<double>::infinity();      // m; infinity without contacts
  double gap_min_rel = std::numeric_limits<double>::infinity();  // d/d_hat
  double kappa_min = 0, kappa_max = 0;                           // N/m
  /// Largest max/min - 1 of a contact's kappa, and of an active limited element's, since the line search
  /// before; 0 in iteration 0.
  double kappa_change = 0, limit_kappa_change = 0;
  double curvature_max = 0;      // N/m, largest m kappa b''
  double force_max = 0;          // N, largest kappa |b'| per unit multiplicity
  double max_stretch = 0;        // largest singular value of limited elements; 0 without
  double limit_gap_min_rel = 0;  // smallest distance of a limited element to its limit, over the width
  double limit_tension = 0;      // N/m, largest (1/area) dS_e/dsigma
};

struct StepNumbers {
  double kappa_change = 0, limit_kappa_change = 0;  // of the last iteration
  /// Last iterations in a row in which a contact's kappa, a limited element's, changed by more than 1 %.
  int kappa_unsettled = 0, limit_kappa_unsettled = 0;
  double alpha_ccd_min = 1;
  long long ccd_queries = 0, ccd_probes = 0, ccd_capped = 0, ccd_zero = 0;
  ContactCounts contacts;                                    // at the end of the step
  double gap_min = std::numeric_limits<double>::infinity();  // m
  double force_max = 0;          // N, largest kappa |b'| per unit multiplicity at the end of the step
  double limit_tension_max = 0;  // N/m, largest (1/area) dS_e/dsigma
  double max_stretch = 0;
  // of a step without progress: largest load / capacity over contact rows, and over limited elements; 0 when
  // the capacity is unbounded, absent when it was not measured
  std::optional<double> overload, limit_overload;

  /// Loads are measured from here on: 0 where no term says more.
  void begin_overload() { overload = limit_overload = 0; }
  /// Adds up what an iteration says.
  void add(const IterateNumbers& iterate);
  /// Names whose kappa still changes after so many iterations; empty when all have settled.
  std::string describe_unsettled(int iterations) const;
};

}  // namespace bb
