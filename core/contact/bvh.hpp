// Bounding volume hierarchy over boxes: built once, refitted between iterations, rebuilt by a deterministic
// rule; a tree queried with every box of another gives the overlapping pairs. Knows boxes and no physics.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/contact/box_block.hpp"
#include "core/contact/chunks.hpp"

namespace bb {

/// A pair of primitives by index.
struct IndexPair {
  int first, second;
  friend auto operator<=>(const IndexPair&, const IndexPair&) = default;
};

/// A list that only grows by whole vectors: as long as what was written to it, with some spare capacity.
class LaneList {
 public:
  void clear() { n_ = 0; }
  std::size_t size() const { return n_; }
  std::span<const int> all() const { return {numbers_.data(), n_}; }
  /// Where the next numbers go, with capacity for `room` and a vector; `added` sets how many there were.
  int* end(std::size_t room) {
    if (numbers_.size() < n_ + room + BoxBlock::width) numbers_.resize(2 * (n_ + room + BoxBlock::width));
    return numbers_.data() + n_;
  }
  void added(std::size_t n) { n_ += n; }

 private:
  std::vector<int> numbers_;
  std::size_t n_ = 0;
};

/// Buffers of a search with the eight primitives of a node.
struct TreeSearch {
  LaneList nodes, next;
  std::array<LaneList, BoxBlock::width> nodes_of;  // those that each of the eight overlaps
};

/// Tree with eight children a node and no links: the primitives are put in an order by median splits along
/// the widest axis of the box centres; nodes of level 0 hold eight primitives each, in that order, and nodes
/// of every other level hold the boxes of eight nodes of the level below. The last level is one node.
class Bvh {
 public:
  /// Takes the boxes of all n primitives; `free` says which of them a solver can move; `reach` what each box was grown
  /// by on every side, m, or empty: boxes that meet are all that is requested. The first call, and a
  /// call with another n, builds: O(n log n). Later calls refit, O(n), and rebuild when the boxes of the
  /// nodes, relative to those of the primitives, have grown by more than a half since the last build.
  void update(std::span<const TreeBox> boxes, std::span<const std::uint8_t> free,
              std::span<const float> reach = {});

  std::size_t size() const { return n_; }
  /// The primitive at a place of the order.
  int primitive(std::size_t place) const { return order_[place / BoxBlock::width][place % BoxBlock::width]; }
  int builds() const { return builds_; }

  /// Nodes of level 0 of this tree that overlap node `node` of level 0 of `asking`, and then each of its
  /// primitives: search.nodes_of. One of any two with a free primitive.
  void find_nodes(const Bvh& asking, std::size_t node, TreeSearch& search) const;
  /// Appends to `found` the primitives of those nodes that overlap primitive `lane` of the node and are not proven
  /// apart from it by their reaches, one of the two free; when `asking` is this tree itself, only those with a larger index. Returns how many.
  std::size_t find_primitives(const Bvh& asking, std::size_t node, std::size_t lane, const TreeSearch& search,
                              LaneList& found) const;

 private:
  struct Level {
    std::vector<BoxBlock> boxes;
    std::vector<LaneSet> free;  // lanes with a free primitive
    /// Takes over n children.
    template <class BoxOf, class IsFree>
    void fill(std::size_t n, const BoxOf& box_of, const IsFree& is_free);
    bool is_free(std::size_t child) const {
      return (free[child / BoxBlock::width] >> child % BoxBlock::width & 1) != 0;
    }
    AskingBox asking(std::size_t child) const {
      return boxes[child / BoxBlock::width].asking(child % BoxBlock::width);
    }
    /// Children of a node that overlap a box, one of the two with a free primitive.
    LaneSet overlaps(std::size_t node, const AskingBox& box, bool box_is_free) const {
      return boxes[node].overlaps(box) & (box_is_free ? ~LaneSet{0} : free[node]);
    }
  };
  void build(std::span<const TreeBox> boxes);
  void split(std::span<const Vec3d> centres, std::span<int> places);
  void refit(std::span<const TreeBox> boxes, std::span<const std::uint8_t> free,
             std::span<const float> reach);
  double looseness() const;

  std::size_t n_ = 0;
  std::vector<EightInts> order_;    // by node, 0 padded
  std::vector<EightFloats> reach_;  // m, likewise
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
    if (parts_.size() < n_chunks(a.size())) parts_.resize(n_chunks(a.size()));
    begin_.assign(a.size() + 1, 0);
    for_each_chunk(a.size(), [&](std::size_t k, std::size_t begin, std::size_t end) {
      Part& part = parts_[k];
      part.seconds.clear();
      for (std::size_t place = begin; place < end; ++place) {
        const std::size_t node = place / BoxBlock::width, lane = place % BoxBlock::width;
        if (lane == 0) b.find_nodes(a, node, part.search);
        const int first = a.primitive(place);
        const std::size_t n = b.find_primitives(a, node, lane, part.search, part.seconds);
        int* const seconds = part.seconds.end(0);
        std::size_t n_kept = 0;
        for (std::size_t i = 0; i < n; ++i) {  // which pairs are kept is hard to foretell: no branch
          const int second = seconds[i];
          seconds[n_kept] = second;
          n_kept += keep(IndexPair{first, second}) ? 1 : 0;
        }
        part.seconds.added(n_kept);
        begin_[static_cast<std::size_t>(first) + 1] = n_kept;
      }
    });
    gather(a, pairs);
  }

 private:
  /// All parts into `pairs`, sorted.
  void gather(const Bvh& a, std::vector<IndexPair>& pairs);

  struct Part {
    LaneList seconds;  // of the pairs of each place, in the order of the places
    TreeSearch search;
  };
  std::vector<Part> parts_;
  std::vector<std::size_t> begin_;  // of the pairs with the same first member
};

}  // namespace bb
