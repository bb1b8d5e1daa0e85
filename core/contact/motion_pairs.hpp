// All pairs that stop a motion, each with its own time, and the gap of a pair as a linear function of positions: what a step
// solver needs that lets its iterates overlap and keeps another state free of contact.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/contact/candidates.hpp"
#include "core/contact/contact_system.hpp"
#include "core/contact/pair_id.hpp"

namespace bb {

/// The gap of a pair at a state and its gradient there: grad_i d = weight_i normal. However far the pair is apart.
struct LinearGap {
  std::array<int, 4> vertex{-1, -1, -1, -1};  // free ones only, -1 padded
  std::array<double, 4> weight{0, 0, 0, 0};
  Vec3d normal = Vec3d::Zero();
  double d = 0;      // m
  double d_hat = 0;  // m, activation distance of the pair, the rest rule included
};

/// A pair that would come as near as ACCD stops before the motion is over.
struct MotionHit {
  PairId pair = 0;
  std::array<int, 4> vertex{-1, -1, -1, -1};  // all of its primitives, -1 padded
  double time = 1;                            // in [0, 1)
};

/// Pairs as ContactSystem has them, in double. Results do not depend on the number of threads; not thread-safe, parallel
/// inside. The scene must outlive it. Obstacles that move and collisions of chosen bodies are not known here.
class MotionPairs {
 public:
  MotionPairs(const Scene& scene, const ContactOptions& options, const ContactPlan& plan);

  /// Of a pair that was a hit, at x [3 x n] m. Requires d > 0 for a normal.
  LinearGap gap(PairId pair, const PositionsView& x) const;
  /// Of all pairs of the motion x0 -> x1 [3 x n] m, in the order of their ids. Requires finite positions. Cost: ACCD of every
  /// pair whose boxes meet.
  const std::vector<MotionHit>& hits(const PositionsView& x0, const PositionsView& x1);
  /// Of the last hits(): counters, and the earliest of them with its name; alpha 1 without one.
  const StepBound& earliest() const { return earliest_; }

 private:
  struct Part {
    std::vector<MotionHit> hits;
    StepBound counted;
  };
  template <PairKind K>
  void ask(IndexPair pair, const PositionsView& x0, const PositionsView& x1, Part& part) const;
  template <int N>
  void ask_obstacle(const Primitives<N>& primitives, IndexPair pair, const PositionsView& x0,
                    const PositionsView& x1, Part& part) const;
  void take(const std::vector<Part>& parts);

  const ContactOptions options_;
  const Surface surface_;
  const std::vector<AnalyticSurface<double>> obstacles_;
  BroadPhase broad_phase_;
  Candidates candidates_;
  std::vector<MotionHit> hits_;
  StepBound earliest_;
};

}  // namespace bb
