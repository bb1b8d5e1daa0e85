#include "experiments/run/audit_verdict.hpp"

#include <fmt/format.h>

#include "core/audit/pair_text.hpp"

namespace bb {
namespace {

std::string when(int step) { return step < 0 ? "at the start" : fmt::format("in step {}", step); }

std::string penetration(const Scene& scene, const audit::AuditMesh& mesh, const audit::AuditLedger& ledger) {
  const long between = ledger.obstacle_violations - ledger.obstacle_by_vertex;
  std::string text = fmt::format(
      "audit: {} crossings in states, {} passages in motions, {} primitives in an obstacle, {} of them only "
      "between "
      "their vertices",
      ledger.crossings, ledger.violations, ledger.obstacle_violations, between);
  if (ledger.first_bad) {
    text += fmt::format("; the first {}: {}", when(ledger.first_bad_step),
                        describe(scene, mesh, *ledger.first_bad));
  }
  const bool no_edge_pairs = scene.planar && scene.planar_pairs == PlanarPairs::vertex_vertex;
  if (no_edge_pairs && ledger.crossings + ledger.violations + between > 0) {
    text +=
        "; the contact model vertex_vertex has no edge pairs: it allows edges to cross each other and to "
        "enter "
        "obstacles, which is no failure of the solver";
  } else if (scene.planar && ledger.obstacle_violations > 0) {
    text +=
        "; in the plane contact is of boundaries: where a membrane turns inside out its inner vertices come "
        "through its own boundary, and nothing keeps them out of obstacles";
  }
  return text;
}

std::string unproven(const audit::AuditLedger& ledger) {
  if (!ledger.self_test_passed) return "audit: the exact predicates failed their test on this machine";
  if (ledger.non_finite > 0) return fmt::format("audit: {} states or motions not finite", ledger.non_finite);
  if (ledger.unproven > 0) {
    return fmt::format(
        "audit: {} motions could not be certified, of {} pairs and {} primitives at obstacles that were "
        "judged",
        ledger.unproven, ledger.motion_pairs, ledger.obstacle_judged.total());
  }
  if (ledger.unjudged > 0) {
    return fmt::format("audit: {} states were reached by no judged motion, the first {}", ledger.unjudged,
                       when(ledger.first_bad_step));
  }
  const audit::AuditSubjects& s = ledger.subjects;
  const audit::ObstacleCounts &need = s.at_obstacles, &done = ledger.obstacle_judged;
  return fmt::format(
      "audit: nothing was judged, or a kind of primitive was left out, of a surface of {} edges, {} "
      "triangles, {} "
      "vertices and {} obstacles; at the obstacles {} of {} vertices, {} of {} edges and {} of {} triangles "
      "a state",
      s.edges, s.triangles, s.vertices, s.obstacles, done.vertices, need.vertices, done.edges, need.edges,
      done.triangles, need.triangles);
}

std::string overlap_text(const audit::AuditLedger& ledger) {
  return fmt::format(
      "audit: surfaces overlap obstacles at ends of steps, {} primitives summed over the steps, by at most "
      "{:.3g} m, which is "
      "within what the step solver promises; first {}",
      ledger.overlaps, ledger.deepest_overlap_m, when(ledger.first_overlap_step));
}

}  // namespace

std::string describe(const Scene& scene, const audit::AuditMesh& mesh, const audit::PairName& pair) {
  audit::SubjectNames names;
  for (const Body& body : scene.bodies) {
    names.bodies.push_back(body.name);
    names.first_vertex.push_back(body.first_vertex);
  }
  for (const Obstacle& obstacle : scene.obstacles) names.obstacles.push_back(obstacle.name);
  return audit::describe(mesh, pair, names);
}

Verdict judge_audit(const Scene& scene, const audit::AuditMesh& mesh, const audit::AuditLedger& ledger) {
  if (ledger.ok()) return ledger.overlaps > 0 ? Verdict{Outcome::ok, overlap_text(ledger)} : Verdict{};
  if (ledger.scene_faults > 0 && ledger.first_fault) {
    std::string text = fmt::format("{}, and both are prescribed: {}",
                                   describe(scene, mesh, *ledger.first_fault), when(ledger.first_fault_step));
    if (ledger.penetrated()) text += "; " + penetration(scene, mesh, ledger);
    return {Outcome::given_parts_cross, text};
  }
  if (ledger.penetrated()) return {Outcome::penetration, penetration(scene, mesh, ledger)};
  return {Outcome::unproven, unproven(ledger)};
}

}  // namespace bb
