// Which bodies touched, and when they first did.
#pragma once

#include <set>

#include "core/base/record/run_record.hpp"
#include "core/terms/contact.hpp"
#include "experiments/run/body_pair.hpp"

namespace bb {

class Archive;

class FirstContacts {
 public:
  /// The scene must outlive it.
  explicit FirstContacts(const Scene& scene) : scene_(scene) {}
  /// Enters `step` into `first` for every pair that has a row in `state` for the first time. Keys:
  /// "body|body" or "body|obstacle", the names sorted.
  void note(const ContactState& state, int step, CountMap& first);
  /// Who has touched so far.
  void keep(Archive& archive);

 private:
  const Scene& scene_;
  std::set<BodyPair> touched_;
};

}  // namespace bb
