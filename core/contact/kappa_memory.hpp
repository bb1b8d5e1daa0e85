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

/// kappa of the pairs behind earlier rows. A row has the mean of its pairs, so m kappa is their sum: when the
/// closest point of a pair crosses to a neighbouring feature, and its share moves from one row to another, B
/// does not jump, as it would if kappa belonged to the row. An edge-edge pair keeps its kappa when it becomes
/// mollified and back. Cost of every call O(pairs log pairs).
class KappaMemory {
 public:
  void clear() { known_.clear(); }
  /// What another memory knows, in the place of what this one knew.
  void adopt(const KnownStiffness& known);
  /// What this one knows.
  void known(KnownStiffness& out) const;
  /// Adds the pairs that are not known yet; what is known stays. Requires recall() of the same tables before,
  /// and parts of the rows that it reported missing set (see complete()).
  void store(const ContactTable& rows, const MollifiedTable& mollified);
  /// Fills parts and kappa of the rows whose pairs are all known; `missing` gets the indices of the others (row
  /// or mollified row).
  void recall(ContactTable& rows, MollifiedTable& mollified, std::vector<int>& missing,
              std::vector<int>& missing_mollified) const;
  /// Rows that recall() reported missing come with the parts of a new pair; where some of their pairs are known
  /// they leave with the mean over all. kappa of them all is set from the parts.
  void complete(ContactTable& rows, const std::vector<int>& missing, MollifiedTable& mollified,
                const std::vector<int>& missing_mollified) const;

 private:
  struct Known {
    PairId pair;
    KappaParts parts;
  };
  const Known* find(PairId pair) const;
  /// Sum over the known pairs of a row, and how many they are.
  struct Share {
    KappaParts sum;
    std::size_t n = 0;
  };
  Share share(const ContactTable& rows, std::size_t row) const;

  std::vector<Known> known_;           // sorted by pair
  std::vector<Known> fresh_, merged_;  // buffers of store
};

}  // namespace bb
