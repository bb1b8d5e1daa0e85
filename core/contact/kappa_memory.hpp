// The stiffness of pairs that were there before, found again by identity.
#pragma once

#include <vector>

#include "core/contact/contact_table.hpp"

namespace bb {

/// The stiffness of some pairs, ascending by pair.
struct KnownStiffness {
  std::vector<PairId> pair;
  std::vector<KappaParts> parts;
};

/// kappa of earlier rows, by their pairs. A pair keeps its kappa when its closest points cross to a neighbouring feature,
/// and an edge-edge pair when it becomes mollified and back: so B does not jump. Tables are in the order of their pairs.
/// Cost of every call O(rows + known pairs).
class KappaMemory {
 public:
  void clear() { known_ = {}; }
  /// What another memory knows, in the place of what this one knew.
  void adopt(const KnownStiffness& known) { known_ = known; }
  /// What this one knows.
  const KnownStiffness& known() const { return known_; }
  /// Adds the pairs that are not known yet, with the parts of their rows; what is known stays.
  void store(const ContactTable& rows, const MollifiedTable& mollified);
  /// Fills parts and kappa of the rows whose pairs are known; `missing` gets the indices of the others (row or mollified
  /// row).
  void recall(ContactTable& rows, MollifiedTable& mollified, std::vector<int>& missing,
              std::vector<int>& missing_mollified) const;

 private:
  KnownStiffness known_, merged_;  // merged_: a buffer of store
};

}  // namespace bb
