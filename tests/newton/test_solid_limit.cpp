// A block that its strain limit holds: the limit is active, kept, and its stress is in balance with the weight.
#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "core/energy/families/limit_family.hpp"
#include "core/exec/host_executor.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "core/model/mesh/topology.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::newton::solid_limit_test {
namespace {

constexpr double youngs = 1e4, density = 1000, gravity = 9.81, height = 0.8, side = 0.4;
constexpr double onset = 0.02, width = 0.04, k_s = 2e4;  // Pa

/// Held at its top face; alone it would be stretched by about rho g L/E = 0.78 there.
BodySpec hanging_block(bool limited) {
  BodySpec body;
  body.name = "block";
  body.mesh = solid_box_mesh({2, 2, 4}, Vec3d(side, side, height));
  body.d_hat = 1e-3;
  body.material.solid_youngs = youngs;
  body.material.solid_poisson = 0;
  body.material.solid_density = density;
  body.material.limit = StrainLimitSpec{onset, width, limited};
  body.pins.emplace_back().box = {Vec3d(-1, -1, height / 2), Vec3d(1, 1, height / 2)};
  return body;
}

Scene scene_of(const BodySpec& body) {
  SceneBuilder builder("block", false, Vec3d(0, 0, -gravity), "test");
  builder.add_body(body);
  return builder.finish();
}

Method method_of(const std::string& shape, std::unique_ptr<StiffnessPolicy> policy,
                 const std::string& integrator = "quasi_static") {
  Method method = test::fixed_method(shape, 1, integrator);
  method.solid_limit_stiffness = std::move(policy);
  method.step_solver.tol_velocity = 1e-9;
  return method;
}

StepReport last_step(Simulation& simulation, int steps) {
  StepObserver observer;
  StepReport report;
  for (int step = 0; step < steps; ++step) {
    report = simulation.step(observer);
    EXPECT_EQ(report.status, StepStatus::converged) << report.detail;
  }
  return report;
}

/// sum of V_e P_zz over the tetrahedra: corotational without Poisson's effect, and the limit with kappa_e = k_s V_e.
struct Pull {
  double elastic = 0, limit = 0;  // J
};
Pull pull_of(const Scene& scene, const Positions& x, const BarrierFunction& barrier) {
  Pull out;
  for (const auto& t : scene.solids.at(0).tetrahedra) {
    Mat3d rest, now;
    for (int k = 0; k < 3; ++k) {
      rest.col(k) = scene.rest.col(t[static_cast<std::size_t>(k) + 1]) - scene.rest.col(t[0]);
      now.col(k) = x.col(t[static_cast<std::size_t>(k) + 1]) - x.col(t[0]);
    }
    const double volume = rest.determinant() / 6;
    const Eigen::JacobiSVD<Mat3d> svd(now * rest.inverse(), Eigen::ComputeFullU | Eigen::ComputeFullV);
    for (int k = 0; k < 3; ++k) {
      const double s = svd.singularValues()[k], uv = svd.matrixU()(2, k) * svd.matrixV()(2, k);
      const double y = width - (s - 1 - onset);
      out.elastic += volume * youngs * (s - 1) * uv;
      if (y < width) out.limit -= volume * k_s * barrier.eval(y, width).db * uv;
    }
  }
  return out;
}

/// The work of the weight along the displacement z of a unit stretch about the top: what all stress balances.
double weight_pull(const Scene& scene) {
  double sum = 0;
  for (int v = 0; v < scene.n_vertices(); ++v) {
    sum += scene.mass[static_cast<std::size_t>(v)] * gravity * (height / 2 - scene.rest(2, v));
  }
  return sum;
}

TEST(SolidLimit, without_it_the_block_is_stretched_far_beyond) {
  const Scene scene = scene_of(hanging_block(false));
  EXPECT_TRUE(scene.solid_limit.tetrahedra.empty());
  Method method = method_of("log", nullptr);
  Simulation simulation(scene, method, 0.01, 4);
  const StepReport report = last_step(simulation, 4);
  EXPECT_STREQ(report.max_stretch.status, "no_limit");
  const double tip = (scene.rest.row(2) - simulation.history().x.row(2)).maxCoeff();
  EXPECT_GT(tip, 3 * (onset + width) * height);
}

TEST(SolidLimit, a_hanging_block_is_held_below_it_and_its_stress_balances_the_weight) {
  for (const std::string shape : {"log", "cubic"}) {
    SCOPED_TRACE(shape);
    const Scene scene = scene_of(hanging_block(true));
    ASSERT_EQ(scene.solid_limit.tetrahedra.size(), scene.solids.at(0).tetrahedra.size());
    // a bounded barrier has to be stiff enough for the load: k_s sup|b'| is its capacity
    Method method = method_of(shape, test::fixed_limit(shape == "log" ? k_s : 200 * k_s));
    Simulation simulation(scene, method, 0.01, 4);
    const StepReport report = last_step(simulation, 4);
    ASSERT_TRUE(report.max_stretch.finite());
    EXPECT_GT(report.max_stretch.value, onset) << "the limit is not active";
    EXPECT_LT(report.max_stretch.value, onset + width);
    EXPECT_GT(report.solid_limit_load_max_Pa.value, 1000);
    EXPECT_STREQ(report.limit_load_max_N_per_m.status, "no_limit");
    if (shape != "log") continue;
    const Pull pull = pull_of(scene, simulation.history().x, method.limit);
    const double expected = weight_pull(scene);
    EXPECT_GT(pull.limit, 0.5 * expected);  // the limit carries it
    EXPECT_NEAR(pull.elastic + pull.limit, expected, 1e-6 * expected);
  }
}

TEST(SolidLimit, a_policy_with_its_own_stiffness_holds_a_falling_block) {
  const Scene scene = scene_of(hanging_block(true));
  Method method = method_of("cubic", test::elastic_limit(), "implicit_euler");
  Simulation simulation(scene, method, 0.01, 30);
  StepObserver observer;
  double largest = 0;
  for (int step = 0; step < 30; ++step) {
    const StepReport report = simulation.step(observer);
    ASSERT_EQ(report.status, StepStatus::converged) << step << ": " << report.detail;
    largest = std::max(largest, report.max_stretch.value);
  }
  EXPECT_GT(largest, onset) << "the limit is not active";
  EXPECT_LT(largest, onset + width);
}

/// A face of a solid that is a membrane too: both kinds of element are limited, and what is reported is of both.
TEST(SolidLimit, triangles_and_tetrahedra_of_one_scene_are_limited_together) {
  BodySpec body = hanging_block(true);
  body.mesh.triangles = solid_faces(body.mesh.tetrahedra).surface;
  body.material.model = "none";
  const Scene scene = scene_of(body);
  EXPECT_FALSE(scene.limit.triangles.empty());
  Method method = method_of("log", test::fixed_limit(k_s));
  method.limit_stiffness = test::fixed_limit(10);
  Simulation simulation(scene, method, 0.01, 4);
  const StepReport report = last_step(simulation, 4);
  EXPECT_GT(report.limit_load_max_N_per_m.value, 0);
  EXPECT_GT(report.solid_limit_load_max_Pa.value, 0);
  exec::HostExecutor executor;
  double largest = 0;
  const auto measure = [&](LimitFamily& limit) {
    limit.measure(simulation.history().x.data());
    limit.announce();
    largest = std::max(largest, limit.report().max_stretch);
  };
  measure(*limited_tetrahedra({executor}, scene.solid_limit, scene.rest));
  measure(*limited_triangles({executor}, scene.limit, scene.rest, false));
  EXPECT_EQ(report.max_stretch.value, largest);
}

}  // namespace
}  // namespace bb::newton::solid_limit_test
