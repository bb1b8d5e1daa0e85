// E and its change between iterate and trial, summed over the parts of all terms.
#pragma once

#include <vector>

#include "core/newton/energy_change.hpp"
#include "core/terms/host_term.hpp"

namespace bb {

/// Parts of terms on vertices are summed vertex by vertex, then those of the others term by term, all in the
/// order of the list and in blocks of fixed size, so that a sum does not depend on the number of threads. Keeps
/// its buffers. Cost O(parts).
class EnergySums {
 public:
  /// From the iterate x0 to the trial x1.
  EnergyChange change(const TermList& terms, const PositionsView& x0, const PositionsView& x1);

 private:
  std::vector<EnergyParts> parts_;  // one a term
};

/// The terms of a set at the iterate, J, in the same order.
double total_energy(const TermList& terms, TermSet set);

}  // namespace bb
