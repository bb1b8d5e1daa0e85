#include "experiments/run/first_contacts.hpp"

#include "core/base/archive/archive.hpp"

namespace bb {

void FirstContacts::keep(Archive& archive) { archive(touched_); }

void FirstContacts::note(const ContactState& state, int step, CountMap& first) {
  const auto scan = [&](const auto& rows) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const BodyPair pair = body_pair(scene_, rows.key(r));
      if (touched_.insert(pair).second) first.emplace(name_of(scene_, pair), step);
    }
  };
  state.for_each_table(scan);
}

}  // namespace bb
