#include "core/contact/bvh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "core/contact/box_gap.hpp"
#include "core/math/at.hpp"

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
Vec3d centre(const TreeBox& box) {
  Vec3d out;
  for (int c = 0; c < 3; ++c) {
    const double sum = static_cast<double>(box.lo[c]) + static_cast<double>(box.hi[c]);
    out[c] = std::isnan(sum) ? 0 : sum;
  }
  return out;
}

/// Appends the children of a node that are in a set.
void add_children(LaneList& list, int node, LaneSet lanes) {
  constexpr EightInts child = {0, 1, 2, 3, 4, 5, 6, 7};
  list.added(pack(child + static_cast<int>(width) * node, lanes, list.end(0)));
}

}  // namespace

LaneSet BoxBlock::apart(const AskingBox& box, const EightFloats& reach) const {
  return lanes_of(apart_by_boxes<EightFloats>(lo_, hi_, box.lo, box.hi, reach));
}

void Bvh::update(std::span<const TreeBox> boxes, std::span<const std::uint8_t> free,
                 std::span<const float> reach) {
  if (boxes.empty()) {
    n_ = 0;
    order_.clear();
    levels_.clear();
    return;
  }
  if (boxes.size() == n_) {
    refit(boxes, free, reach);
    if (!(looseness() > rebuild_growth * built_looseness_)) return;
  }
  build(boxes);
  refit(boxes, free, reach);
  built_looseness_ = looseness();
}

void Bvh::build(std::span<const TreeBox> boxes) {
  n_ = boxes.size();
  std::vector<Vec3d> centres(n_);
  std::transform(boxes.begin(), boxes.end(), centres.begin(), centre);
  std::vector<int> places(n_);
  std::iota(places.begin(), places.end(), 0);
  split(centres, places);
  order_.assign(n_nodes(n_), EightInts{});
  for (std::size_t place = 0; place < n_; ++place) order_[place / width][place % width] = places[place];
  levels_.clear();
  for (std::size_t n = n_; n > 1 || levels_.size() < 2;) {
    n = n_nodes(n);
    levels_.push_back({std::vector<BoxBlock>(n), std::vector<LaneSet>(n)});
  }
  ++builds_;
}

void Bvh::split(std::span<const Vec3d> centres, std::span<int> places) {
  if (places.size() <= width) return;
  Vec3d lo = centres[at(places[0])], hi = lo;
  for (const int p : places) {
    lo = lo.cwiseMin(centres[at(p)]);
    hi = hi.cwiseMax(centres[at(p)]);
  }
  int axis = 0;
  (hi - lo).maxCoeff(&axis);
  const std::size_t middle = left_part(places.size());
  std::nth_element(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(middle), places.end(),
                   [&](int p, int q) {
                     const double a = centres[at(p)][axis], b = centres[at(q)][axis];
                     return a < b || (a == b && p < q);
                   });
  split(centres, places.first(middle));
  split(centres, places.subspan(middle));
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

void Bvh::refit(std::span<const TreeBox> boxes, std::span<const std::uint8_t> free,
                std::span<const float> reach) {
  levels_[0].fill(
      n_, [&](std::size_t place) { return boxes[at(primitive(place))]; },
      [&](std::size_t place) { return free[at(primitive(place))] != 0; });
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    const Level& below = levels_[l - 1];
    levels_[l].fill(
        below.boxes.size(), [&](std::size_t node) { return below.boxes[node].hull(); },
        [&](std::size_t node) { return below.free[node] != 0; });
  }
  reach_.assign(order_.size(), EightFloats{});
  for (std::size_t place = 0; place < reach.size(); ++place) {
    reach_[place / width][place % width] = reach[at(primitive(place))];
  }
}

void Bvh::find_nodes(const Bvh& asking, std::size_t node, TreeSearch& search) const {
  search.nodes.clear();
  for (LaneList& list : search.nodes_of) list.clear();
  if (levels_.empty()) return;
  const AskingBox box = asking.levels_[1].asking(node);
  const bool is_free = asking.levels_[1].is_free(node);
  *search.nodes.end(1) = 0;
  search.nodes.added(1);
  for (std::size_t l = levels_.size() - 1; l > 0; --l) {
    search.next.clear();
    for (const int at_node : search.nodes.all()) {
      add_children(search.next, at_node, levels_[l].overlaps(at(at_node), box, is_free));
    }
    std::swap(search.nodes, search.next);
  }
  int* end[width];
  for (std::size_t k = 0; k < width; ++k) end[k] = search.nodes_of[k].end(search.nodes.size());
  for (const int leaf : search.nodes.all()) {
    const AskingBox leaf_box = levels_[1].asking(at(leaf));
    const LaneSet lanes = asking.levels_[0].overlaps(node, leaf_box, levels_[1].is_free(at(leaf)));
    for (std::size_t k = 0; k < width; ++k) {  // hard to foretell: no branch
      *end[k] = leaf;
      end[k] += lanes >> k & 1;
    }
  }
  for (std::size_t k = 0; k < width; ++k) {
    search.nodes_of[k].added(static_cast<std::size_t>(end[k] - search.nodes_of[k].end(0)));
  }
}

