#include "experiments/run/start_check.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "core/audit/audit.hpp"
#include "core/energy/families/limit_family.hpp"
#include "core/exec/host_executor.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/scene/moving_rest.hpp"
#include "experiments/run/audit_mesh.hpp"
#include "experiments/run/audit_verdict.hpp"
#include "experiments/run/method.hpp"
#include "experiments/run/prescribed_crossings.hpp"

namespace bb {
namespace {

constexpr const char* part = "start check";

std::optional<Verdict> prescribed_crossing(const RunConfig& config, const Scene& scene,
                                           const RunLimits& limits) {
  const auto found = prescribed_crossings(config, scene, config.time.steps, 1, limits);
  if (found.empty()) return std::nullopt;
  const PrescribedCrossing& first = found.front();
  return Verdict{Outcome::given_parts_cross,
                 fmt::format("{}, and both are prescribed: in step {}, from {:.6g} to {:.6g} s", first.pair,
                             first.step, first.t0, first.t1)};
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

/// A rest shape that moves has to be one at the end of every step, also between the frames of its film.
std::optional<Verdict> rest_failure(const RunConfig& config, const Scene& scene, const RunLimits& limits) {
  MovingRest rest(scene);
  if (!rest.moves()) return std::nullopt;
  exec::HostExecutor executor;
  std::vector<std::unique_ptr<ElementFamily>> families;
  for (const PartEntry& entry : part_entries()) entry.part.add_families(scene, {executor}, families);
  for (int step = 0; step < config.time.steps; ++step) {
    const double t = (step + 1) * config.time.dt;
    limits.look_up(part, fmt::format("in the rest shapes, at step {} of {}", step, config.time.steps));
    if (!rest.move(t)) break;
    try {
      for (const auto& family : families) family->change_step({.t_end = t});
    } catch (const ConfigError& error) {
      return Verdict{Outcome::invalid_scene,
                     fmt::format("the rest shape at the end of step {}, {:g} s: {}", step, t, error.what())};
    }
  }
  return std::nullopt;
}

// Errors: Interrupted; TimeOver.
std::optional<Verdict> failure_in_time(const RunConfig& config, const Scene& scene, const ContactPlan& plan,
                                       const RunLimits& limits) {
  limits.look_up(part, "before the start was looked at");
  if (auto found = too_long(config, scene)) return found;
  if (auto found = rest_failure(config, scene, limits)) return found;
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
