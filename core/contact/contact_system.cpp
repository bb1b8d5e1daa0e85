#include "core/contact/contact_system.hpp"

#include "core/contact/candidates.hpp"
#include "core/contact/pair_name.hpp"
#include "core/contact/row_builder.hpp"

namespace bb {

namespace {

std::vector<AnalyticSurface<double>> analytic_surfaces(const Scene& scene) {
  std::vector<AnalyticSurface<double>> out;
  for (const Obstacle& o : scene.obstacles) out.push_back(analytic_surface<double>(o));
  return out;
}

}  // namespace

struct ContactSystem::Data {
  Data(const Scene& s, const ContactOptions& o, const ContactPlan& plan)
      : scene(s),
        options(o),
        surface(s),
        obstacles(analytic_surfaces(s)),
        broad_phase(surface, obstacles, plan),
        builder(scene, surface, obstacles, plan),
        bound(surface, obstacles, {o.ccd_park, o.ccd_max_probes}) {}

  const Scene& scene;
  const ContactOptions options;
  const Surface surface;
  const std::vector<AnalyticSurface<double>> obstacles;
  BroadPhase broad_phase;
  Candidates candidates;
  RowBuilder builder;
  StepBoundFinder bound;
};

ContactSystem::ContactSystem(const Scene& scene, const ContactOptions& options, const ContactPlan& plan)
    : data_(std::make_unique<Data>(scene, options, plan)) {}
ContactSystem::ContactSystem(const Scene& scene, const ContactOptions& options)
    : ContactSystem(scene, options, plan_contact(scene, options.mollifier)) {}
ContactSystem::~ContactSystem() = default;

bool ContactSystem::active() const { return data_->broad_phase.active(); }

void ContactSystem::update_candidates(const Positions& x0, const Positions& x1) {
  if (active()) data_->broad_phase.update(x0, x1, data_->candidates);
}

double ContactSystem::find_rows(const Positions& x, ContactTable& rows, MollifiedTable& mollified) const {
  return data_->builder.build(x, data_->candidates, rows, mollified);
}

StepBound ContactSystem::step_bound(const Positions& x0, const Positions& x1) const {
  if (!(x0.allFinite() && x1.allFinite())) {
    StepBound stop;
    stop.alpha = 0;
    return stop;
  }
  return data_->bound.find(data_->candidates, x0, x1);
}

ContactSystem::Counts ContactSystem::candidate_counts() const {
  const Candidates& c = data_->candidates;
  return {c.point_triangle.size(), c.edge_edge.size(), c.point_point.size(), c.point_edge.size(),
          c.obstacle.size()};
}

std::optional<Overlap> ContactSystem::check_initial(const Positions& x) {
  update_candidates(x, x);
  const Data& data = *data_;
  std::optional<Overlap> found = first_overlap(data.surface, data.obstacles, data.candidates, x);
  if (found) found->text = pair_name(data.scene, found->key, found->kind);
  return found;
}

}  // namespace bb