std::size_t Bvh::find_primitives(const Bvh& asking, std::size_t node, std::size_t lane,
                                 const TreeSearch& search, LaneList& found) const {
  const std::span<const int> nodes = search.nodes_of[lane].all();
  const AskingBox box = asking.levels_[0].boxes[node].asking(lane);
  const bool is_free = (asking.levels_[0].free[node] >> lane & 1) != 0;
  const EightFloats reach = asking.reach_[node][lane] - EightFloats{};
  const EightInts above = (this == &asking ? asking.order_[node][lane] : -1) - EightInts{};
  int* const begin = found.end(width * nodes.size());
  int* end = begin;
  for (const int leaf : nodes) {
    const EightInts order = order_[at(leaf)];
    const LaneSet lanes = levels_[0].overlaps(at(leaf), box, is_free) & lanes_of(order > above) &
                          ~levels_[0].boxes[at(leaf)].apart(box, reach + reach_[at(leaf)]);
    end += pack(order, lanes, end);
  }
  return static_cast<std::size_t>(end - begin);
}

double Bvh::looseness() const {
  double nodes = 0, primitives = 0;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    double& sum = l == 0 ? primitives : nodes;
    for (const BoxBlock& block : levels_[l].boxes) sum += block.half_area();
  }
  return primitives > 0 ? nodes / primitives : 0;
}

namespace {

/// Writes the pairs of `first` in the order of their second members, which are not negative: by one digit after another, the last one
/// first. `room` is scratch.
void put_by_digits(int first, std::span<const int> seconds, std::vector<int>& room, IndexPair* out) {
  constexpr int digit_bits = 6, largest_digit = (1 << digit_bits) - 1;
  const std::size_t n = seconds.size();
  int unlike = 0;  // bits that are not the same in all
  for (const int second : seconds) unlike |= second ^ seconds[0];
  room.resize(2 * n);
  const int* from = seconds.data();
  int *to = room.data(), *next = to + n;
  for (int shift = 0; shift < 31 && (unlike >> shift) != 0; shift += digit_bits) {
    std::uint32_t place[largest_digit + 2] =
        {};  // of the digit before, then where the next number of a digit goes
    for (std::size_t i = 0; i < n; ++i) ++place[at(from[i] >> shift & largest_digit) + 1];
    for (std::size_t digit = 1; digit <= largest_digit; ++digit) place[digit] += place[digit - 1];
    for (std::size_t i = 0; i < n; ++i) to[place[at(from[i] >> shift & largest_digit)]++] = from[i];
    from = to;
    std::swap(to, next);
  }
  for (std::size_t i = 0; i < n; ++i) out[i] = {first, from[i]};
}

/// The same; the second members are all different. Every second of a short list counts those below it: faster than any sort that branches.
void put_sorted(int first, std::span<const int> seconds, std::vector<int>& room, IndexPair* out) {
  constexpr std::size_t countable = 64;
  const std::size_t n = seconds.size();
  if (n > countable) return put_by_digits(first, seconds, room, out);
  for (std::size_t begin = 0; begin < n; begin += width) {
    EightInts eight{}, rank{};
    const std::size_t m = std::min<std::size_t>(width, n - begin);
    for (std::size_t k = 0; k < m; ++k) eight[k] = seconds[begin + k];
    for (const int other : seconds) rank -= other < eight;
    for (std::size_t k = 0; k < m; ++k) out[rank[k]] = {first, eight[k]};
  }
}

}  // namespace

void PairFinder::gather(const Bvh& a, std::vector<IndexPair>& pairs) {
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  pairs.resize(begin_.back());
  for_each_chunk(a.size(), [&](std::size_t k, std::size_t begin, std::size_t end) {
    std::span<const int> seconds = parts_[k].seconds.all();
    std::vector<int> room;
    for (std::size_t place = begin; place < end; ++place) {
      const int first = a.primitive(place);
      const std::size_t n = begin_[at(first) + 1] - begin_[at(first)];
      put_sorted(first, seconds.first(n), room, pairs.data() + begin_[at(first)]);
      seconds = seconds.subspan(n);
    }
  });
}

}  // namespace bb
