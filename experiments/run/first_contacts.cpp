#include "experiments/run/first_contacts.hpp"

#include <algorithm>
#include <limits>

#include "core/archive/archive.hpp"

namespace bb {

const std::string& FirstContacts::name(int owner) const {
  const auto i = static_cast<std::size_t>(owner), n = scene_.bodies.size();
  return i < n ? scene_.bodies[i].name : scene_.obstacles[i - n].name;
}

void FirstContacts::keep(Archive& archive) { archive(touched_); }

void FirstContacts::note(const ContactState& state, int step, CountMap& first) {
  const auto n_bodies = static_cast<int>(scene_.bodies.size());
  const auto scan = [&](const auto& rows) {
    for (const ContactKey& key : rows.key) {
      int low = std::numeric_limits<int>::max(), high = -1;
      for (const int id : key) {
        if (id == -1) continue;
        const int owner = id < 0 ? n_bodies - 2 - id : scene_.body[static_cast<std::size_t>(id)];
        low = std::min(low, owner);
        high = std::max(high, owner);
      }
      if (!touched_.emplace(low, high).second) continue;
      const auto [one, other] = std::minmax(name(low), name(high));
      first.emplace(one + "|" + other, step);
    }
  };
  state.for_each_table(scan);
}

}  // namespace bb
