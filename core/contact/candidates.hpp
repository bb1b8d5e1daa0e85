// Broad phase of a scene: which pairs of primitives may come within their contact distance on a motion.
#pragma once

#include <vector>

#include "core/contact/bvh.hpp"
#include "core/contact/folded_axis.hpp"
#include "core/contact/obstacle.hpp"
#include "core/contact/surface.hpp"
#include "core/math/precision.hpp"
#include "core/model/scene/contact_plan.hpp"

namespace bb {

/// Pairs by index into the primitive lists of Surface, each list sorted; obstacle: (point, obstacle), obstacle_edge and
/// obstacle_triangle likewise.
struct Candidates {
  std::vector<IndexPair> point_point, point_edge, point_triangle, edge_edge, obstacle, obstacle_edge,
      obstacle_triangle;
  /// Of pairs of bodies whose states are tested (CollisionKind::static_test): what may intersect, beside the above.
  std::vector<IndexPair> edge_triangle;
};

/// Calls f.template operator()<N>(primitives with N vertices, their pairs with obstacles), in a fixed order.
template <class CandidateLists, class F>
void for_each_obstacle_list(const Surface& surface, CandidateLists& c, const F& f) {
  f.template operator()<1>(surface.points, c.obstacle);
  f.template operator()<2>(surface.edges, c.obstacle_edge);
  f.template operator()<3>(surface.triangles, c.obstacle_triangle);
}

/// Into `out` those of pairs of some kinds; of states nothing.
void select_kinds(const Surface& surface, const Candidates& all, CollisionKinds kinds, Candidates& out);

/// Whether all vertices are the same part of a motion on their way, or each at its own.
enum class Pace { common, own };

/// Keeps one tree per kind of primitive that pairs of the plan need, one of the edges without triangles where there are
/// any, and no other.
class BroadPhase {
 public:
  /// plan: of the scene of the surface. precision: that in which distances are evaluated.
  BroadPhase(const Surface& surface, std::vector<AnalyticSurface<double>> obstacles, const ContactPlan& plan,
             Precision precision = Precision::full);

  /// True when some pair or obstacle contact can exist at all.
  bool active() const { return plan_.any(); }
  /// All pairs with a free vertex, not adjacent, that may have a row or bound the motion x0 -> x1, and more. A pair that
  /// the rest rule keeps from both is left out (rest_rule.hpp), and so is one of bodies that are `off`.
  /// Pace::common: all vertices move together, a state is (1 - t) x0 + t x1 with one t. Pace::own: each has its own t,
  /// which leaves more pairs.
  void update(const PositionsView& x0, const PositionsView& x1, Candidates& out, Pace pace = Pace::common);

 private:
  struct Tree {
    bool needed = false;
    Bvh bvh;
    std::vector<TreeBox> boxes;
    std::vector<float> reach;  // m, what each box is grown by
  };
  /// Where positions are put before boxes are made, and what is subtracted at the end of the motion before that, m.
  struct Frame {
    FoldedFrame folded;
    Vec3d moved;
  };
  Frame frame(const PositionsView& x0, const PositionsView& x1);
  template <class Number>
  std::vector<double>& sample(int c, const Number& of);
  FoldedFrame folded(const PositionsView& x0);
  double state_rounding(const PositionsView& x0, const PositionsView& x1) const;
  void fit_vertices(const PositionsView& x0, const PositionsView& x1, const Frame& frame);
  template <int N>
  void fit(Tree& tree, const Primitives<N>& primitives) const;
  void fit_edges();
  void find_pairs(const PositionsView& x0, const PositionsView& x1, Candidates& out);
  void find_intersections(Candidates& out);
  template <PairKind K, class Second, class MayPair>
  void find(const Bvh& a, const Bvh& b, const PositionsView& x0, const PositionsView& x1,
            const Second& second_of, const MayPair& may_pair, std::vector<IndexPair>& out);
  template <int N>
  void update_obstacles(const Primitives<N>& primitives, const PositionsView& x0, const PositionsView& x1,
                        std::vector<IndexPair>& out);

  const Surface& surface_;
  std::vector<AnalyticSurface<double>> obstacles_, first_poses_, last_poses_;  // the last two of a motion
  Tree points_, edges_, triangles_, lone_edges_;
  std::vector<std::uint8_t> lone_free_;
  PairFinder finder_;
  std::vector<TreeBox> vertices_;                       // of all vertices on the motion
  std::vector<double> sample_[3];                       // buffers of frame
  std::vector<std::vector<IndexPair>> near_obstacles_;  // of each chunk
  const ContactPlan plan_;
  const bool chosen_, tests_states_;  // of the collisions of the surface
  const Precision precision_;
  Pace pace_ = Pace::common;  // of the motion in progress
};

}  // namespace bb
