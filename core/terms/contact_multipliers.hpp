// Contact as inequalities d >= 0 with multipliers, after the augmented Lagrangian of the library jaxls (its module
// _augmented_lagrangian, after ALGENCAN: Birgin and Martinez 2014): of each pair a force lambda >= 0 (N) and a penalty rho
// (N/m), fixed while E is minimised, and updated where it has been:
//
//   E gets rho/2 max(0, lambda/rho - d)^2;   lambda := max(0, lambda - rho d);
//   rho := factor rho where max(0, -d) is more than `reduction` times what it was at the update before
//
// until both max(0, -d) and |min(d, lambda)| are below the tolerance (their second one has the number of a force beside that
// of a length, as published). At the start of a step lambda = 0 and rho = 10 max(1, 2 E) for E of inertia and elasticity there,
// a rule of theirs that goes with the units.
// Otherwise than there: only pairs within d_hat have a row, so rho is kept at lambda/d_hat at least, and E is continuous.
#pragma once

#include <vector>

#include "core/contact/contact_table.hpp"

namespace bb {

struct MultiplierRules {
  double initial = 0;          // N/m of a pair that is new; 0: 10 max(1, 2 E)
  double factor = 4;           // of rho, where the violation does not shrink
  double largest = 1e7;        // N/m, of rho
  double largest_force = 1e7;  // N, of lambda: their lambda_max
  double reduction = 0.5;      // of the violation from update to update, else rho grows
  double tolerance_m = 1e-6;   // m, and N in the place of it
};

class ContactMultipliers {
 public:
  explicit ContactMultipliers(const MultiplierRules& rules) : rules_(rules) {}

  /// Forgets all pairs.
  void begin_step();
  /// rho of pairs that are new from here on, from E (J) at the start of the step, if the rules do not give it.
  void set_scale(double energy);
  /// kappa = rho, and b, b', b'' of every row of a table at its d: kappa b is its energy. Pairs that are not known have
  /// lambda = 0.
  template <class Table>
  void fill(Table& rows) const;
  /// The minimum for these multipliers is reached, with these rows: updates both, unless they are within the tolerance.
  /// @return whether they were updated.
  bool update(const ContactTable& rows, const MollifiedTable& mollified);
  /// Times that they were updated in the step.
  int updates() const { return updates_; }

 private:
  struct Entry {
    PairId pair;
    double force, penalty, violation;  // N, N/m, m at the last update
  };
  const Entry* find(const PairId& pair) const;
  template <class Table>
  void collect(const Table& rows);
  Entry updated(const Entry& before, double d, double d_hat) const;

  MultiplierRules rules_;
  double penalty_ = 10;         // N/m, of new pairs
  std::vector<Entry> entries_;  // ascending by pair
  std::vector<Entry> next_;     // those of the update that is under way
  double off_ = 0;              // m or N, largest of what has to be within the tolerance
  int updates_ = 0;
};

}  // namespace bb
