// Terms evaluated as the Newton step evaluates them.
#pragma once

#include "core/terms/term.hpp"

namespace bb::test {

/// Whether a trial of the iterate x is feasible.
inline bool is_feasible(Term& term, const PositionsView& x, const PositionsView& trial, PhaseClock& clock) {
  term.look_at(x, trial, clock);
  return term.is_feasible(trial, clock);
}

inline double bound(Term& term, const Motion& motion, IterateNumbers& out, PhaseClock& clock) {
  term.look_along(motion, clock);
  return term.bound(motion, out, clock);
}

}  // namespace bb::test
