// What a step has frozen in another system, for a copy on the host whose state is looked at.
#pragma once

#include <string_view>
#include <vector>

#include "core/contact/contact_loads.hpp"
#include "core/contact/stiffness_update.hpp"

namespace bb {

/// Contacts that a term took from one state (lagged_contacts.hpp), of which it knows how strong each is.
struct KnownLag {
  std::string_view term;
  Positions lagged;              // m, the state
  double t = 0;                  // s, of it
  ContactLoads contacts;         // all of them
  std::vector<double> strength;  // [n contacts]
};

struct KnownStep {
  KnownStiffness stiffness;  // of pairs
  std::vector<KnownLag> lags;
};

}  // namespace bb
