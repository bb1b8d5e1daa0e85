#include "core/contact/row_builder.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>

#include "core/contact/chunks.hpp"
#include "core/contact/float_rounding.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/geometry/edge_axis_mollifier.hpp"

namespace bb {
namespace {

PairId pair_id(int kind, IndexPair pair) {
  return bb::pair_id(kind, static_cast<PairId>(pair.first), static_cast<PairId>(pair.second));
}

/// Two numbers of a key in one that compares as they do.
std::uint64_t packed(int first, int second) {
  constexpr std::uint32_t sign = 0x80000000u;
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(first) ^ sign) << 32 |
         (static_cast<std::uint32_t>(second) ^ sign);
}

}  // namespace

bool RowBuilder::moves(const ContactRow& row) const {
  for (std::size_t k = 0; k < 4 && row.stencil[k] >= 0; ++k) {
    if (row.weight[k] != 0 && surface_.vertex_free[static_cast<std::size_t>(row.stencil[k])]) return true;
  }
  return false;
}

/// An obstacle that moves is a point of its row: relative motion alone opens the gap.
void RowBuilder::add_obstacle_vertex(const AnalyticSurface<double>& obstacle, ContactRow& row) {
  if (obstacle.vertex < 0) return;
  std::size_t k = 0;
  double sum = 0;
  for (; row.stencil[k] >= 0; ++k) sum += row.weight[k];
  row.stencil[k] = obstacle.vertex;
  row.weight[k] = -sum;
}

template <PairKind K, class T>
void RowBuilder::add_pairs(const PositionsView& x, const std::vector<IndexPair>& pairs, std::size_t begin,
                           std::size_t end, Part& part) const {
  constexpr std::size_t width = FarTest::width, ahead = 3 * width;
  for (; begin < end; begin += width) {
    const std::size_t n = std::min(width, end - begin);
    for (std::size_t i = begin + ahead; i < std::min(begin + ahead + width, end); ++i)
      far_.fetch<K>(pairs[i]);
    const LaneSet far = far_.far<K>(&pairs[begin], n);
    for (std::size_t lane = 0; lane < n; ++lane) {
      if ((far >> lane & 1) != 0) continue;
      const IndexPair index = pairs[begin + lane];
      add_pair<K, T>(x, index, contact_pair<K>(surface_, index), part);
    }
  }
}

template <PairKind K, class T>
void RowBuilder::add_pair(const PositionsView& x, IndexPair index, ContactPair<K> pair, Part& part) const {
  const auto points = gather_in<T>(x, pair.vertex);
  const auto closest = closest_points<K, T>(points);
  const T gap = closest.d - static_cast<T>(pair.law.offset);
  if (gap >= static_cast<T>(pair.law.d_hat)) return;
  pair.law.d_hat = row_d_hat<K>(scene_, pair);
  if (gap >= static_cast<T>(pair.law.d_hat)) return;

  if constexpr (K == PairKind::edge_edge) {
    if (mollified_) {
      const double eps = edge_edge_mollifier_threshold<double>(gather(scene_.rest, pair.vertex));
      if (edge_edge_cross_squared<T>(points) < static_cast<T>(eps)) {
        MollifiedRow m{make_row<T>(pair.vertex.data(), closest.weights.data(), closest.r, closest.d,
                                   Region::ea_eb, pair.law),
                       eps};
        m.row.pair = pair_id(static_cast<int>(K), index);
        if (!moves(m.row)) return;
        part.min_gap = std::min(part.min_gap, m.row.d);
        part.mollified.push_back(m);
        return;
      }
    }
  }
  ContactRow row =
      make_row<T>(pair.vertex.data(), closest.weights.data(), closest.r, closest.d, closest.region, pair.law);
  row.pair = pair_id(static_cast<int>(K), index);
  if (!moves(row)) return;
  part.min_gap = std::min(part.min_gap, row.d);
  part.rows.push_back(row);
}

