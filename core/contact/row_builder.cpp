#include "core/contact/row_builder.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "core/contact/chunks.hpp"
#include "core/contact/float_rounding.hpp"

namespace bb {
namespace {

PairId pair_id(int kind, IndexPair pair) {
  return bb::pair_id(kind, static_cast<PairId>(pair.first), static_cast<PairId>(pair.second));
}

/// Free vertices and their weights in front, in the order of the stencil; the rest -1 and 0. Returns how many there are.
int compact_free(const FoundRow& row, int* vertex, double* weight) {
  int n = 0;
  for (int k = 0; k < 4; ++k) {
    if ((row.free >> k & 1) == 0) continue;
    vertex[n] = row.stencil[k];
    weight[n++] = row.weight[k];
  }
  std::fill(vertex + n, vertex + 4, -1);
  std::fill(weight + n, weight + 4, 0.0);
  return n;
}

/// What both tables have of row `at`.
template <class Table>
void fill_common(const FoundRow& row, PairId pair, std::size_t at, Table& t) {
  std::copy_n(row.stencil, 4, &t.stencil[4 * at]);
  std::copy_n(row.weight, 4, &t.stencil_weight[4 * at]);
  Vec3d::Map(&t.normal[3 * at]) = row.normal;
  t.pair[at] = pair;
  t.d[at] = row.d;
  t.d_hat[at] = row.d_hat;
  t.offset[at] = row.offset;
  t.parts[at] = {};
  t.kappa[at] = t.kappa_before[at] = t.b[at] = t.db[at] = t.d2b[at] = 0;
}

void fill(const FoundRow& row, PairId pair, std::size_t at, ContactTable& t) {
  fill_common(row, pair, at, t);
  t.kind[at] = row.kind;
  t.n_free[at] = compact_free(row, &t.vertex[4 * at], &t.weight[4 * at]);
  Vec3d::Map(&t.flat[3 * at]) = row.flat;
  t.curvature[at] = row.curvature;
}

void fill(const FoundRow& row, PairId pair, const Vec3d& axis_point, std::size_t at, MollifiedTable& t) {
  fill_common(row, pair, at, t);
  for (std::size_t k = 0; k < 4; ++k) t.vertex[4 * at + k] = (row.free >> k & 1) != 0 ? row.stencil[k] : -1;
  t.n_free[at] = compact_free(row, &t.free_vertex[4 * at], &t.weight[4 * at]);
  Vec3d::Map(&t.axis[3 * at]) = row.flat;
  Vec3d::Map(&t.axis_point[3 * at]) = axis_point;
  t.eps[at] = row.eps;
}

}  // namespace

template <PairKind K, class T>
void RowBuilder::add_pairs(const PositionsView& x, const std::vector<IndexPair>& pairs, std::size_t begin,
                           std::size_t end, RowPart& part) const {
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
void RowBuilder::add_pair(const PositionsView& x, IndexPair index, const ContactPair<K>& pair,
                          RowPart& part) const {
  FoundRow row;
  const bool mollified = mollified_ && !blocks_;  // blocks need the closest feature first
  if (surface_row<K, T>(surface_, pair.vertex.data(), pair.law, gather_in<T>(x, pair.vertex), mollified, row))
    part.add(row, pair_id(static_cast<int>(K), index));
}

template <int N, class T>
void RowBuilder::add_obstacle_pair(const PositionsView& x, const Primitives<N>& primitives, IndexPair pair,
                                   RowPart& part) const {
  const std::size_t i = static_cast<std::size_t>(pair.first);
  const auto& vertex = primitives.vertices[i];
  const Side law = primitives.side[i];
  const AnalyticSurface<double>& obstacle = posed_[static_cast<std::size_t>(pair.second)];
  const Mat<double, 3, N> at = gather(x, vertex);
  if constexpr (N > 1) {
    const double largest = std::max(at.cwiseAbs().maxCoeff(), obstacle.point.cwiseAbs().maxCoeff());
    const double reach = law.d_hat + law.offset + distance_rounding(precision_, largest + obstacle.radius);
    if (far_from_centre<N>(obstacle, about_centre<N, double>(obstacle, at), reach)) return;
  }
  FoundRow row;
  if (obstacle_pair_row<N, T>(surface_, vertex.data(), law, obstacle, at.template cast<T>(), mollified_, row))
    part.add(row, pair_id(obstacle_pairs_of<N>, pair));
}

RowBuilder::RowBuilder(const Surface& surface, const std::vector<AnalyticSurface<double>>& obstacles,
                       const ContactPlan& plan, Precision precision, const RowRules& rules)
    : surface_(surface),
      obstacles_(obstacles),
      mollified_(plan.mollifier.needed),
      precision_(precision),
      far_(surface, precision) {
  if (rules.weighting != ContactWeighting::none) areas_.emplace(surface, obstacles);
  if (rules.weighting == ContactWeighting::area_corrected)
    corrections_.emplace(surface, *areas_, mollified_, precision);
  if (rules.model == ContactModel::offset_geometric) blocks_.emplace(surface);
}

/// Shares of the rows, and the rows that corrections add.
void RowBuilder::apply_rules(const PositionsView& x) {
  const std::span<RowPart> parts(parts_.data(), n_parts_);
  if (blocks_) blocks_->apply(x, mollified_, parts);
  if (!areas_) return;
  for (RowPart& part : parts) {
    for (auto* rows : {&part.rows, &part.mollified}) {
      for (PartRow& each : *rows) each.share = areas_->of(each.pair);
    }
  }
  if (corrections_) corrections_->apply(x, parts, features_, ends_);
}

/// Of what is left of the rows, unless something overlaps.
double RowBuilder::min_gap() const {
  double all = std::numeric_limits<double>::infinity(), left = all;
  for (std::size_t k = 0; k < n_parts_; ++k) all = std::min(all, parts_[k].min_gap);
  if (!blocks_ || all <= 0) return all;
  for (std::size_t k = 0; k < n_parts_; ++k) {
    for (const auto* rows : {&parts_[k].rows, &parts_[k].mollified}) {
      for (const PartRow& each : *rows) left = each.share != 0 ? std::min(left, each.row.d) : left;
    }
  }
  return left;
}

// Every list of pairs in chunks, each into a part of its own: rows stand in the order of the pairs.
void RowBuilder::find_parts(const PositionsView& x, const Candidates& candidates) {
  std::size_t n_parts = 0;
  const auto in_parts = [&](const std::vector<IndexPair>& pairs, const auto& add_range) {
    const std::size_t n = n_chunks(pairs.size());
    if (parts_.size() < n_parts + n) parts_.resize(n_parts + n);
    for_each_chunk(pairs.size(), [&, base = n_parts](std::size_t k, std::size_t begin, std::size_t end) {
      RowPart& part = parts_[base + k];
      part.clear();
      add_range(begin, end, part);
    });
    n_parts += n;
  };
  with_value_scalar(precision_, [&]<class T>() {
    for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
      in_parts(pairs, [&](std::size_t begin, std::size_t end, RowPart& part) {
        add_pairs<K, T>(x, pairs, begin, end, part);
      });
    });
    for_each_obstacle_list(surface_, candidates,
                           [&]<int N>(const Primitives<N>& primitives, const std::vector<IndexPair>& pairs) {
                             in_parts(pairs, [&](std::size_t begin, std::size_t end, RowPart& part) {
                               for (std::size_t i = begin; i < end; ++i)
                                 add_obstacle_pair<N, T>(x, primitives, pairs[i], part);
                             });
                           });
  });
  n_parts_ = n_parts;
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
  pose(obstacles_, x, posed_);
  find_parts(x, candidates);
  apply_rules(x);
  fill_tables(rows, mollified);
  return min_gap();
}

