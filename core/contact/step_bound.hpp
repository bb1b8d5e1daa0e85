// The largest step along a straight motion that is proven free of contact.
#pragma once

#include "core/contact/candidates.hpp"
#include "core/contact/contact_table.hpp"

namespace bb {

/// Largest step alpha in [0, 1] along x0 -> x1 that is proven free of contact below the stop level.
struct StepBound {
  double alpha = 1;
  ContactKind kind = ContactKind::obstacle;  // of the limiting pair; key below
  ContactKey key{-1, -1, -1, -1};
  long long queries = 0, probes = 0, capped = 0, zero = 0;  // ACCD pairs asked, probes, cap hits, toi == 0
};

/// Where ACCD stops.
struct StopLevel {
  double park;     // in units of d_hat
  int max_probes;  // of one pair
};

/// Of all candidates; the earliest contact limits, on a tie the first in their order. Both motions finite.
StepBound find_step_bound(const Surface& surface, const std::vector<AnalyticSurface<double>>& obstacles,
                          const Candidates& candidates, const Positions& x0, const Positions& x1,
                          const StopLevel& level);

}  // namespace bb