template <class T>
void RowBuilder::add_obstacle(const PositionsView& x, IndexPair pair, Part& part) const {
  const std::size_t i = static_cast<std::size_t>(pair.first);
  const int v = surface_.points.vertices[i][0];
  const AnalyticSurface<double> exact = posed(obstacles_[static_cast<std::size_t>(pair.second)], x);
  const auto obstacle = surface_in<T>(exact);
  const SurfaceGap<T> gap = surface_gap<T>(obstacle, x.col(v).template cast<T>());
  const Side law = surface_.points.side[i];
  const T d = gap.d - static_cast<T>(law.offset);
  if (d >= static_cast<T>(law.d_hat)) return;
  ContactRow row;
  row.kind = ContactKind::obstacle;
  row.pair = pair_id(obstacle_pairs, pair);
  row.key = obstacle_key(pair.second, std::array{v});
  row.stencil[0] = v;
  row.weight[0] = 1;
  add_obstacle_vertex(exact, row);
  row.normal = gap.normal.template cast<double>();
  row.d = d;
  row.d_hat = law.d_hat;
  row.offset = law.offset;
  row.curvature = gap.curvature;
  row.flat = gap.flat.template cast<double>();
  part.min_gap = std::min(part.min_gap, row.d);
  part.rows.push_back(row);
}

template <int N, class T>
void RowBuilder::add_obstacle_pair(const PositionsView& x, const Primitives<N>& primitives, IndexPair pair,
                                   Part& part) const {
  const std::size_t i = static_cast<std::size_t>(pair.first);
  const auto& vertex = primitives.vertices[i];
  const Side law = primitives.side[i];
  const AnalyticSurface<double> exact = posed(obstacles_[static_cast<std::size_t>(pair.second)], x);
  const Mat<double, 3, N> at = gather(x, vertex);
  const double largest = std::max(at.cwiseAbs().maxCoeff(), exact.point.cwiseAbs().maxCoeff());
  const double reach = law.d_hat + law.offset + distance_rounding(precision_, largest + exact.radius);
  if (far_from_centre<N>(exact, about_centre<N, double>(exact, at), reach)) return;

  const auto obstacle = surface_in<T>(exact);
  const Mat<T, 3, N + 1> points = about_centre<N, T>(obstacle, at.template cast<T>());
  auto closest = closest_points<centre_pair<N>, T>(points);
  const T gap = closest.d - obstacle.radius - static_cast<T>(law.offset);
  if (gap >= static_cast<T>(law.d_hat)) return;
  double eps = 0;
  if constexpr (N == 2) {
    if (mollified_ && is_line(exact, surface_.planar)) {
      eps = edge_axis_mollifier_threshold<double>(gather(scene_.rest, vertex));
      if (edge_axis_cross_squared<T>(points) < static_cast<T>(eps)) {
        closest = on_whole_edge(closest);
      } else {
        eps = 0;
      }
    }
  }
  const PairRow found =
      obstacle_row<N, T>(vertex.data(), closest, obstacle.radius, static_cast<T>(law.offset));
  ContactRow row;
  row.kind = found.kind;
  row.pair = pair_id(obstacle_pairs_of<N>, pair);
  std::copy_n(found.stencil, 4, row.stencil.begin());
  std::copy_n(found.weight, 4, row.weight.begin());
  row.key = obstacle_key(pair.second, std::array{row.stencil[0], row.stencil[1], row.stencil[2]});
  row.normal = found.normal;
  row.d = found.d;
  row.d_hat = law.d_hat;
  row.offset = found.kind == ContactKind::obstacle ? law.offset : law.offset + exact.radius;
  row.curvature = 1 / closest.d;
  if (exact.kind == ObstacleKind::cylinder) row.flat = obstacle.axis.template cast<double>();
  if (!moves(row)) return;
  add_obstacle_vertex(exact, row);
  part.min_gap = std::min(part.min_gap, row.d);
  if (eps > 0) {
    part.mollified.push_back({row, eps, exact.point});
  } else {
    part.rows.push_back(row);
  }
}

