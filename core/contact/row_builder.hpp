// Narrow phase: all candidate pairs to the two tables, one row a pair in their order, whatever the number of threads.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/contact/candidates.hpp"
#include "core/contact/contact_table.hpp"
#include "core/contact/far_test.hpp"
#include "core/contact/row_rule.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// Keeps its buffers between calls; not thread-safe, parallel inside.
class RowBuilder {
 public:
  RowBuilder(const Surface& surface, const std::vector<AnalyticSurface<double>>& obstacles,
             const ContactPlan& plan, Precision precision)
      : surface_(surface),
        obstacles_(obstacles),
        mollified_(plan.mollifier.needed),
        precision_(precision),
        far_(surface, precision) {}

  /// See ContactSystem::find_rows.
  double build(const PositionsView& x, const Candidates& candidates, ContactTable& rows,
               MollifiedTable& mollified);

  /// The candidates that had a row in the last build, sorted; no obstacles.
  void near_pairs(Candidates& out) const;

 private:
  struct PartRow {
    FoundRow row;
    PairId pair;
  };
  /// What one chunk of candidates has.
  struct Part {
    std::vector<PartRow> rows, mollified;
    double min_gap = std::numeric_limits<double>::infinity();
    void add(const FoundRow& row, PairId pair);
  };
  /// Where the rows of a part begin in the tables.
  struct First {
    std::size_t row, mollified;
  };
  /// The pairs [begin, end): what is proven to be far is done with.
  template <PairKind K, class T>
  void add_pairs(const PositionsView& x, const std::vector<IndexPair>& pairs, std::size_t begin,
                 std::size_t end, Part& part) const;
  template <PairKind K, class T>
  void add_pair(const PositionsView& x, IndexPair index, const ContactPair<K>& pair, Part& part) const;
  /// Of a primitive with N vertices.
  template <int N, class T>
  void add_obstacle_pair(const PositionsView& x, const Primitives<N>& primitives, IndexPair pair,
                         Part& part) const;
  void fill_tables(ContactTable& rows, MollifiedTable& mollified);

  const Surface& surface_;
  const std::vector<AnalyticSurface<double>>& obstacles_;
  std::vector<AnalyticSurface<double>> posed_;  // where they are in the state of the last build
  const bool mollified_;
  const Precision precision_;
  FarTest far_;
  std::vector<Part> parts_;
  std::vector<First> first_;
  std::size_t n_parts_ = 0;  // used by the last build
};

}  // namespace bb
