#include "core/contact/pair_corrections.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/contact/edge_end_row.hpp"

namespace bb {
namespace {

template <class List>
void sort_once(List& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

void sort_by_pair(std::vector<PartRow>& rows) {
  std::sort(rows.begin(), rows.end(), [](const PartRow& a, const PartRow& b) { return a.pair < b.pair; });
}

PairId feature_pair(PairKind kind, int first, int second) {
  return bb::pair_id(static_cast<int>(kind), static_cast<PairId>(first), static_cast<PairId>(second));
}

/// Calls f(kind, first, second) for the rows of two surface primitives.
template <class F>
void for_each_surface_row(std::span<const RowPart> parts, const F& f) {
  for (const RowPart& part : parts) {
    for (const auto* rows : {&part.rows, &part.mollified}) {
      for (const PartRow& each : *rows) {
        if (pair_list(each.pair) < obstacle_pairs)
          f(static_cast<PairKind>(pair_list(each.pair)), pair_first(each.pair), pair_second(each.pair));
      }
    }
  }
}

}  // namespace

PairCorrections::PairCorrections(const Surface& surface, const PairAreas& areas, bool mollifier,
                                 Precision precision)
    : surface_(surface), areas_(areas), mollifier_(mollifier), precision_(precision), topology_(surface) {}

/// Whether a point and a triangle are a pair with the d_hat of its two sides.
bool PairCorrections::counts(int point, int triangle) const {
  const auto p = static_cast<std::size_t>(point), t = static_cast<std::size_t>(triangle);
  const int v = surface_.points.vertices[p][0];
  const std::array<int, 3>& corners = surface_.triangles.vertices[t];
  if (!Surface::disjoint(v, corners)) return false;
  const Side law = combine(surface_.points.side[p], surface_.triangles.side[t]);
  const int vertex[] = {v, corners[0], corners[1], corners[2]};
  return activation_distance<PairKind::point_triangle>(surface_, vertex, law) == law.d_hat;
}

bool PairCorrections::edges_count(int edge, int other) const {
  const auto a = static_cast<std::size_t>(edge), b = static_cast<std::size_t>(other);
  const std::array<int, 2>&first = surface_.edges.vertices[a], &second = surface_.edges.vertices[b];
  if (!Surface::disjoint(first, second)) return false;
  const Side law = combine(surface_.edges.side[a], surface_.edges.side[b]);
  const int vertex[] = {first[0], first[1], second[0], second[1]};
  return activation_distance<PairKind::edge_edge>(surface_, vertex, law) == law.d_hat;
}

int PairCorrections::triangles_counted(int point, int edge) const {
  const auto triangles = topology_.triangles_at_edge.of(edge);
  return static_cast<int>(
      std::count_if(triangles.begin(), triangles.end(), [&](int t) { return counts(point, t); }));
}

/// How often `other` has to count for `point`, so that with the triangles and the edges there it counts once.
int PairCorrections::excess_at(int point, int other) const {
  int counted = 0;
  for (const int t : topology_.triangles_at_point.of(other)) counted += counts(point, t) ? 1 : 0;
  if (counted == 0) return 0;
  for (const int e : topology_.edges_at_point.of(other))
    counted -= std::max(0, triangles_counted(point, e) - 1);
  return 1 - counted;
}

/// Points and edges, and points and points, that are parts of pairs with a row: no other can be as near.
void PairCorrections::list_near(std::span<const RowPart> parts) {
  point_edge_.clear();
  point_point_.clear();
  for_each_surface_row(parts, [this](PairKind kind, int first, int second) {
    const auto at = static_cast<std::size_t>(second);
    if (kind == PairKind::point_triangle) {
      for (const int e : topology_.triangle_edges[at]) point_edge_.push_back({first, e});
      for (const int p : topology_.triangle_points[at])
        point_point_.push_back({std::min(first, p), std::max(first, p)});
    } else if (kind == PairKind::edge_edge) {
      for (const int p : topology_.edge_points[at]) point_edge_.push_back({p, first});
      for (const int p : topology_.edge_points[static_cast<std::size_t>(first)])
        point_edge_.push_back({p, second});
    }
  });
  sort_once(point_edge_);
  sort_once(point_point_);
}

template <class T>
bool PairCorrections::is_mollified(const PositionsView& x, int edge, int other) const {
  if (!mollifier_) return false;
  const std::array<int, 4> vertex = edge_pair_vertices(surface_, edge, other);
  return mollifier_threshold_at<T>(surface_, vertex.data(), gather_in<T>(x, vertex)) > 0;
}

/// Of an edge and a point that is an end of `other`, mollified as the pair of the two edges is.
template <class T>
void PairCorrections::add_end(const PositionsView& x, int edge, int other, int point, RowPart& ends) const {
  FoundRow row;
  const EdgeEnd end =
      edge_end(surface_, edge, other, surface_.points.vertices[static_cast<std::size_t>(point)][0]);
  if (!edge_end_row<T>(surface_, end, x, row)) return;
  ends.mollified.push_back({row, end.pair, -areas_.of_edge(edge) / 4});
}

template <class T>
void PairCorrections::add_point_edge(const PositionsView& x, Near pair, RowPart& features, RowPart& ends) {
  const auto [point, edge] = pair;
  const auto p = static_cast<std::size_t>(point), e = static_cast<std::size_t>(edge);
  const std::array<int, 3> vertex{surface_.points.vertices[p][0], surface_.edges.vertices[e][0],
                                  surface_.edges.vertices[e][1]};
  const Side law = combine(surface_.points.side[p], surface_.edges.side[e]);
  FoundRow row;
  if (!surface_row<PairKind::point_edge, T>(surface_, vertex.data(), law, gather_in<T>(x, vertex), false,
                                            row) ||
      row.d_hat != law.d_hat)
    return;
  int counted = 0, plain = 0;
  for (const int other : topology_.edges_at_point.of(point)) {
    if (!edges_count(edge, other)) continue;
    ++counted;
    if (is_mollified<T>(x, edge, other)) {
      add_end<T>(x, edge, other, point, ends);
    } else {
      ++plain;
    }
  }
  double share = -std::max(0, triangles_counted(point, edge) - 1) * areas_.of_point(point) / 4;
  if (counted > 0) share -= (plain - 1) * areas_.of_edge(edge) / 4;
  if (share != 0) features.rows.push_back({row, feature_pair(PairKind::point_edge, point, edge), share});
}

template <class T>
void PairCorrections::add_point_point(const PositionsView& x, Near pair, RowPart& features) const {
  const auto [first, second] = pair;
  const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
  const std::array<int, 2> vertex{surface_.points.vertices[a][0], surface_.points.vertices[b][0]};
  const Side law = combine(surface_.points.side[a], surface_.points.side[b]);
  FoundRow row;
  if (!surface_row<PairKind::point_point, T>(surface_, vertex.data(), law, gather_in<T>(x, vertex), false,
                                             row) ||
      row.d_hat != law.d_hat)
    return;
  const double share = (excess_at(first, second) * areas_.of_point(first) +
                        excess_at(second, first) * areas_.of_point(second)) /
                       4;
  if (share != 0) features.rows.push_back({row, feature_pair(PairKind::point_point, first, second), share});
}

template <class T>
void PairCorrections::add_rows(const PositionsView& x, RowPart& features, RowPart& ends) {
  for (const Near pair : point_edge_) add_point_edge<T>(x, pair, features, ends);
  for (const Near pair : point_point_) add_point_point<T>(x, pair, features);
}

void PairCorrections::apply(const PositionsView& x, std::span<RowPart> parts, RowPart& features,
                            RowPart& ends) {
  features.clear();
  ends.clear();
  list_near(parts);
  with_value_scalar(precision_, [&]<class T>() { add_rows<T>(x, features, ends); });
  sort_by_pair(features.rows);
  sort_by_pair(ends.mollified);
  merge_features(features, parts);
}

void merge_features(RowPart& features, std::span<RowPart> parts) {
  struct Entry {
    std::array<int, 3> vertex;
    double d_hat, offset;
    std::size_t order;
    PartRow* row;
    bool same(const Entry& other) const {
      return vertex == other.vertex && d_hat == other.d_hat && offset == other.offset;
    }
    auto key() const { return std::tie(vertex, d_hat, offset, order); }
  };
  std::vector<Entry> entries;
  const auto list = [&entries](std::vector<PartRow>& rows) {
    for (PartRow& each : rows) {
      const FoundRow& row = each.row;
      if (row.kind != ContactKind::point_point && row.kind != ContactKind::point_edge) continue;
      entries.push_back(
          {{row.stencil[0], row.stencil[1], row.stencil[2]}, row.d_hat, row.offset, entries.size(), &each});
    }
  };
  list(features.rows);
  for (RowPart& part : parts) list(part.rows);
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.key() < b.key(); });
  for (std::size_t i = 0, next; i < entries.size(); i = next) {
    double sum = 0, size = 0;
    for (next = i; next < entries.size() && entries[next].same(entries[i]); ++next) {
      sum += entries[next].row->share;
      size += std::abs(entries[next].row->share);
      entries[next].row->share = 0;
    }
    constexpr double rounding = 1e-12;  // of shares that add up to nothing
    if (std::abs(sum) > rounding * size) entries[i].row->share = sum;
  }
}

}  // namespace bb