double RowBuilder::build(const PositionsView& x, const Candidates& candidates, ContactTable& rows,
                         MollifiedTable& mollified) {
  if (!x.allFinite()) {  // boxes and comparisons mean nothing then
    rows.resize(0);
    mollified.resize(0);
    n_parts_ = 0;
    return -std::numeric_limits<double>::infinity();
  }
  far_.set_state(x);
  std::size_t n_parts = 0;
  const auto in_parts = [&](const std::vector<IndexPair>& pairs, const auto& add_range) {
    const std::size_t n = n_chunks(pairs.size());
    if (parts_.size() < n_parts + n) parts_.resize(n_parts + n);
    for_each_chunk(pairs.size(), [&, base = n_parts](std::size_t k, std::size_t begin, std::size_t end) {
      Part& part = parts_[base + k];
      part.rows.clear();
      part.mollified.clear();
      part.min_gap = std::numeric_limits<double>::infinity();
      add_range(begin, end, part);
    });
    n_parts += n;
  };
  with_value_scalar(precision_, [&]<class T>() {
    for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
      in_parts(pairs, [&](std::size_t begin, std::size_t end, Part& part) {
        add_pairs<K, T>(x, pairs, begin, end, part);
      });
    });
    for_each_obstacle_list(surface_, candidates,
                           [&]<int N>(const Primitives<N>& primitives, const std::vector<IndexPair>& pairs) {
                             in_parts(pairs, [&](std::size_t begin, std::size_t end, Part& part) {
                               for (std::size_t i = begin; i < end; ++i) {
                                 if constexpr (N == 1) {
                                   add_obstacle<T>(x, pairs[i], part);
                                 } else {
                                   add_obstacle_pair<N, T>(x, primitives, pairs[i], part);
                                 }
                               }
                             });
                           });
  });

  n_parts_ = n_parts;
  merge(n_parts, rows);
  fill_mollified(n_parts, mollified);
  double min_gap = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < n_parts; ++k) min_gap = std::min(min_gap, parts_[k].min_gap);
  return min_gap;
}

void RowBuilder::near_pairs(Candidates& out) const {
  std::vector<IndexPair>* const lists[] = {&out.point_point, &out.point_edge, &out.point_triangle,
                                           &out.edge_edge};
  for (auto* list : lists) list->clear();
  for (auto* list : {&out.obstacle, &out.obstacle_edge, &out.obstacle_triangle}) list->clear();
  const auto add = [&](PairId id) {
    const std::size_t kind = static_cast<std::size_t>(id >> 60);
    constexpr PairId index = (PairId{1} << 30) - 1;
    if (kind >= obstacle_pairs) return;
    lists[kind]->push_back({static_cast<int>(id >> 30 & index), static_cast<int>(id & index)});
  };
  for (std::size_t k = 0; k < n_parts_; ++k) {
    for (const ContactRow& row : parts_[k].rows) add(row.pair);
    for (const MollifiedRow& row : parts_[k].mollified) add(row.row.pair);
  }
}

int RowBuilder::compact_free(const ContactRow& row, int* vertex, double* weight) const {
  int n = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (row.stencil[k] < 0 || !surface_.vertex_free[static_cast<std::size_t>(row.stencil[k])]) continue;
    vertex[n] = row.stencil[k];
    weight[n++] = row.weight[k];
  }
  std::fill(vertex + n, vertex + 4, -1);
  std::fill(weight + n, weight + 4, 0.0);
  return n;
}

void RowBuilder::sort_rows(std::size_t n_parts) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < n_parts; ++k) n += parts_[k].rows.size();
  sorted_.resize(n);
  n = 0;
  for (std::size_t k = 0; k < n_parts; ++k) {
    for (const ContactRow& row : parts_[k].rows) {
      sorted_[n] = {packed(row.key[0], row.key[1]), packed(row.key[2], row.key[3]), n, &row};
      ++n;
    }
  }
  // By place at last, so that a merged row takes its numbers from its first pair, whatever the threads do.
  tbb::parallel_sort(sorted_.begin(), sorted_.end(), [](const SortedRow& a, const SortedRow& b) {
    if (a.high != b.high) return a.high < b.high;
    if (a.low != b.low) return a.low < b.low;
    if (row_less(*a.row, *b.row)) return true;
    return a.place < b.place && !row_less(*b.row, *a.row);
  });
}

