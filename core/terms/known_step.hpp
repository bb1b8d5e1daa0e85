// What a step has frozen in another system, for a copy on the host whose state is looked at.
#pragma once

#include <string_view>
#include <vector>

#include "core/contact/pair_id.hpp"
#include "core/contact/stiffness_update.hpp"

namespace bb {

/// The rows that a term took from the contacts of one state (lagged_family.hpp); columns as there.
struct LaggedState {
  std::string_view term;
  std::vector<double> lagged;  // [3 n_vertices] m, the state
  std::vector<int> vertex;
  std::vector<double> weight, normal;
  std::vector<PairId> pair;
  std::vector<double> load, strength;
  bool loads_known = false;
  std::vector<double> kept;  // what its kind keeps besides
};

struct KnownStep {
  KnownStiffness stiffness;  // of pairs
  std::vector<LaggedState> lagged;
};

}  // namespace bb
