// A start that is to be repaired, as the methods of repair read it: what can move, what hangs together, what has to stay
// apart by how much. Nothing here knows of an earlier state.
#pragma once

#include <array>
#include <vector>

#include "core/audit/surface.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/start/half_spaces.hpp"
#include "experiments/start/near_pairs.hpp"

namespace bb {

/// How a start is repaired.
struct RepairOptions {
  double gap_fraction = 0.1;  // of d_hat, that every pair has afterwards; in (0, 1)
  double stretch = 0.1;       // by which an edge may be longer or shorter afterwards, at most; > 0
  int most_iterations = 400;  // of one method
};

/// The scene with its start, the masses and pieces that can move, and what is measured of a state of it.
class Tangle {
 public:
  /// config and scene must outlive it.
  Tangle(const RunConfig& config, const Scene& scene, const RepairOptions& options);

  const Scene& scene;
  const RepairOptions options;
  const audit::AuditMesh mesh;
  std::vector<double> inverse_mass;  // [n] 1/kg; 0: prescribed at some time, so that it never moves
  std::vector<int> component;        // [n] of what hangs together by elements, from 0
  int n_components = 0;
  std::vector<double> component_mass;  // kg; infinite where a vertex never moves

  const Positions& start() const { return scene.x0; }
  bool movable(int c) const;
  /// The component of a pair's first primitive and that of its second, -1: an obstacle.
  std::array<int, 2> components_of(const audit::PairName& pair) const;

  /// No edge through a triangle, nothing beyond an obstacle: the audit of the state x.
  bool clean(const Positions& x) const;
  /// Every pair has a gap above 0 once thickness is taken off.
  bool apart(const Positions& x);
  /// The smallest gap of all pairs over what they have to have, m; >= 0: every pair has it.
  double slack(const Positions& x);
  /// The largest relative change of an edge's length since the start.
  double strain(const Positions& x) const;
  /// Half-spaces at x: every pair that may come too near on the way to x1 keeps its gap, every edge its length.
  std::vector<HalfSpace> sides(const Positions& x, const Positions& x1);
  /// Those of the edges alone.
  void add_lengths(const Positions& x, std::vector<HalfSpace>& out) const;
  /// sum_v m_v |x_v - start_v|^2, kg m^2.
  double cost(const Positions& x) const;
  /// The largest gap that a pair of the scene has to have, thickness included, m.
  double widest_gap() const;
  /// m, the mean length of the edges.
  double mean_edge() const { return mean_edge_; }

 private:
  void find_components();
  void find_edges();

  NearPairs near_;
  std::vector<std::array<int, 2>> edges_;
  std::vector<double> length_;  // m, of the start
  double mean_edge_ = 0;
};

}  // namespace bb
