// Narrow phase: all candidate pairs to the two tables, merged, sorted, independent of the number of threads.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/contact/candidates.hpp"
#include "core/contact/contact_row.hpp"
#include "core/contact/contact_table.hpp"
#include "core/contact/far_test.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// Keeps its buffers between calls; not thread-safe, parallel inside.
class RowBuilder {
 public:
  RowBuilder(const Scene& scene, const Surface& surface,
             const std::vector<AnalyticSurface<double>>& obstacles, const ContactPlan& plan,
             Precision precision)
      : scene_(scene),
        surface_(surface),
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
  struct MollifiedRow {
    ContactRow row;  // all four vertices, weights of the clamped closest points; of an edge and an axis two
    double eps;
    Vec3d axis_point = Vec3d::Zero();  // of that axis, m
  };
  struct Part {
    std::vector<ContactRow> rows;
    std::vector<MollifiedRow> mollified;
    double min_gap = std::numeric_limits<double>::infinity();
  };
  /// A row in the order of the table: its key in two numbers, then row_less, then the place it was found in.
  struct SortedRow {
    std::uint64_t high, low;
    std::size_t place;
    const ContactRow* row;
  };
  /// The pairs [begin, end): what is proven to be far is done with.
  template <PairKind K, class T>
  void add_pairs(const PositionsView& x, const std::vector<IndexPair>& pairs, std::size_t begin,
                 std::size_t end, Part& part) const;
  template <PairKind K, class T>
  void add_pair(const PositionsView& x, IndexPair index, ContactPair<K> pair, Part& part) const;
  template <class T>
  void add_obstacle(const PositionsView& x, IndexPair pair, Part& part) const;
  /// Of an edge (N = 2) or a triangle outside a sphere or cylinder.
  template <int N, class T>
  void add_obstacle_pair(const PositionsView& x, const Primitives<N>& primitives, IndexPair pair,
                         Part& part) const;
  static void add_obstacle_vertex(const AnalyticSurface<double>& obstacle, ContactRow& row);
  bool moves(const ContactRow& row) const;
  int compact_free(const ContactRow& row, int* vertex, double* weight) const;
  void sort_rows(std::size_t n_parts);
  void merge(std::size_t n_parts, ContactTable& rows);
  void fill(const ContactRow& row, double multiplicity, std::size_t at, ContactTable& rows) const;
  void fill_mollified(std::size_t n_parts, MollifiedTable& out);

  const Scene& scene_;
  const Surface& surface_;
  const std::vector<AnalyticSurface<double>>& obstacles_;
  const bool mollified_;
  const Precision precision_;
  FarTest far_;
  std::vector<Part> parts_;
  std::vector<SortedRow> sorted_;
  std::vector<std::size_t> first_;  // start of each group of equal rows in sorted_
  std::vector<MollifiedRow> sorted_mollified_;
  std::size_t n_parts_ = 0;  // used by the last build
};

}  // namespace bb
