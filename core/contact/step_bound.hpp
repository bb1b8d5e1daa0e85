// The largest step along a straight motion that is proven free of contact.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/candidates.hpp"
#include "core/contact/chunks.hpp"
#include "core/contact/contact_table.hpp"
#include "core/contact/motion_box.hpp"
#include "core/contact/pair_geometry.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// Largest step alpha in [0, 1] along x0 -> x1 that is proven free of contact below the stop level.
struct StepBound {
  double alpha = 1;
  ContactKind kind = ContactKind::obstacle;  // of the limiting pair; key below
  ContactKey key{-1, -1, -1, -1};
  long long queries = 0, probes = 0, capped = 0, zero = 0;  // ACCD pairs queried, probes, cap hits, toi == 0
};

/// Where ACCD stops.
struct StopLevel {
  double park;     // in units of d_hat
  int max_probes;  // of one pair
};

/// A contact that stops a motion: when, and its place in the order of the candidates.
struct FirstContact {
  double toi = 1;
  int list = 0;  // the kinds of PairKind in their order, then obstacles with points, edges, triangles
  std::size_t index = 0;

  /// The earlier one stops the motion; on a tie the first in the order of the candidates.
  bool before(const FirstContact& other) const {
    if (toi != other.toi) return toi < other.toi;
    return toi < 1 && (list != other.list ? list < other.list : index < other.index);
  }
};

/// Finds the bound of a motion. Only the smallest time counts, so few pairs are queried for theirs: boxes of
/// motions (motion_box.hpp), then planes (pair_lanes.hpp), prove of most of them that they come later than the
/// smallest time known. Pairs of which little is proven go first. Alpha and the pair that limits are those of
/// querying every candidate, bit for bit, unless a query runs out of probes. Batches of pairs come in a fixed
/// order and know the times of the batches before: counters too are the same for any number of threads. Keeps
/// its buffers; not thread-safe, parallel inside.
class StepBoundFinder {
 public:
  StepBoundFinder(const Surface& surface, const std::vector<AnalyticSurface<double>>& obstacles,
                  const StopLevel& level, Precision precision = Precision::full)
      : surface_(surface), obstacles_(obstacles), level_(level), precision_(precision) {}

  /// Of all candidates. A motion with an end that is not finite has the bound 0.
  StepBound find(const Candidates& candidates, const PositionsView& x0, const PositionsView& x1);

 private:
  /// A pair that boxes do not clear for the whole motion.
  struct Entry {
    std::uint16_t place;  // in its chunk: lists may be of any length
    float proven;         // time before which its boxes are apart
  };
  /// What a chunk of pairs found.
  struct Part {
    FirstContact first;
    long long queries = 0, probes = 0, capped = 0, zero = 0;
  };
  struct Motion {
    PositionsView x0, x1;
  };
  template <std::size_t N>
  double floor(const std::array<int, N>& vertices, double offset, double park) const;
  void find_floors(const Motion& motion);
  template <int N>
  void fit(std::vector<MotionBox>& boxes, const Primitives<N>& primitives, const Motion& motion) const;
  template <PairKind K>
  void screen(const std::vector<IndexPair>& pairs);
  template <PairKind K>
  void ask_batches(const std::vector<IndexPair>& pairs, const Motion& motion, float above, float up_to);
  template <PairKind K>
  void ask_chunk(const std::vector<IndexPair>& pairs, const Motion& motion, float above, float up_to,
                 std::size_t chunk, Part& part) const;
  template <PairKind K>
  void ask_lanes(const std::vector<IndexPair>& pairs, const Motion& motion,
                 const std::array<std::size_t, 4>& index, std::size_t n, Part& part) const;
  template <PairKind K, class T>
  void ask(const ContactPair<K>& pair, std::size_t index, const Motion& motion, Part& part) const;
  template <int N, class T>
  void ask_obstacles(const Primitives<N>& primitives, const std::vector<IndexPair>& pairs,
                     const Motion& motion);
  template <int N, class T>
  FirstContact ask_obstacle(const Primitives<N>& primitives, IndexPair pair, std::size_t index,
                            const Motion& motion, Part& part) const;
  void take(const Part& part);
  StepBound result(const Candidates& candidates) const;

  const Surface& surface_;
  const std::vector<AnalyticSurface<double>>& obstacles_;
  const StopLevel level_;
  const Precision precision_;
  std::vector<double> floors_;  // m, of each vertex on the motion
  double largest_floor_ = 0;
  std::vector<MotionBox> points_, edges_, triangles_;
  std::vector<Entry> entries_[4];            // by kind: chunk k of the pairs has its own from k chunk_size on
  std::vector<std::uint32_t> n_entries_[4];  // of each chunk
  std::vector<Part> parts_;
  Part all_;
};

}  // namespace bb
