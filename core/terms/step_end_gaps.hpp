// The gaps of pairs at two step ends in a row, for policies that adapt between steps.
#pragma once

#include <span>
#include <vector>

#include "core/barrier/stiffness_policy.hpp"
#include "core/contact/pair_id.hpp"

namespace bb {

/// Of a pair in a row at a step end.
struct PairGap {
  PairId pair;
  double gap, park;  // m; park: min_gap_fraction times d_hat of the row
  void keep(Archive& archive);
};

class StepEndGaps {
 public:
  /// A pair that has a row at this step end, in any order.
  void add(const PairGap& pair) { now_.push_back(pair); }
  /// The step is over: the pairs that were added and had a row at the end before, ascending by pair; valid until the next call.
  std::span<const StiffnessPolicy::PairEnd> end_step();
  void keep(Archive& archive);

 private:
  std::vector<PairGap> before_, now_;  // ascending by pair; those that were added
  std::vector<StiffnessPolicy::PairEnd> ends_;
};

}  // namespace bb
