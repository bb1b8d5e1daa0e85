// Contact geometry of a scene: candidate pairs, rows of the contact table, the largest collision-free step.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "core/contact/contact_table.hpp"
#include "core/contact/offset_blocks.hpp"
#include "core/contact/overlap.hpp"
#include "core/contact/pair_areas.hpp"
#include "core/contact/step_bound.hpp"
#include "core/contact/step_bound_rule.hpp"
#include "core/math/precision.hpp"
#include "core/model/scene/contact_plan.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

struct ContactOptions {
  Mollifier mollifier = Mollifier::ipc;
  double min_gap_fraction = 1e-6;  // stop level in units of d_hat
  int ccd_max_probes = 4096;
  Precision precision = Precision::full;  // scalar of rows and step bound
  StepBoundRule step_bound = StepBoundRule::accd;
  double bound_gamma = default_bound_gamma;  // in (0, 1), where each vertex has a bound
  ContactWeighting weighting = ContactWeighting::none;
  ContactModel model = ContactModel::all_pairs;
  RestRule rest_rule = RestRule::on;
};

/// The surface that contact acts on: of the model points its vertices alone.
Surface contact_surface(const Scene& scene, const ContactOptions& options);
/// plan_contact() of that surface.
ContactPlan plan_contact(const Scene& scene, const ContactOptions& options);

/// Owns the broad phase. All results are independent of the number of threads. The scene must outlive it. Not
/// thread-safe, const members included: they share buffers; parallel inside.
///
/// Which pairs exist: every point-triangle and edge-edge pair without a common vertex, at least one vertex
/// free, and so every vertex and edge that is no side of a triangle: the edge-edge rows of parallel rods vanish
/// with their mollifier; planar: every pair of vertices that no mesh edge joins, or every vertex and boundary edge of which
/// the vertex is neither an end nor the third corner of a triangle with that edge. B is the sum over these
/// pairs, one row each. In 3D the
/// closest feature of a pair can be a vertex and an edge of its own triangle (two triangles that share the
/// edge): that row is kept, because without it B would jump when the closest point crosses the edge, and the
/// step bound, which keeps every pair, would act where no force does. The rest rule keeps it off until
/// the triangle has lost a third of its height.
///
/// Obstacles: every free vertex and a half-space or the inside of a sphere or cylinder, which are convex: what corners
/// keep to, all of a triangle keeps to. The outside of a sphere: every triangle, edges without a triangle, vertices
/// without either. The outside of a cylinder: every edge and vertex, edges nearly parallel to the axis mollified.
/// Planar: every boundary edge and the disk; with vertex pairs alone every vertex. Of the model points every vertex, and no other pair.
class ContactSystem {
 public:
  /// plan: of the same scene; only what it has is built.
  ContactSystem(const Scene& scene, const ContactOptions& options, const ContactPlan& plan);
  ContactSystem(const Scene& scene, const ContactOptions& options);
  ~ContactSystem();
  /// False when the scene can have no contact: nothing is built, rows are empty, steps unbounded.
  bool active() const;

  /// Candidate pairs of every state (1 - t) x0 + t x1, one t in [0, 1] for all vertices, boxes inflated by
  /// d_hat and offset. [3 x n] m. Both find_rows and step_bound use them until the next call.
  void update_candidates(const PositionsView& x0, const PositionsView& x1);

  /// The same for states up to the step bound of the motion alone, which step_bound and find_rows need no more
  /// than: pairs of the last rows are queried first, and boxes end where the earliest of them stops the motion.
  /// Which candidates there are depends on those rows; alpha and rows do not. Motions finite.
  void update_candidates_to_bound(const PositionsView& x0, const PositionsView& x1);

  /// One row a pair that is not `off` (scene/collisions.hpp) with d < d_hat at x (row_rule.hpp), in the order of the pairs; kappa, b, db, d2b are left at 0.
  /// Of the weighting area_corrected one a feature of point and edge, or two points, and rows of corrections; of the model
  /// offset_geometric those that its blocks leave. With weights `share` is filled.
  /// Requires x to be such a state of the last update_candidates. Returns the smallest gap over all
  /// rows (infinity without rows); a value <= 0 means that x is not feasible. x that is not finite: no
  /// rows and -infinity. -infinity too where surfaces intersect at x whose states are tested.
  double find_rows(const PositionsView& x, ContactTable& rows, MollifiedTable& mollified) const;

  /// The same for all states between x0 and x1, each vertex at its own pace: what vertex_bounds() needs, and rows there.
  void update_candidates_of_each(const PositionsView& x0, const PositionsView& x1);

  /// The part of the motion x0 -> x1 that each vertex may go, by the rule of the options, of the pairs that step_bound()
  /// has. Its alpha is the smallest. Requires update_candidates_of_each().
  StepBound vertex_bounds(const PositionsView& x0, const PositionsView& x1);
  /// [n_vertices] of the last vertex_bounds().
  std::span<const double> vertex_parts() const;

  /// All non-adjacent pairs of bodies that collide as `ccd`, whatever rule keeps them from having a row, and
  /// as `audited` where bound_audited() says so. A motion that is not finite: alpha 0.
  StepBound step_bound(const PositionsView& x0, const PositionsView& x1) const;

  /// Whether motions are bounded for pairs that collide as `audited` too, as they are not at first.
  void bound_audited(bool bound);
  /// How far the straight motion x0 -> x1 of a whole step is proven free of contact of the pairs that collide
  /// as `audited`. The candidates stay. A motion that is not finite: alpha 0.
  StepBound prove_step(const PositionsView& x0, const PositionsView& x1);

  /// Where pairs are weighted by area; else null.
  const PairAreas* areas() const;
  /// Whether they are corrected too.
  bool corrected() const;

  struct Counts {  // obstacle: with points, edges and triangles
    std::size_t point_triangle = 0, edge_edge = 0, point_point = 0, point_edge = 0, obstacle = 0;
  };
  Counts candidate_counts() const;

  /// The first pair of the scene that overlaps at x, named; none when x is a valid start. Replaces the
  /// candidates.
  std::optional<Overlap> check_initial(const PositionsView& x);

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace bb
