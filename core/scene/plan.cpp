#include "core/scene/plan.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bb {
namespace {

/// needed with `yes`, or not with `no`.
PlanItem item(bool needed, std::string yes, std::string no) { return {needed, std::move(needed ? yes : no)}; }

std::string counted(std::size_t n, const char* what) { return fmt::format("{} {}", n, what); }

/// Counts of bodies by what they can touch.
struct Surfaces {
  int deformable = 0;         // bodies with at least one free surface vertex
  int given = 0;              // bodies without
  bool pairs_in_one = false;  // a deformable body with vertices that are not neighbours
};

Surfaces count_surfaces(const Scene& scene, const std::vector<char>& is_free) {
  Surfaces out;
  for (const Body& body : scene.bodies) {
    const auto begin = is_free.begin() + body.first_vertex;
    if (std::any_of(begin, begin + body.n_vertices, [](char f) { return f != 0; })) {
      ++out.deformable;
      // Elements that share a vertex never pair: up to three vertices have no pair.
      if (body.n_vertices > 3) out.pairs_in_one = true;
    } else {
      ++out.given;
    }
  }
  if (scene.surface_vertices.empty()) return {};
  return out;
}

void plan_contact(Plan& plan, const Scene& scene, const Surfaces& surfaces, const PlanOptions& options) {
  const bool self = surfaces.pairs_in_one || surfaces.deformable > 1;
  const bool given = surfaces.given > 0 && surfaces.deformable > 0;
  const bool obstacles = !scene.obstacles.empty() && surfaces.deformable > 0;
  plan.self_contact = item(self, fmt::format("{} deformable bodies", surfaces.deformable),
                           "one deformable body without two elements that share no vertex");
  plan.given_surfaces =
      item(given, fmt::format("{} prescribed bodies", surfaces.given), "no prescribed body");
  plan.obstacles =
      item(obstacles, counted(scene.obstacles.size(), "analytic obstacles"), "no analytic obstacle");
  plan.contact = item(self || given || obstacles, "something can touch", "nothing can touch");
  plan.broad_phase = item(self || given, "pairs of surfaces", "no pair of surfaces");
  plan.step_bound =
      item(plan.contact.needed && options.collision_free_steps, "every step stays free of contact",
           plan.contact.needed ? "the step solver has no step bound" : "nothing can touch");
  const bool edges = !scene.planar && plan.broad_phase.needed;
  plan.mollifier = item(edges && options.mollifier, "edge pairs may be parallel",
                        !options.mollifier ? "contact.mollifier is none" : "no edge-edge pairs");
}

void plan_elements(Plan& plan, const Scene& scene, const PlanOptions& options) {
  const std::size_t limited = scene.limit.triangles.size();
  const std::size_t triangles = scene.membrane_triangles().size();
  plan.membrane = item(triangles > 0, counted(triangles, "triangles"), "no membrane element");
  plan.springs =
      item(!scene.springs.edges.empty(), counted(scene.springs.edges.size(), "springs"), "no spring");
  plan.hinges =
      item(!scene.hinges.hinges.empty(), counted(scene.hinges.hinges.size(), "hinges"), "no bending");
  plan.strain_limit = item(options.strain_limit && limited > 0, counted(limited, "limited triangles"),
                           options.strain_limit ? "no limited triangle" : "strain_limit is not enabled");
  const bool used = plan.contact.needed || plan.strain_limit.needed;
  plan.policy_submatrix =
      item(used && options.policy_needs_submatrix, "a stiffness policy reads the elastic matrix",
           options.policy_needs_submatrix ? "no contact and no limit" : "no stiffness policy reads it");
}

}  // namespace

std::vector<std::pair<std::string_view, const PlanItem*>> Plan::items() const {
  return {{"contact", &contact},
          {"broad_phase", &broad_phase},
          {"step_bound", &step_bound},
          {"self_contact", &self_contact},
          {"given_surfaces", &given_surfaces},
          {"obstacles", &obstacles},
          {"mollifier", &mollifier},
          {"membrane", &membrane},
          {"springs", &springs},
          {"hinges", &hinges},
          {"strain_limit", &strain_limit},
          {"pins", &pins},
          {"pin_lifting", &pin_lifting},
          {"planar_lock", &planar_lock},
          {"policy_submatrix", &policy_submatrix},
          {"preconditioner", &preconditioner},
          {"conditioning", &conditioning},
          {"audit", &audit},
          {"trace", &trace},
          {"frames", &frames},
          {"matrices", &matrices}};
}

std::vector<Plan::Skip> Plan::skipped() const {
  std::vector<Skip> out;
  for (const auto& [name, entry] : items()) {
    if (!entry->needed) out.push_back({std::string(name), entry->reason});
  }
  return out;
}

Plan make_plan(const Scene& scene, const PlanOptions& options) {
  std::vector<char> is_free(static_cast<std::size_t>(scene.n_vertices()), 1);
  bool moving = false;
  for (const Pin& pin : scene.pins) {
    is_free[static_cast<std::size_t>(pin.vertex)] = 0;
    moving = moving || !scene.motions[static_cast<std::size_t>(pin.motion)].is_static();
  }
  Plan plan;
  plan_contact(plan, scene, count_surfaces(scene, is_free), options);
  plan_elements(plan, scene, options);
  plan.pins =
      item(!scene.pins.empty(), counted(scene.pins.size(), "prescribed vertices"), "no prescribed vertex");
  plan.pin_lifting = item(moving, "prescribed vertices move", "no prescribed vertex moves");
  plan.planar_lock = item(scene.planar, "the scene is planar", "the scene is not planar");
  plan.preconditioner =
      item(options.iterative_solver, "the linear solver is iterative", "the linear solver is direct");
  plan.conditioning = item(options.diagnose, "passes.diagnose", "passes.diagnose is off");
  plan.audit = item(options.audit, "passes.audit", "passes.audit is off");
  plan.trace = item(options.trace, "a run is observed",
                    "only the pass time: passes.diagnose, passes.audit or output.frames_every leave one");
  plan.frames = item(options.frames, "output.frames_every", "output.frames_every is 0");
  plan.matrices = item(options.matrices, "output.matrices", "output.matrices is off");
  return plan;
}

}  // namespace bb
