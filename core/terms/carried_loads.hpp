// Loads of contacts at the end of a step, for terms that read them at the start of the next one (friction, restitution) where contact
// itself begins every step without them: its multipliers are those of one step.
#pragma once

#include <algorithm>
#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/contact/contact_loads.hpp"

namespace bb {

class CarriedLoads {
 public:
  /// The contacts of the end of a step.
  void take(const ContactLoads& contacts) {
    known_ = true;
    loads_.clear();
    for (std::size_t r = 0; r < contacts.size(); ++r) loads_.push_back({contacts.pair[r], contacts.load[r]});
    std::sort(loads_.begin(), loads_.end(), before);
  }
  /// The loads of the contacts of that state, from number `first` on; before the first end of a step they stay what they are.
  void give(std::size_t first, ContactLoads& contacts) const {
    for (std::size_t r = first; known_ && r < contacts.size(); ++r) {
      const Load wanted{contacts.pair[r], 0};
      const auto at = std::lower_bound(loads_.begin(), loads_.end(), wanted, before);
      contacts.load[r] = at != loads_.end() && at->pair == wanted.pair ? at->load : 0;
    }
  }
  void keep(Archive& archive) { archive(known_, loads_); }

 private:
  struct Load {
    PairId pair;
    double load;  // N
    void keep(Archive& archive) { archive(pair, load); }
  };
  static bool before(const Load& a, const Load& b) { return a.pair < b.pair; }

  bool known_ = false;
  std::vector<Load> loads_;  // ascending by pair
};

}  // namespace bb