void RowBuilder::merge(std::size_t n_parts, ContactTable& rows) {
  sort_rows(n_parts);
  first_.clear();
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    if (i == 0 || row_less(*sorted_[i - 1].row, *sorted_[i].row)) first_.push_back(i);
  }
  rows.resize(first_.size());
  rows.pair.resize(sorted_.size());
  std::copy(first_.begin(), first_.end(), rows.pair_begin.begin());
  rows.pair_begin.back() = sorted_.size();
  for_each_chunk(first_.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      const std::size_t next = r + 1 < first_.size() ? first_[r + 1] : sorted_.size();
      for (std::size_t i = first_[r]; i < next; ++i) rows.pair[i] = sorted_[i].row->pair;
      fill(*sorted_[first_[r]].row, static_cast<double>(next - first_[r]), r, rows);
    }
  });
}

void RowBuilder::fill(const ContactRow& row, double multiplicity, std::size_t at, ContactTable& t) const {
  t.kind[at] = row.kind;
  t.key[at] = row.key;
  std::copy(row.stencil.begin(), row.stencil.end(), &t.stencil[4 * at]);
  std::copy(row.weight.begin(), row.weight.end(), &t.stencil_weight[4 * at]);
  t.n_free[at] = compact_free(row, &t.vertex[4 * at], &t.weight[4 * at]);
  for (std::size_t k = 0; k < 3; ++k) {
    t.normal[3 * at + k] = row.normal[static_cast<int>(k)];
    t.flat[3 * at + k] = row.flat[static_cast<int>(k)];
  }
  t.d[at] = row.d;
  t.d_hat[at] = row.d_hat;
  t.offset[at] = row.offset;
  t.multiplicity[at] = multiplicity;
  t.curvature[at] = row.curvature;
  t.parts[at] = {};
  t.kappa[at] = t.kappa_before[at] = t.b[at] = t.db[at] = t.d2b[at] = 0;
}

void RowBuilder::fill_mollified(std::size_t n_parts, MollifiedTable& out) {
  sorted_mollified_.clear();
  for (std::size_t k = 0; k < n_parts; ++k) {
    sorted_mollified_.insert(sorted_mollified_.end(), parts_[k].mollified.begin(), parts_[k].mollified.end());
  }
  std::sort(sorted_mollified_.begin(), sorted_mollified_.end(),  // each pair once: no two are equal
            [](const MollifiedRow& a, const MollifiedRow& b) { return row_less(a.row, b.row); });
  out.resize(sorted_mollified_.size());
  for (std::size_t at = 0; at < sorted_mollified_.size(); ++at) {
    const ContactRow& row = sorted_mollified_[at].row;
    out.key[at] = row.key;
    for (std::size_t k = 0; k < 4; ++k) {
      const int v = row.stencil[k];
      out.stencil[4 * at + k] = v;
      out.stencil_weight[4 * at + k] = row.weight[k];
      out.vertex[4 * at + k] = v >= 0 && surface_.vertex_free[static_cast<std::size_t>(v)] ? v : -1;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      out.axis[3 * at + k] = row.flat[static_cast<int>(k)];
      out.axis_point[3 * at + k] = sorted_mollified_[at].axis_point[static_cast<int>(k)];
    }
    out.n_free[at] = compact_free(row, &out.free_vertex[4 * at], &out.weight[4 * at]);
    for (std::size_t k = 0; k < 3; ++k) out.normal[3 * at + k] = row.normal[static_cast<int>(k)];
    out.eps[at] = sorted_mollified_[at].eps;
    out.pair[at] = row.pair;
    out.d[at] = row.d;
    out.d_hat[at] = row.d_hat;
    out.offset[at] = row.offset;
    out.multiplicity[at] = 1;
    out.parts[at] = {};
    out.kappa[at] = out.kappa_before[at] = out.b[at] = out.db[at] = out.d2b[at] = 0;
  }
}

}  // namespace bb
