// Pairs of primitives that are near in one state, each with the linear form of its gap: what `check` lists and what the
// repair of a start keeps apart. The pairs, distances and thickness are those of contact.
#pragma once

#include <array>
#include <vector>

#include "core/contact/candidates.hpp"
#include "core/contact/contact_table.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// A pair with its gap and, to first order in the positions of its vertices, how the gap changes:
///   change of gap = sum_k weight[k] normal . (change of vertex[k]).
struct NearPair {
  ContactKind kind = ContactKind::point_point;
  std::array<int, 4> vertex{-1, -1, -1, -1};  // of the first primitive, then of the second; -1 padded
  std::array<double, 4> weight{};
  int obstacle = -1;
  Vec3d normal = Vec3d::Zero();  // unit; zero where the pair touches
  Vec3d place = Vec3d::Zero();   // closest point of the first primitive, m
  double gap = 0;                // m, thickness taken off
  double d_hat = 0;              // m, of this pair: that of the rest rule where it holds

  ContactKey key() const;
};

class NearPairs {
 public:
  /// The scene must outlive it.
  NearPairs(const RunConfig& config, const Scene& scene);

  /// Pairs that share no vertex, of which one can move, with a gap at x below d_hat + reach (m), of all that the motion
  /// from x to x1 may bring within d_hat. In a fixed order.
  std::vector<NearPair> find(const Positions& x, const Positions& x1, double reach);
  std::vector<NearPair> find(const Positions& x) { return find(x, x, 0); }

 private:
  template <PairKind K>
  void add(const Positions& x, IndexPair index, double reach, std::vector<NearPair>& out) const;
  template <int N>
  void add_obstacle(const Primitives<N>& primitives, const Positions& x, IndexPair index, double reach,
                    std::vector<NearPair>& out) const;

  Surface surface_;
  std::vector<AnalyticSurface<double>> obstacles_;
  BroadPhase broad_phase_;
  Candidates candidates_;
};

}  // namespace bb
