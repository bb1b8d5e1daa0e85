#include "experiments/run/start_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>

#include "core/audit/audit.hpp"
#include "core/energy/families/limit_family.hpp"
#include "core/exec/host_executor.hpp"
#include "experiments/run/audit_mesh.hpp"
#include "experiments/run/audit_verdict.hpp"
#include "experiments/run/method.hpp"

namespace bb {
namespace {

constexpr const char* part = "start check";

audit::AuditMesh audit_mesh_of(const RunConfig& config, const Scene& scene) {
  return make_audit_mesh(scene, config.time.dt, config.contact.model == ContactModel::points);
}

// The primitives without a free vertex.
audit::AuditMesh prescribed_part(const audit::AuditMesh& mesh) {
  audit::AuditMesh out = mesh;
  Eigen::Index n_edges = 0, n_triangles = 0;
  out.opposite.clear();
  for (Eigen::Index e = 0; e < mesh.edges.cols(); ++e) {
    if (!mesh.all_prescribed(mesh.edges.col(e))) continue;
    out.edges.col(n_edges++) = mesh.edges.col(e);
    if (!mesh.opposite.empty()) out.opposite.push_back(mesh.opposite[static_cast<std::size_t>(e)]);
  }
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    if (mesh.all_prescribed(mesh.triangles.col(t))) out.triangles.col(n_triangles++) = mesh.triangles.col(t);
  }
  out.edges.conservativeResize(2, n_edges);
  out.triangles.conservativeResize(3, n_triangles);
  out.points.clear();
  for (int v = 0; v < static_cast<int>(mesh.prescribed.size()); ++v) {
    const bool of_obstacle = std::any_of(mesh.obstacles.begin(), mesh.obstacles.end(),
                                         [v](const audit::AuditObstacle& o) { return o.vertex == v; });
    if (mesh.is_prescribed(v) && !of_obstacle) out.points.push_back(v);
  }
  return out;
}

// Prescribed vertices that move relative to each other, or to an obstacle, may cross.
bool prescribed_may_cross(const Scene& scene) {
  std::set<int> motions;
  bool driven = false;
  for (const Pin& pin : scene.pins) {
    motions.insert(pin.motion);
    driven = driven || !scene.motions[static_cast<std::size_t>(pin.motion)].is_static();
  }
  return driven && (motions.size() > 1 || !scene.obstacles.empty());
}

// The given motions, step by step, as a run would follow them: straight from pose to pose.
std::optional<Verdict> prescribed_crossing(const RunConfig& config, const Scene& scene,
                                           const RunLimits& limits) {
  if (!prescribed_may_cross(scene)) return std::nullopt;
  const audit::AuditMesh mesh = prescribed_part(audit_mesh_of(config, scene));
  if (mesh.points.empty()) return std::nullopt;  // no more than obstacles are given
  audit::Audit judge(mesh);
  const double tolerance = audit_tolerance(scene, config.contact.ccd_park);
  double last_end = 0;  // from then on every motion has ended
  for (const RigidMotion& motion : scene.motions) {
    last_end = std::max(last_end, motion.last_change());
  }
  Positions x0 = scene.x0, x1 = x0;
  for (int step = 0; step < config.time.steps && step * config.time.dt < last_end; ++step) {
    limits.look_up(part, fmt::format("in the given motions, at step {} of {}", step, config.time.steps));
    for (const Pin& pin : scene.pins) x1.col(pin.vertex) = pin_pose(scene, pin, (step + 1) * config.time.dt);
    judge.check_motion(x0, x1, step, tolerance);
    judge.check_state(x1, step);
    if (judge.ledger().scene_faults > 0) return judge_audit(scene, mesh, judge.ledger());
    x0 = x1;
  }
  return std::nullopt;
}

// The energy of a limit is infinite at and beyond it.
std::optional<Verdict> beyond_limit(const Scene& scene, LimitFamily& limited, const StrainBands& bands) {
  limited.measure(scene.x0.data());
  for (std::size_t e = 0; e < bands.width.size(); ++e) {
    if (limited.smallest_gap(e) > 0) continue;
    const double limit = bands.onset[e] + bands.width[e], stretch = limit - limited.smallest_gap(e);
    const int vertex = limited.vertices()[e * static_cast<std::size_t>(limited.width())];
    const int body = scene.body[static_cast<std::size_t>(vertex)];
    return Verdict{
        Outcome::invalid_scene,
        fmt::format("body \"{}\": element {} of the strain limit is stretched by {:.4g} at the start, and "
                    "its limit is {:.4g}",
                    scene.bodies[static_cast<std::size_t>(body)].name, e, stretch, limit)};
  }
  return std::nullopt;
}

std::optional<Verdict> too_long(const RunConfig& config, const Scene& scene) {
  if (!config.strain_limit.enabled || config.step_solver.name == "article_literal") return std::nullopt;
  exec::HostExecutor executor;
  const auto triangles = limited_triangles({executor}, scene.limit, scene.rest, scene.planar);
  if (auto found = beyond_limit(scene, *triangles, scene.limit)) return found;
  return beyond_limit(scene, *limited_tetrahedra({executor}, scene.solid_limit, scene.rest),
                      scene.solid_limit);
}

// Errors: Interrupted; TimeOver.
std::optional<Verdict> failure_in_time(const RunConfig& config, const Scene& scene, const ContactPlan& plan,
                                       const RunLimits& limits) {
  limits.look_up(part, "before the start was looked at");
  if (auto found = too_long(config, scene)) return found;
  limits.look_up(part, "before the surface was collected");
  const audit::AuditMesh mesh = audit_mesh_of(config, scene);
  limits.look_up(part, "before crossings were looked for");
  audit::Audit judge(mesh);
  judge.check_state(scene.x0, -1);
  const audit::AuditLedger& ledger = judge.ledger();
  if (ledger.scene_faults > 0) return judge_audit(scene, mesh, ledger);
  limits.look_up(part, "before the gaps at the start were looked at");
  ContactSystem contacts(scene, contact_options(config.contact), plan);
  if (const auto overlap = contacts.check_initial(scene.x0)) {
    return Verdict{Outcome::initial_intersection,
                   fmt::format("{} (gap {:.3g} m)", overlap->text, overlap->gap)};
  }
  if (!ledger.clean()) {
    return Verdict{Outcome::initial_intersection, ledger.first_bad
                                                      ? describe(scene, mesh, *ledger.first_bad)
                                                      : std::string("a state that cannot be judged")};
  }
  return prescribed_crossing(config, scene, limits);
}

}  // namespace

std::optional<Verdict> start_failure(const RunConfig& config, const Scene& scene, const ContactPlan& contacts,
                                     const RunLimits& limits) {
  try {
    return failure_in_time(config, scene, contacts, limits);
  } catch (const TimeOver& over) {
    return Verdict{Outcome::timeout, over.detail};
  }
}

}  // namespace bb
