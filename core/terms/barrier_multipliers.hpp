// Multipliers beside the barrier, after Guo et al. 2024 (Barrier-Augmented Lagrangian for GPU-based Elastodynamic Contact): of
// the pairs of an augmentation set A' a force mu >= 0 (N) beside sigma b, sigma the stiffness times a factor s,
//
//   E gets  sigma sum_A b(d) + sum_A' (mu w(d) + sigma b(d)),   A' within A,
//   w = d_hat - d but for a constant where d is small,
//
// fixed until the next update, which follows an iterate that was accepted:
//   all gaps >= release d_hat:          A' is empty again, and all mu are 0;
//   some gap < near d_hat:              where it is smaller than at the last iterate, or A' is empty, pairs below near d_hat
//                                       join A'; mu := mu + sigma |b'(d)| of those in A', s := min(growth s, growth_most).
// At the start of a step A' is empty and s = 1.
// Otherwise than there:
// - their mu grows by sigma b, which is no force for a b in m^2; here it is the first-order update, by the force that the
//   barrier of A' carries, after which the sum of both is what it was;
// - their slack ends the force mu at a gap of d_hat + mu/sigma, with a jump; here it fades to 0 from d_hat/2 to d_hat (Fade),
//   so that E is C1 and pairs beyond d_hat need no row;
// - their sigma begins where the gradient of E is the smallest; here it is that of the run's stiffness policy (one of them,
//   ipc_adaptive, begins so), so that runs with and without multipliers end in the same minimum where A' ends empty;
// - release is theirs in words ("large enough"); 0.1 is ours. Once s is growth_most A' is kept for the rest of the step.
#pragma once

#include <vector>

#include "core/contact/contact_table.hpp"

namespace bb {

struct BarrierMultiplierRules {
  double near = 1e-2;        // d_hat, gap below which pairs join A'
  double release = 0.1;      // d_hat, smallest gap from which A' is emptied
  double growth = 1.2;       // of s
  double growth_most = 100;  // largest s
};

/// What became of the multipliers in a step.
struct BarrierMultiplierCounts {
  double updates = 0, releases = 0;
  double pairs_most = 0;  // of A'
  double force_N = 0;     // largest mu at the last iterate
  double stiffening = 1;  // s at the last iterate
};

/// Of w(d): [m], 1, 1/m. 1/2 (d_hat - d)^2/(d_hat/2) where d is above d_hat/2; below it goes on with the slope -1.
struct Fade {
  double value, slope, curvature;
};
Fade fade(double d, double d_hat);

class BarrierMultipliers {
 public:
  explicit BarrierMultipliers(const BarrierMultiplierRules& rules) : rules_(rules) {}

  /// A' is empty, s = 1.
  void begin_step();
  /// What another object holds of the step that both are in.
  void adopt(const BarrierMultipliers& other);
  /// b, b', b'' of every row, which have those of the barrier: kappa times them is the energy above and its derivatives
  /// then. Rows without kappa stay as they are.
  template <class Table>
  void add(Table& rows) const;
  /// After an iterate with these rows, whose b' is that of add(). @return whether E has changed.
  bool update(const ContactTable& rows, const MollifiedTable& mollified);

  const BarrierMultiplierCounts& counts() const { return counts_; }

 private:
  struct Entry {
    PairId pair;
    double force;  // N
  };
  const Entry* find(const PairId& pair) const;
  template <class Table>
  void collect(const Table& rows, bool join);

  BarrierMultiplierRules rules_;
  double scale_ = 1;            // s
  double gap_before_ = 0;       // d_hat, smallest at the last iterate
  std::vector<Entry> entries_;  // of A', ascending by pair
  std::vector<Entry> next_;     // those of the update that is under way
  BarrierMultiplierCounts counts_;
};

}  // namespace bb
