// Rows that take back what pairs count twice because they share a closest feature (docs/theory/contact-models.md, Weights by area).
#pragma once

#include <compare>
#include <span>
#include <vector>

#include "core/contact/found_rows.hpp"
#include "core/contact/pair_areas.hpp"
#include "core/contact/surface_topology.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// The largest b of a point over a surface, as a sum that is as smooth as b of a pair (Li et al. 2023): over its triangles,
/// minus its edges of two triangles, plus its inner vertices. The largest b of an edge over other edges: over these, minus
/// each of their vertices as often as it has further edges. So rows of a point and an edge and of two points come to those
/// of the pairs, with areas below 0 among them, and rows of one feature become one.
///
/// A vertex or an edge is corrected for the pairs that it has with the primitives there: those that share no vertex, and, of
/// one body, those that the rest rule leaves their d_hat. Where edges are mollified, by e, a vertex of theirs is taken back
/// as often as their e add up to, less one: mollified rows at one end of an edge do that (PairId, end_pairs).
/// Differs from the IPC Toolkit (NormalCollisions, IMPROVED_MAX_APPROX): it knows no rest rule.
class PairCorrections {
 public:
  PairCorrections(const Surface& surface, const PairAreas& areas, bool mollifier, Precision precision);

  /// parts: all rows of the state x, their shares being their areas (m^2). Merges rows of one feature, which leaves shares
  /// of 0, into `features`, sorted by pair; `ends`: mollified rows, likewise.
  void apply(const PositionsView& x, std::span<RowPart> parts, RowPart& features, RowPart& ends);

 private:
  struct Near {
    int first, second;
    auto operator<=>(const Near&) const = default;
  };
  template <class T>
  void add_rows(const PositionsView& x, RowPart& features, RowPart& ends);
  template <class T>
  void add_point_edge(const PositionsView& x, Near pair, RowPart& features, RowPart& ends);
  template <class T>
  void add_point_point(const PositionsView& x, Near pair, RowPart& features) const;
  template <class T>
  void add_end(const PositionsView& x, int edge, int other, int point, RowPart& ends) const;
  template <class T>
  bool is_mollified(const PositionsView& x, int edge, int other) const;
  void list_near(std::span<const RowPart> parts);
  int triangles_counted(int point, int edge) const;
  int excess_at(int point, int other) const;
  bool counts(int point, int triangle) const;
  bool edges_count(int edge, int other) const;

  const Surface& surface_;
  const PairAreas& areas_;
  const bool mollifier_;
  const Precision precision_;
  const SurfaceTopology topology_;
  std::vector<Near> point_edge_, point_point_;  // of the rows of the state
};

/// One row a feature: those of a point and an edge, or of two points, that have the same vertices and the same d_hat get
/// the sum of their shares, the first of them all of it, and the others 0.
void merge_features(RowPart& features, std::span<RowPart> parts);

}  // namespace bb
