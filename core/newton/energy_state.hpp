// The terms of E at one state, kept apart so that two states are compared term by term: a difference of large
// sums would lose the decrease that the line search looks for.
#pragma once

#include <vector>

#include "core/contact/contact_system.hpp"
#include "core/math/types.hpp"

namespace bb {

struct EnergyState {
  Positions x;                               // [3 x n] m
  std::vector<std::vector<double>> element;  // per family, [n elements] J
  std::vector<double> limit;                 // [n elements] J
  ContactTable rows;
  MollifiedTable mollified;
  std::vector<double> contact, mollified_contact;  // per row, J
  double gap_min = 0;                              // m; infinity without rows
  bool feasible = true;                            // every gap and every limit margin is > 0
};

/// What the inertia and load terms need; all of one step.
struct StepTerms {
  Positions x_n, x_tilde;       // [3 x n] m
  std::vector<double> inertia;  // [n] m_i / (c h^2), N/m; 0 for prescribed vertices and when quasi-static
  Positions force;              // [3 x n] N
};

struct EnergyChange {
  double change = 0;     // E(to) - E(from), J
  double magnitude = 0;  // sum of |terms|, J: rounding noise is some multiple of eps times this
};

/// E(to) - E(from) with the kappa that stands in the rows of each. Cost O(vertices + elements + rows), no
/// allocation.
EnergyChange energy_change(const StepTerms& terms, const EnergyState& from, const EnergyState& to);

/// E itself, J; for the record only.
double total_energy(const StepTerms& terms, const EnergyState& state);

}  // namespace bb
