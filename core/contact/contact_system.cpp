#include "core/contact/contact_system.hpp"

#include <algorithm>
#include <limits>

#include "core/contact/candidates.hpp"
#include "core/contact/intersection.hpp"
#include "core/contact/pair_name.hpp"
#include "core/contact/row_builder.hpp"
#include "core/contact/vertex_bounds.hpp"

namespace bb {

namespace {

std::vector<AnalyticSurface<double>> analytic_surfaces(const Scene& scene) {
  std::vector<AnalyticSurface<double>> out;
  for (const Obstacle& o : scene.obstacles) out.push_back(analytic_surface<double>(o));
  return out;
}

StepBound no_motion() {
  StepBound stop;
  stop.alpha = 0;
  return stop;
}

Scene points_of(const Scene& scene) {
  Scene out = scene;
  out.surface_edges.clear();
  out.surface_triangles.clear();
  return out;
}

}  // namespace

Surface contact_surface(const Scene& scene, const ContactOptions& options) {
  if (options.model == ContactModel::points) return Surface(points_of(scene), options.rest_rule);
  return Surface(scene, options.rest_rule);
}

ContactPlan plan_contact(const Scene& scene, const ContactOptions& options) {
  if (options.model == ContactModel::points) return plan_contact(points_of(scene), options.mollifier);
  return plan_contact(scene, options.mollifier);
}

struct ContactSystem::Data {
  Data(const Scene& s, const ContactOptions& o, const ContactPlan& plan)
      : scene(s),
        options(o),
        surface(contact_surface(s, o)),
        obstacles(analytic_surfaces(s)),
        broad_phase(surface, obstacles, plan, o.precision),
        builder(surface, obstacles, plan, o.precision, {o.weighting, o.model}),
        bound(surface, obstacles, {o.min_gap_fraction, o.ccd_max_probes}, o.precision),
        each(surface, obstacles, o.step_bound, o.bound_gamma, o.precision) {}

  const Scene& scene;
  const ContactOptions options;
  const Surface surface;
  const std::vector<AnalyticSurface<double>> obstacles;
  BroadPhase broad_phase;
  Candidates candidates;
  Candidates swept;    // of them those that bound motions, where not all do
  Candidates of_step;  // of the motion of a whole step
  bool audited_bound = false;
  Candidates near;       // pairs of the last rows
  Positions stop;        // where they stop a motion
  StepBound near_asked;  // its counters are part of those of the next bound
  RowBuilder builder;
  StepBoundFinder bound;
  VertexBounds each;

  const Candidates& bounding(const Candidates& all) {
    if (!surface.collisions.chosen()) return all;
    return select(all, audited_bound ? CollisionKinds{CollisionKind::ccd, CollisionKind::audited}
                                     : CollisionKinds{CollisionKind::ccd});
  }
  const Candidates& select(const Candidates& all, CollisionKinds kinds) {
    select_kinds(surface, all, kinds, swept);
    return swept;
  }
};

ContactSystem::ContactSystem(const Scene& scene, const ContactOptions& options, const ContactPlan& plan)
    : data_(std::make_unique<Data>(scene, options, plan)) {}
ContactSystem::ContactSystem(const Scene& scene, const ContactOptions& options)
    : ContactSystem(scene, options, plan_contact(scene, options)) {}
ContactSystem::~ContactSystem() = default;

bool ContactSystem::active() const { return data_->broad_phase.active(); }

void ContactSystem::update_candidates(const PositionsView& x0, const PositionsView& x1) {
  data_->near_asked = {};
  if (active()) data_->broad_phase.update(x0, x1, data_->candidates);
}

void ContactSystem::update_candidates_to_bound(const PositionsView& x0, const PositionsView& x1) {
  if (!active()) return;
  Data& data = *data_;
  if (!(x0.allFinite() && x1.allFinite())) return update_candidates(x0, x1);
  data.builder.near_pairs(data.near);
  const StepBound near = data.bound.find(data.bounding(data.near), x0, x1);
  // A query that ran out of probes may end where its pair is no candidate.
  if (near.alpha == 1 || near.capped > 0) return update_candidates(x0, x1);
  data.near_asked = near;
  const double end = std::min(1.0, near.alpha * (1 + 1e-9));  // states there are rounded
  data.stop = x0 + end * (x1 - x0);
  data.broad_phase.update(x0, data.stop, data.candidates);
}

double ContactSystem::find_rows(const PositionsView& x, ContactTable& rows, MollifiedTable& mollified) const {
  const double gap = data_->builder.build(x, data_->candidates, rows, mollified);
  const bool apart = !any_intersection(data_->surface, data_->candidates.edge_triangle, x);
  return apart ? gap : -std::numeric_limits<double>::infinity();
}

StepBound ContactSystem::step_bound(const PositionsView& x0, const PositionsView& x1) const {
  if (!(x0.allFinite() && x1.allFinite())) return no_motion();
  StepBound bound = data_->bound.find(data_->bounding(data_->candidates), x0, x1);
  bound.queries += data_->near_asked.queries;
  bound.probes += data_->near_asked.probes;
  return bound;
}

void ContactSystem::bound_audited(bool bound) { data_->audited_bound = bound; }

StepBound ContactSystem::prove_step(const PositionsView& x0, const PositionsView& x1) {
  if (!active()) return {};
  if (!(x0.allFinite() && x1.allFinite())) return no_motion();
  Data& data = *data_;
  data.broad_phase.update(x0, x1, data.of_step);
  return data.bound.find(data.select(data.of_step, {CollisionKind::audited}), x0, x1);
}

void ContactSystem::update_candidates_of_each(const PositionsView& x0, const PositionsView& x1) {
  data_->near_asked = {};
  if (active()) data_->broad_phase.update(x0, x1, data_->candidates, Pace::own);
}

StepBound ContactSystem::vertex_bounds(const PositionsView& x0, const PositionsView& x1) {
  return data_->each.find(data_->bounding(data_->candidates), x0, x1);
}

std::span<const double> ContactSystem::vertex_parts() const { return data_->each.parts(); }

const PairAreas* ContactSystem::areas() const { return data_->builder.areas(); }

bool ContactSystem::corrected() const { return data_->builder.corrected(); }

ContactSystem::Counts ContactSystem::candidate_counts() const {
  const Candidates& c = data_->candidates;
  return {c.point_triangle.size(), c.edge_edge.size(), c.point_point.size(), c.point_edge.size(),
          c.obstacle.size() + c.obstacle_edge.size() + c.obstacle_triangle.size()};
}

std::optional<Overlap> ContactSystem::check_initial(const PositionsView& x) {
  update_candidates(x, x);
  const Data& data = *data_;
  std::optional<Overlap> found = first_overlap(data.surface, data.obstacles, data.candidates, x);
  if (found) found->text = pair_name(data.scene, found->key, found->kind);
  return found;
}

}  // namespace bb
