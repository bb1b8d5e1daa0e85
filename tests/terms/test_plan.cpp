// The plan states what a scene needs, and why the rest is skipped.
#include <gtest/gtest.h>

#include <set>

#include "tests/bodies/bodies.hpp"
#include "tests/terms/all_terms.hpp"

namespace bb::plan_test {
namespace {

using namespace test;

Scene one_triangle(bool above_a_plane) {
  BodySpec body;
  body.name = "triangle";
  body.mesh.vertices = Positions::Identity(3, 3);
  body.mesh.triangles = {{0, 1, 2}};
  body.d_hat = 0.01;
  SceneBuilder builder("test", false, down, "test");
  builder.add_body(body);
  Obstacle plane;
  plane.name = "plane";
  plane.point = Vec3d(0, 0, -1);
  if (above_a_plane) builder.add_obstacle(plane);
  return builder.finish();
}

Plan plan_of(const Scene& scene, const TermOptions& terms = {}, const PlanOptions& options = {}) {
  return make_plan(scene, terms, options);
}

/// What is needed beside inertia, weight and what every step solver here requires.
std::set<std::string> needed(const Plan& plan) {
  std::set<std::string> names;
  for (const auto& [name, item] : plan.items()) {
    if (item->needed) names.emplace(name);
  }
  for (const char* always : {"inertia", "external_force", "linear_solver", "trial_energies", "end_check"}) {
    EXPECT_EQ(names.erase(always), 1U) << always;
  }
  return names;
}

TEST(plan, of_a_lone_triangle_is_its_membrane_alone) {
  EXPECT_EQ(needed(plan_of(one_triangle(false))), (std::set<std::string>{"membrane"}));
}

TEST(plan, of_an_obstacle_has_no_broad_phase) {
  EXPECT_EQ(needed(plan_of(one_triangle(true))),
            (std::set<std::string>{"contact", "step_bound", "obstacles", "membrane"}));
}

TEST(plan, of_cloth_on_a_box_has_pairs_pins_and_columns_that_are_given) {
  const Plan plan = plan_of(scene_of({cloth("cloth", 1), rigid_box("box")}));

  EXPECT_EQ(needed(plan), (std::set<std::string>{"contact", "broad_phase", "step_bound", "self_contact",
                                                 "given_surfaces", "mollifier", "membrane", "pins"}));
}

TEST(plan, follows_every_option) {
  BodySpec body = cloth("cloth", 1);
  body.material.bending = 1;
  body.material.springs = 1;
  body.mesh.segments = {{0, 1}, {1, 2}};
  body.material.rod_bending = 1;
  body.material.limit = StrainLimitSpec{};
  BodySpec box = rigid_box("box");
  box.motion.velocity = Vec3d(0, 0, 1);
  TermOptions terms = term_options();
  terms.limit_stiffness = test::elastic_limit();
  PlanOptions options;
  options.linear.name = "pcg";
  options.diagnose = options.audit = options.trace = options.frames = options.matrices = true;

  const Plan plan = plan_of(scene_of({body, box}), terms, options);

  std::set<std::string> missing;
  for (const auto& [name, item] : plan.items()) {
    if (!item->needed) missing.insert(std::string(name));
  }
  EXPECT_EQ(missing, (std::set<std::string>{"air_drag", "cloth_springs", "collisions", "float_arithmetic",
                                            "inflation", "obstacles", "planar_lock", "pull", "restitution",
                                            "stitch", "tetrahedra"}));
  terms.precision = Precision::single;
  EXPECT_TRUE(plan_of(scene_of({body, box}), terms, options).float_arithmetic.needed);
}

TEST(plan, gives_a_reason_for_every_item_and_lists_each_once) {
  const Plan plan = plan_of(one_triangle(false));

  std::set<std::string_view> names;
  std::size_t needed = 0;
  for (const auto& [name, item] : plan.items()) {
    EXPECT_FALSE(item->reason.empty()) << name;
    EXPECT_TRUE(names.insert(name).second) << name;
    needed += item->needed;
  }
  EXPECT_EQ(needed,
            6U);  // inertia, weight, membrane, a linear solver, energies of trials, a check of the end
}

TEST(plan, skips_the_step_bound_of_a_solver_without_one) {
  TermOptions terms;
  terms.contact_options.mollifier = Mollifier::none;
  PlanOptions options;
  options.step.step_bound = false;

  const Plan plan = plan_of(scene_of({cloth("cloth")}), terms, options);

  EXPECT_TRUE(plan.term("contact").needed);
  EXPECT_FALSE(plan.step_bound.needed);
  EXPECT_EQ(plan.step_bound.reason, "the step solver has no step bound");
  EXPECT_EQ(plan.contacts.mollifier.reason, "contact.mollifier is none");
}

TEST(plan, skips_what_a_step_solver_does_without) {
  TermOptions terms = term_options();
  terms.limit_stiffness = test::elastic_limit();
  BodySpec body = cloth("cloth");
  body.material.limit = StrainLimitSpec{};
  PlanOptions options;
  options.linear.name = "pcg";
  options.diagnose = options.matrices = true;
  const Scene scene = scene_of({body});
  const Plan all = plan_of(scene, terms, options);
  options.step = {.matrix = false, .energies = false, .minimum = false, .step_bound = false};
  options.end_check = false;

  const Plan plan = plan_of(scene, terms, options);

  for (PlanItem Plan::*item :
       {&Plan::trial_energies, &Plan::end_check, &Plan::policy_submatrix, &Plan::step_bound,
        &Plan::linear_solver, &Plan::preconditioner, &Plan::conditioning, &Plan::matrices}) {
    EXPECT_TRUE((all.*item).needed) << (all.*item).reason;
    EXPECT_FALSE((plan.*item).needed) << (plan.*item).reason;
    EXPECT_NE((all.*item).reason, (plan.*item).reason);
  }
  EXPECT_EQ(plan.trial_energies.reason, "feasibility alone judges the trials of the step solver");
  EXPECT_EQ(plan.linear_solver.reason, "the step solver has no matrix");
}

TEST(plan, of_a_planar_scene_locks_the_third_axis_and_has_no_edge_pairs) {
  const Plan plan = plan_of(scene_of({cloth("cloth")}, true));

  EXPECT_TRUE(plan.planar_lock.needed);
  EXPECT_FALSE(plan.contacts.mollifier.needed);
}

TEST(plan, keeps_the_submatrix_for_a_limit_without_contact) {
  BodySpec body;
  body.name = "triangle";
  body.mesh.vertices = Positions::Identity(3, 3);
  body.mesh.triangles = {{0, 1, 2}};
  body.material.limit = StrainLimitSpec{};
  body.d_hat = 0.01;
  TermOptions terms;
  terms.limit_stiffness = test::elastic_limit();

  EXPECT_TRUE(plan_of(scene_of({body}), terms).policy_submatrix.needed);
  terms.strain_limit = false;
  EXPECT_FALSE(plan_of(scene_of({body}), terms).policy_submatrix.needed);
}

}  // namespace
}  // namespace bb::plan_test