void RowBuilder::near_pairs(Candidates& out) const {
  std::vector<IndexPair>* const lists[] = {&out.point_point, &out.point_edge, &out.point_triangle,
                                           &out.edge_edge};
  for (auto* list : lists) list->clear();
  for (auto* list : {&out.obstacle, &out.obstacle_edge, &out.obstacle_triangle}) list->clear();
  const auto add = [&](PairId id) {
    if (pair_list(id) < obstacle_pairs) lists[pair_list(id)]->push_back({pair_first(id), pair_second(id)});
  };
  for (std::size_t k = 0; k < n_parts_; ++k) {
    for (const PartRow& row : parts_[k].rows) add(row.pair);
    if (blocks_) continue;  // their mollified rows stand among the rows too
    for (const PartRow& row : parts_[k].mollified) add(row.pair);
  }
}

// The parts are in the order of the pairs, and so are the tables.
void RowBuilder::fill_tables(ContactTable& rows, MollifiedTable& mollified) {
  std::vector<const RowPart*> parts;
  if (corrections_) parts.push_back(&features_);
  for (std::size_t k = 0; k < n_parts_; ++k) parts.push_back(&parts_[k]);
  if (corrections_) parts.push_back(&ends_);
  const bool all = !areas_ && !blocks_;
  const auto count = [all](const std::vector<PartRow>& of) {
    if (all) return of.size();
    return static_cast<std::size_t>(
        std::count_if(of.begin(), of.end(), [](const PartRow& each) { return each.share != 0; }));
  };
  first_.assign(1, {0, 0});
  for (const RowPart* part : parts) {
    const First next = first_.back();
    first_.push_back({next.row + count(part->rows), next.mollified + count(part->mollified)});
  }
  rows.resize(first_.back().row);
  mollified.resize(first_.back().mollified);
  rows.share.resize(areas_ ? rows.size() : 0);
  mollified.share.resize(areas_ ? mollified.size() : 0);
  parallel_items(parts.size(), 1, [&](std::size_t k) {
    std::size_t at = first_[k].row;
    for (const PartRow& each : parts[k]->rows) {
      if (!all && each.share == 0) continue;
      if (areas_) rows.share[at] = each.share;
      fill(each.row, each.pair, at++, rows);
    }
    at = first_[k].mollified;
    for (const PartRow& each : parts[k]->mollified) {
      if (!all && each.share == 0) continue;
      if (areas_) mollified.share[at] = each.share;
      const int o = pair_obstacle(each.pair);
      const Vec3d axis_point = o < 0 ? Vec3d(Vec3d::Zero()) : posed_[static_cast<std::size_t>(o)].point;
      fill(each.row, each.pair, axis_point, at++, mollified);
    }
  });
}

}  // namespace bb
