// Bounding volume hierarchy over boxes: built once, refitted between iterations, rebuilt by a deterministic
// rule; a tree asked with every box of another gives the overlapping pairs. Knows boxes and no physics.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/contact/box_block.hpp"
#include "core/contact/chunks.hpp"

namespace bb {

/// A pair of primitives by index.
struct IndexPair {
  int first, second;
  friend auto operator<=>(const IndexPair&, const IndexPair&) = default;
};

/// A place in the order of one tree and a place in that of another, or, on the way there, a node.
struct PlacePair {
  std::uint32_t asking, asked;
};

/// Buffers of a search: the pairs found so far, which every step of it replaces by what they lead to.
class PairSearch {
 public:
  /// All of [begin, end) with 0.
  void start(std::size_t begin, std::size_t end) {
    n_found_ = end - begin;
    if (found_.size() < n_found_) found_.resize(n_found_);
    for (std::size_t i = begin; i < end; ++i) found_[i - begin] = {static_cast<std::uint32_t>(i), 0};
  }
  /// Calls step(pair) for all pairs, which add()s their successors.
  template <class Step>
  void refine(const Step& step) {
    n_next_ = 0;
    for (std::size_t i = 0; i < n_found_; ++i) step(found_[i]);
    found_.swap(next_);
    n_found_ = n_next_;
  }
  /// Adds make(k) for every lane k. Which lanes are set is hard to foretell, so up to four take no branch.
  template <class Make>
  void add(LaneSet lanes, const Make& make) {
    if (next_.size() < n_next_ + BoxBlock::width) next_.resize(2 * (n_next_ + BoxBlock::width));
    const auto n = static_cast<std::size_t>(std::popcount(lanes));
    PlacePair* const next = &next_[n_next_];
    const auto put = [&](std::size_t i) {
      next[i] = make(static_cast<std::uint32_t>(std::countr_zero(lanes)));
      lanes &= lanes - 1;
    };
    for (std::size_t i = 0; i < 4; ++i) put(i);
    for (std::size_t i = 4; i < n; ++i) put(i);
    n_next_ += n;
  }
  std::span<const PlacePair> result() const { return {found_.data(), n_found_}; }

 private:
  std::vector<PlacePair> found_, next_;  // larger than what they hold
  std::size_t n_found_ = 0, n_next_ = 0;
};

/// Tree with eight children a node and no links: the primitives are put in an order by median splits along
/// the widest axis of the box centres; nodes of level 0 hold eight primitives each, in that order, and nodes
/// of every other level hold the boxes of eight nodes of the level below. The last level is one node.
class Bvh {
 public:
  /// Takes the boxes of all n primitives; `free` says which of them a solver can move. The first call, and a
  /// call with another n, builds: O(n log n). Later calls refit, O(n), and rebuild when the boxes of the
  /// nodes, relative to those of the primitives, have grown by more than a half since the last build.
  void update(std::span<const Aabb> boxes, std::span<const std::uint8_t> free);

  std::size_t size() const { return order_.size(); }
  /// The primitive at a place of the order.
  int primitive(std::size_t place) const { return order_[place]; }
  int builds() const { return builds_; }

  /// All (place in `asking`, place in this tree) with overlapping boxes, of which at least one is free, for
  /// the places [begin, end) of `asking`: begin a multiple of eight, end too unless it is asking.size(), for
  /// whole nodes are asked. When that is this tree itself, only pairs of ascending places. The result lies
  /// in the buffers.
  std::span<const PlacePair> overlaps(const Bvh& asking, std::size_t begin, std::size_t end,
                                      PairSearch& search) const;

 private:
  struct Level {
    std::vector<BoxBlock> boxes;
    std::vector<LaneSet> free;  // lanes with a free primitive
    /// Takes over n children.
    template <class BoxOf, class IsFree>
    void fill(std::size_t n, const BoxOf& box_of, const IsFree& is_free);
    Aabb box(std::size_t child) const { return boxes[child / BoxBlock::width].get(child % BoxBlock::width); }
    /// Children of a node that overlap a child of another level, one of the two with a free primitive.
    LaneSet overlaps(std::size_t node, const Level& other, std::size_t child) const {
      const std::size_t block = child / BoxBlock::width, lane = child % BoxBlock::width;
      const LaneSet one_free = ((other.free[block] >> lane) & 1) != 0 ? ~LaneSet{0} : free[node];
      return boxes[node].overlaps(other.boxes[block], lane) & one_free;
    }
  };
  void build(std::span<const Aabb> boxes);
  void split(std::span<const Vec3d> centres, std::size_t begin, std::size_t end);
  void refit(std::span<const Aabb> boxes, std::span<const std::uint8_t> free);
  double looseness() const;

  std::vector<int> order_;
  std::vector<Level> levels_;
  double built_looseness_ = 0;
  int builds_ = 0;
};

/// Finds overlapping pairs; keeps its buffers between calls. Not thread-safe, parallel inside.
class PairFinder {
 public:
  /// All pairs (primitive of a, primitive of b) whose boxes overlap, of which at least one is free, and for
  /// which keep(pair) holds. Sorted, so independent of threads and of the shape of the trees. When a and b
  /// are the same object each unordered pair comes once, first < second.
  template <class Keep>
  void find(const Bvh& a, const Bvh& b, const Keep& keep, std::vector<IndexPair>& pairs) {
    static_assert(chunk_size % BoxBlock::width == 0);
    const bool self = &a == &b;
    const std::size_t n_parts = n_chunks(a.size());
    if (parts_.size() < n_parts) parts_.resize(n_parts);
    for_each_chunk(a.size(), [&](std::size_t k, std::size_t begin, std::size_t end) {
      Part& part = parts_[k];
      const std::span<const PlacePair> found = b.overlaps(a, begin, end, part.search);
      part.pairs.resize(found.size());
      std::size_t n = 0;
      for (const PlacePair place : found) {  // which pairs are kept is hard to foretell: no branch
        IndexPair pair{a.primitive(place.asking), b.primitive(place.asked)};
        if (self && pair.first > pair.second) std::swap(pair.first, pair.second);
        part.pairs[n] = pair;
        n += keep(pair) ? 1 : 0;
      }
      part.pairs.resize(n);
    });
    gather(n_parts, a.size(), pairs);
  }

 private:
  /// All parts into `pairs`, sorted; n: the first members are below it.
  void gather(std::size_t n_parts, std::size_t n, std::vector<IndexPair>& pairs);

  struct Part {
    std::vector<IndexPair> pairs;
    PairSearch search;
  };
  std::vector<Part> parts_;
  std::vector<std::size_t> end_;  // of the pairs with the same first member
};

}  // namespace bb
