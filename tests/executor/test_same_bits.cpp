// Both matrix engines at equal states: energies, gradient, bound of a motion and what is reported of every contact have the same bits, for every
// kind of scene with every kind of method. Where they have not, the test names the term and the reason:
// - at a vertex of a mollified pair the rows of contact are summed in another order: on the host those of mollified pairs after all others,
//   on an executor all of them in the order of their pairs;
// - blocks of contact and friction are added one by one to those of elements on the host, and by themselves on an executor;
// - where kappa(d) is folded into the barrier, the host divides rows by kappa and multiplies them again;
// - sums of energies and their changes are of the same parts in another order, each compensated;
// - the kappa that ipc_adaptive starts with is a quotient of such sums.
// Elements, loads and limits alone, matrix included: test_terms.cpp; numbers of an element: test_family_columns.cpp; those of a row of
// friction or restitution: test_lagged_rows.cpp.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/energy/friction_law.hpp"
#include "tests/contact/moving_obstacles.hpp"
#include "tests/executor/compared_systems.hpp"
#include "tests/executor/run_scenes.hpp"

namespace bb::exec_same_bits_test {
namespace {

using namespace bb::test;

struct SceneCase {
  const char* name;
  Scene scene;
};
std::vector<SceneCase> scene_cases() {
  std::vector<SceneCase> out;
  out.push_back({"cloth on a plate", drawn_cloth()});
  out.push_back({"two sheets", touching(two_sheets(), 0.01)});
  out.push_back({"cloth on balls and a bar", touching(cloth_on_balls_and_bar(), 0.02)});
  out.push_back({"moving obstacles", with_moving_obstacles(out.back().scene)});
  out.push_back({"planar strips", planar_strips(PlanarPairs::point_edge)});
  out.push_back({"planar strips by their vertices", planar_strips(PlanarPairs::vertex_vertex)});
  out.push_back({"rod and blocks", rod_and_blocks()});
  out.push_back({"bouncing", bouncing()});
  out.push_back({"driven", driven()});
  return out;
}

struct MethodCase {
  std::string name;
  std::function<Method()> method;
  double rounding = 0;         // relative, of what a row has
  bool per_iteration = false;  // kappa is refreshed in every iteration
};
std::vector<MethodCase> method_cases() {
  std::vector<MethodCase> out;
  for (const char* shape : {"log", "log_squared", "quadratic", "cubic", "two_stage", "exponential",
                            "minimax_bounded", "minimax"}) {
    const StepHessian choice = all_step_hessians[out.size() % std::size(all_step_hessians)];
    out.push_back({shape, [=] {
                     Method method = fixed_method(shape, 20);
                     for (const HessianChoice& term : hessian_choices())
                       method.step_hessian[term.name] = choice;
                     method.hessian_mode = HessianMode::projected_full;
                     method.limit_stiffness = fixed_limit(30);
                     method.solid_limit_stiffness = fixed_limit(30);
                     return method;
                   }});
  }
  for (const std::string& law : friction_law_names()) {
    out.push_back({law, [=] {
                     Method method = rubbing(law);
                     method.friction.lag_iterations = 2;
                     return method;
                   }});
  }
  out.push_back({"without a mollifier", [] {
                   Method method = rubbing();
                   method.contact_options.mollifier = Mollifier::none;
                   method.contact.argument = Argument::squared_gap;
                   return method;
                 }});
  const auto add_policy = [&out](const char* term, const char* refresh, const char* derivative) {
    const ParameterMap parameters = {{"mass_term", std::string(term)},
                                     {"refresh", std::string(refresh)},
                                     {"derivative", std::string(derivative)}};
    out.push_back({std::string(term) + " " + refresh + " " + derivative, [=] {
                     Method method = method_with_policy("cubic", "elasticity_inclusive", parameters);
                     method.limit_stiffness = elastic_limit();
                     method.solid_limit_stiffness = elastic_limit();
                     return method;
                   }});
  };
  add_policy("paper", "per_iteration", "dropped");
  out.back().per_iteration = true;
  add_policy("inertia", "per_step", "dropped");
  add_policy("scaled", "per_step", "included");
  out.back().rounding = 4 * eps;
  // kappa starts as a quotient of sums over all vertices, which are of the same parts in another order
  out.push_back({"ipc_adaptive", [] { return method_with_policy("log", "ipc_adaptive", {}); }, 1e-13});
  return out;
}

/// Towards what lies below, every vertex its own way; prescribed ones stay.
Positions downwards(const Scene& scene) {
  Positions dx(3, scene.n_vertices());
  for (Eigen::Index i = 0; i < dx.size(); ++i)
    dx.data()[i] = 0.03 * std::cos(2.9 * static_cast<double>(i) + 1);
  dx.row(scene.planar ? 1 : 2).array() -= 0.03;
  if (scene.planar) dx.row(2).setZero();
  for (const Pin& pin : scene.pins) dx.col(pin.vertex).setZero();
  return dx;
}

/// A step that is cut, between others.
void go_through_steps(Compared& both, const Positions& dx, Counts& counts, int& n_bounded) {
  both.expect_same_state(counts);
  both.expect_same_matrix(), both.expect_same_solution(), both.expect_same_direction(dx);
  n_bounded += both.move(dx) < 1;
  both.expect_same_state(counts);
  both.move(0.2 * dx);  // pairs that turn up after the first iterate
  both.expect_same_state(counts);
  both.next_step(1, 1);
  both.expect_same_state(counts);
  both.restart();
  both.expect_same_state(counts);
  both.expect_same_matrix(), both.expect_same_solution(), both.expect_same_direction(dx);
  both.move(0.3 * dx);
  both.expect_same_state(counts);
  both.expect_shown(counts);
  both.renew_lagged_state(counts);
  both.expect_same_state(counts);
  both.take_secant(counts);
  both.expect_same_state(counts), both.expect_same_matrix();
  both.expect_shown(counts);
  both.next_step(0, 0.4);
  both.expect_same_state(counts);
}

TEST(SameBits, OfBothEnginesAtEqualStates) {
  std::size_t mollified = 0, shared = 0;
  int n_bounded = 0;
  for (const SceneCase& one : scene_cases()) {
    Counts counts;
    for (const MethodCase& with : method_cases()) {
      SCOPED_TRACE(std::string(one.name) + ", " + with.name);
      Compared both(one.scene, with.method, with.rounding);
      const std::size_t before = counts.kappa_changes;
      go_through_steps(both, downwards(one.scene), counts, n_bounded);
      EXPECT_EQ(counts.kappa_changes > before, with.per_iteration);
    }
    EXPECT_GT(counts.contacts, 50U) << one.name;
    EXPECT_GT(counts.loads, 50U) << one.name;
    EXPECT_GT(counts.friction, 4U) << one.name;
    EXPECT_GE(counts.renewed, 2U) << one.name;
    EXPECT_GE(counts.secants, 2U) << one.name;
    EXPECT_GE(counts.started, 6U) << one.name;
    mollified += counts.mollified, shared += counts.shared;
  }
  EXPECT_GT(mollified, 100U);
  EXPECT_GT(shared, 100U);
  EXPECT_GT(n_bounded, 80);
}

/// Where its formula has the length of the step; else it stays.
TEST(SameBits, OfAKappaThatFollowsTheLengthOfTheStep) {
  struct {
    const char *term, *refresh;
    bool follows;
  } const cases[] = {{"inertia", "per_iteration", true},
                     {"scaled", "per_iteration", true},
                     {"paper", "per_iteration", false},
                     {"inertia", "per_step", false}};
  for (const auto& [term, refresh, follows] : cases) {
    SCOPED_TRACE(std::string(term) + " " + refresh);
    const ParameterMap parameters = {{"mass_term", std::string(term)}, {"refresh", std::string(refresh)}};
    Both both(touching(cloth_on_plate(), 0.012),
              [&] { return method_with_policy("cubic", "elasticity_inclusive", parameters); });
    for (StepSystem* system : both.systems()) {
      IterateNumbers whole, shorter;
      system->view().report(whole);
      system->restart_step({1, both.scene.x0}, 0.004);
      system->assemble();
      system->view().report(shorter);
      ASSERT_GT(whole.kappa_max_N_per_m.value, 0);
      EXPECT_EQ(shorter.kappa_max_N_per_m.value > 1.5 * whole.kappa_max_N_per_m.value, follows);
    }
  }
}

// The vertex by which an obstacle moves is no part of its contacts.
TEST(SameBits, OfTheNameOfAnObstacleThatMovesAndOfOneThatStands) {
  const Scene still = touching(cloth_on_balls_and_bar(), 0.02);
  StepNumbers end[2];
  for (const std::size_t k : {0, 1}) {
    Both both(k == 0 ? still : with_moving_obstacles(still), touching_method);
    both.there.view().report_end(end[k]);
  }
  ASSERT_GT(end[0].contact_loads.size(), 5u);
  ASSERT_EQ(end[1].contact_loads.size(), end[0].contact_loads.size());
  for (std::size_t i = 0; i < end[0].contact_loads.size(); ++i) {
    EXPECT_EQ(end[1].contact_loads[i].key, end[0].contact_loads[i].key);
    EXPECT_TRUE(
        std::ranges::any_of(end[1].contact_loads[i].key, [](int id) { return obstacle_of(id) >= 0; }));
  }
}

}  // namespace
}  // namespace bb::exec_same_bits_test
