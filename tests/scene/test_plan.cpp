// The plan says what a scene needs, and why the rest is skipped.
#include <gtest/gtest.h>

#include <set>

#include "core/scene/plan.hpp"
#include "tests/scene/bodies.hpp"

namespace bb {
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

std::set<std::string> needed(const Plan& plan) {
  std::set<std::string> names;
  for (const auto& [name, item] : plan.items()) {
    if (item->needed) names.emplace(name);
  }
  return names;
}

TEST(plan, of_a_lone_triangle_is_its_membrane_alone) {
  EXPECT_EQ(needed(make_plan(one_triangle(false), {})), (std::set<std::string>{"membrane"}));
}

TEST(plan, of_an_obstacle_has_no_broad_phase) {
  EXPECT_EQ(needed(make_plan(one_triangle(true), {})),
            (std::set<std::string>{"contact", "step_bound", "obstacles", "membrane"}));
}

TEST(plan, of_cloth_on_a_box_has_pairs_pins_and_columns_that_are_given) {
  const Plan plan = make_plan(scene_of({cloth("cloth", 1), rigid_box("box")}), {});

  EXPECT_EQ(needed(plan), (std::set<std::string>{"contact", "broad_phase", "step_bound", "self_contact",
                                                 "given_surfaces", "mollifier", "membrane", "pins"}));
}

TEST(plan, follows_every_option) {
  BodySpec body = cloth("cloth", 1);
  body.material.bending = 1;
  body.material.springs = 1;
  body.material.limit = StrainLimitSpec{};
  BodySpec box = rigid_box("box");
  box.motion.velocity = Vec3d(0, 0, 1);
  PlanOptions options;
  options.strain_limit = options.policy_needs_submatrix = options.iterative_solver = true;
  options.diagnose = options.audit = options.trace = options.frames = options.matrices = true;

  const Plan plan = make_plan(scene_of({body, box}), options);

  std::set<std::string> missing;
  for (const Plan::Skip& skip : plan.skipped()) missing.insert(skip.what);
  EXPECT_EQ(missing, (std::set<std::string>{"obstacles", "planar_lock"}));
}

TEST(plan, gives_a_reason_for_every_item_and_lists_each_once) {
  const Plan plan = make_plan(one_triangle(false), {});

  std::set<std::string_view> names;
  for (const auto& [name, item] : plan.items()) {
    EXPECT_FALSE(item->reason.empty()) << name;
    EXPECT_TRUE(names.insert(name).second) << name;
  }
  EXPECT_EQ(plan.skipped().size() + 1, names.size());
}

TEST(plan, skips_the_step_bound_of_a_solver_without_one) {
  PlanOptions options;
  options.collision_free_steps = options.mollifier = false;

  const Plan plan = make_plan(scene_of({cloth("cloth")}), options);

  EXPECT_TRUE(plan.contact.needed);
  EXPECT_FALSE(plan.step_bound.needed);
  EXPECT_EQ(plan.step_bound.reason, "the step solver has no step bound");
  EXPECT_EQ(plan.mollifier.reason, "contact.mollifier is none");
}

TEST(plan, of_a_planar_scene_locks_the_third_axis_and_has_no_edge_pairs) {
  const Plan plan = make_plan(scene_of({cloth("cloth")}, true), {});

  EXPECT_TRUE(plan.planar_lock.needed);
  EXPECT_FALSE(plan.mollifier.needed);
}

TEST(plan, keeps_the_submatrix_for_a_limit_without_contact) {
  BodySpec body;
  body.name = "triangle";
  body.mesh.vertices = Positions::Identity(3, 3);
  body.mesh.triangles = {{0, 1, 2}};
  body.material.limit = StrainLimitSpec{};
  body.d_hat = 0.01;
  PlanOptions options;
  options.strain_limit = options.policy_needs_submatrix = true;

  EXPECT_TRUE(make_plan(scene_of({body}), options).policy_submatrix.needed);
  options.strain_limit = false;
  EXPECT_FALSE(make_plan(scene_of({body}), options).policy_submatrix.needed);
}

}  // namespace
}  // namespace bb
