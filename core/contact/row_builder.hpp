// Narrow phase: all candidate pairs to the two tables, one row a pair in their order, whatever the number of threads.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/contact/candidates.hpp"
#include "core/contact/contact_table.hpp"
#include "core/contact/far_test.hpp"
#include "core/contact/found_rows.hpp"
#include "core/contact/offset_blocks.hpp"
#include "core/contact/pair_corrections.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// How pairs count, and which have a row.
struct RowRules {
  ContactWeighting weighting = ContactWeighting::none;
  ContactModel model = ContactModel::all_pairs;
};

/// Keeps its buffers between calls; not thread-safe, parallel inside.
class RowBuilder {
 public:
  RowBuilder(const Surface& surface, const std::vector<AnalyticSurface<double>>& obstacles,
             const ContactPlan& plan, Precision precision, const RowRules& rules = {});

  /// See ContactSystem::find_rows.
  double build(const PositionsView& x, const Candidates& candidates, ContactTable& rows,
               MollifiedTable& mollified);

  /// The candidates that were below their d_hat in the last build, sorted; no obstacles.
  void near_pairs(Candidates& out) const;

  /// Where pairs are weighted by area; else null.
  const PairAreas* areas() const { return areas_ ? &*areas_ : nullptr; }
  bool corrected() const { return corrections_.has_value(); }

 private:
  /// Where the rows of a part begin in the tables.
  struct First {
    std::size_t row, mollified;
  };
  /// The pairs [begin, end): what is proven to be far is done with.
  template <PairKind K, class T>
  void add_pairs(const PositionsView& x, const std::vector<IndexPair>& pairs, std::size_t begin,
                 std::size_t end, RowPart& part) const;
  template <PairKind K, class T>
  void add_pair(const PositionsView& x, IndexPair index, const ContactPair<K>& pair, RowPart& part) const;
  /// Of a primitive with N vertices.
  template <int N, class T>
  void add_obstacle_pair(const PositionsView& x, const Primitives<N>& primitives, IndexPair pair,
                         RowPart& part) const;
  void find_parts(const PositionsView& x, const Candidates& candidates);
  void apply_rules(const PositionsView& x);
  double min_gap() const;
  void fill_tables(ContactTable& rows, MollifiedTable& mollified);

  const Surface& surface_;
  const std::vector<AnalyticSurface<double>>& obstacles_;
  std::vector<AnalyticSurface<double>> posed_;  // where they are in the state of the last build
  const bool mollified_;
  const Precision precision_;
  FarTest far_;
  std::vector<RowPart> parts_;
  std::vector<First> first_;
  std::size_t n_parts_ = 0;  // used by the last build
  std::optional<PairAreas> areas_;
  std::optional<PairCorrections> corrections_;
  std::optional<OffsetBlocks> blocks_;
  RowPart features_, ends_;  // rows of corrections, in front of all others and behind them
};

}  // namespace bb
