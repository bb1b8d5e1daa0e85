// Rows of a state before they are columns: what the narrow phase finds, and what its rules add and leave out.
#pragma once

#include <limits>
#include <vector>

#include "core/contact/pair_id.hpp"
#include "core/contact/row_rule.hpp"

namespace bb {

struct PartRow {
  FoundRow row;
  PairId pair;
  double share = 1;  // by which kappa of the policy is multiplied; 0: not a row of the tables
};

/// What one chunk of candidates has.
struct RowPart {
  std::vector<PartRow> rows, mollified;
  double min_gap = std::numeric_limits<double>::infinity();

  void add(const FoundRow& row, PairId pair) {
    min_gap = row.d < min_gap ? row.d : min_gap;
    (row.eps > 0 ? mollified : rows).push_back({row, pair});
  }
  void clear() {
    rows.clear();
    mollified.clear();
    min_gap = std::numeric_limits<double>::infinity();
  }
};

}  // namespace bb
