#include "core/contact/bvh.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace bb {

namespace {

constexpr double rebuild_growth = 1.5;
constexpr std::uint32_t width = BoxBlock::width;

constexpr std::size_t n_nodes(std::size_t n) { return (n + width - 1) / width; }

/// Where to cut a run of n > width primitives: in the middle, as far as whole children allow it.
std::size_t left_part(std::size_t n) {
  std::size_t child = width;
  while (child * width < n) child *= width;
  const std::size_t n_children = (n + child - 1) / child;
  return child * (n_children / 2);
}

/// Twice the centre; a box that has none counts as at the origin, for every number must have its place.
Vec3d centre(const Aabb& box) {
  Vec3d out = box.lo + box.hi;
  for (int c = 0; c < 3; ++c) out[c] = std::isnan(out[c]) ? 0 : out[c];
  return out;
}

/// Those lanes of a node that are child `first` or a later one.
LaneSet lanes_from(std::size_t first, std::size_t node) {
  const std::size_t child = node * width;
  return first > child ? ~LaneSet{0} << std::min<std::size_t>(first - child, width) : ~LaneSet{0};
}

}  // namespace

void Bvh::update(std::span<const Aabb> boxes, std::span<const std::uint8_t> free) {
  if (boxes.empty()) {
    order_.clear();
    levels_.clear();
    return;
  }
  if (boxes.size() == order_.size()) {
    refit(boxes, free);
    if (!(looseness() > rebuild_growth * built_looseness_)) return;
  }
  build(boxes);
  refit(boxes, free);
  built_looseness_ = looseness();
}

void Bvh::build(std::span<const Aabb> boxes) {
  std::vector<Vec3d> centres(boxes.size());
  std::transform(boxes.begin(), boxes.end(), centres.begin(), centre);
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), 0);
  split(centres, 0, order_.size());
  levels_.clear();
  for (std::size_t n = boxes.size(); n > 1 || levels_.size() < 2;) {
    n = n_nodes(n);
    levels_.push_back({std::vector<BoxBlock>(n), std::vector<LaneSet>(n)});
  }
  ++builds_;
}

void Bvh::split(std::span<const Vec3d> centres, std::size_t begin, std::size_t end) {
  if (end - begin <= width) return;
  Aabb extent;
  for (std::size_t i = begin; i < end; ++i) extent.add(centres[static_cast<std::size_t>(order_[i])]);
  int axis = 0;
  (extent.hi - extent.lo).maxCoeff(&axis);
  const std::size_t middle = begin + left_part(end - begin);
  const auto at = [this](std::size_t place) { return order_.begin() + static_cast<std::ptrdiff_t>(place); };
  std::nth_element(at(begin), at(middle), at(end), [&](int p, int q) {
    const double a = centres[static_cast<std::size_t>(p)][axis];
    const double b = centres[static_cast<std::size_t>(q)][axis];
    return a < b || (a == b && p < q);
  });
  split(centres, begin, middle);
  split(centres, middle, end);
}

template <class BoxOf, class IsFree>
void Bvh::Level::fill(std::size_t n, const BoxOf& box_of, const IsFree& is_free) {
  for_each_chunk(boxes.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      free[node] = 0;
      for (std::size_t child = node * width; child < std::min(n, (node + 1) * width); ++child) {
        boxes[node].set(child % width, box_of(child));
        free[node] |= static_cast<LaneSet>(is_free(child)) << (child % width);
      }
    }
  });
}

void Bvh::refit(std::span<const Aabb> boxes, std::span<const std::uint8_t> free) {
  const auto at = [&](std::size_t place) { return static_cast<std::size_t>(order_[place]); };
  levels_[0].fill(
      order_.size(), [&](std::size_t place) { return boxes[at(place)]; },
      [&](std::size_t place) { return free[at(place)] != 0; });
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    const Level& below = levels_[l - 1];
    levels_[l].fill(
        below.boxes.size(), [&](std::size_t node) { return below.boxes[node].hull(); },
        [&](std::size_t node) { return below.free[node] != 0; });
  }
}

std::span<const PlacePair> Bvh::overlaps(const Bvh& asking, std::size_t begin, std::size_t end,
                                         PairSearch& search) const {
  assert(begin % width == 0 && (end % width == 0 || end == asking.size()));
  if (levels_.empty()) return {};
  const bool self = this == &asking;
  // nodes of level 0 against the tree, down to its nodes of level 0
  search.start(begin / width, n_nodes(end));
  for (std::size_t l = levels_.size() - 1; l > 0; --l) {
    search.refine([&](PlacePair at) {
      LaneSet lanes = levels_[l].overlaps(at.asked, asking.levels_[1], at.asking);
      if (self) lanes &= lanes_from(std::size_t{width} * at.asking >> (3 * l), at.asked);
      search.add(lanes, [=](std::uint32_t k) { return PlacePair{at.asking, width * at.asked + k}; });
    });
  }
  // the places of those nodes one by one
  search.refine([&](PlacePair at) {
    const LaneSet lanes = asking.levels_[0].overlaps(at.asking, levels_[1], at.asked);
    search.add(lanes, [=](std::uint32_t k) { return PlacePair{width * at.asking + k, at.asked}; });
  });
  // against the places of these
  search.refine([&](PlacePair at) {
    LaneSet lanes = levels_[0].overlaps(at.asked, asking.levels_[0], at.asking);
    if (self) lanes &= lanes_from(std::size_t{at.asking} + 1, at.asked);
    search.add(lanes, [=](std::uint32_t k) { return PlacePair{at.asking, width * at.asked + k}; });
  });
  return search.result();
}

double Bvh::looseness() const {
  double nodes = 0, primitives = 0;
  std::size_t n = order_.size();
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    double& sum = l == 0 ? primitives : nodes;
    for (std::size_t child = 0; child < n; ++child) sum += levels_[l].box(child).half_area();
    n = levels_[l].boxes.size();
  }
  return primitives > 0 ? nodes / primitives : 0;
}

void PairFinder::gather(std::size_t n_parts, std::size_t n, std::vector<IndexPair>& pairs) {
  const auto for_each_pair = [&](const auto& f) {
    for (std::size_t k = 0; k < n_parts; ++k) {
      for (const IndexPair& pair : parts_[k].pairs) f(pair);
    }
  };
  // By the first member: count, then every pair to its place; then each run by the second member.
  end_.assign(n + 1, 0);
  for_each_pair([&](IndexPair pair) { ++end_[static_cast<std::size_t>(pair.first) + 1]; });
  std::partial_sum(end_.begin(), end_.end(), end_.begin());
  pairs.resize(end_.back());
  for_each_pair([&](IndexPair pair) { pairs[end_[static_cast<std::size_t>(pair.first)]++] = pair; });
  for_each_chunk(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    const auto at = [&](std::size_t place) { return pairs.begin() + static_cast<std::ptrdiff_t>(place); };
    for (std::size_t first = begin; first < end; ++first) {
      std::sort(at(first == 0 ? 0 : end_[first - 1]), at(end_[first]));
    }
  });
}

}  // namespace bb
