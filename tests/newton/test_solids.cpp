// Solids in motion and at rest: patch test under uniaxial load, momentum, a cantilever against Euler and Bernoulli.
#include <gtest/gtest.h>

#include "core/exec/host_executor.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "core/model/mesh/topology.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::test::solids {
namespace {

BodySpec block(const std::array<int, 3>& n, const Vec3d& size) {
  BodySpec body;
  body.name = "block";
  body.mesh = solid_box_mesh(n, size);
  body.d_hat = 1e-3;
  return body;
}

Scene scene_of(const BodySpec& body, const Vec3d& gravity = Vec3d::Zero()) {
  SceneBuilder builder("block", false, gravity, "test");
  builder.add_body(body);
  return builder.finish();
}

double wave(Eigen::Index i) { return std::sin(7.3 * static_cast<double>(i) + 1); }

std::vector<int> surface_vertices(const TriangleMesh& mesh) {
  std::vector<int> out;
  for (const auto& face : solid_faces(mesh.tetrahedra).surface)
    out.insert(out.end(), face.begin(), face.end());
  return out;
}

/// Lateral stretch and axial first Piola-Kirchhoff stress (Pa) of a bar that is stretched by a and free at its sides.
struct Uniaxial {
  double lateral, stress;
};
Uniaxial uniaxial(const std::string& model, double youngs, double nu, double a) {
  const double mu = youngs / (2 * (1 + nu)), lambda = youngs * nu / ((1 + nu) * (1 - 2 * nu));
  if (model == "arap") return {1, 2 * mu * (a - 1)};
  if (model == "corotational") return {1 - nu * (a - 1), youngs * (a - 1)};
  if (model == "stvk") return {std::sqrt(1 - nu * (a * a - 1)), a * youngs * (a * a - 1) / 2};
  const double volume = 1 + mu / lambda * (1 - 1 / a);  // stable_neo_hookean
  return {std::sqrt(volume / a), mu * (a - volume / (a * a))};
}

Positions elastic_forces(const Scene& scene, const Positions& x) {
  exec::HostExecutor executor;
  std::vector<std::unique_ptr<ElementFamily>> families;
  parts::tetrahedra::part().add_families(scene, {executor}, families);
  LocalTerms terms;
  families.at(0)->derivatives(x.data(), Projection::psd, terms);
  Positions out = Positions::Zero(3, x.cols());
  const std::span<const int> vertices = families[0]->vertices();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    out.col(vertices[i]) += Vec3d(terms.grad[3 * i], terms.grad[3 * i + 1], terms.grad[3 * i + 2]);
  }
  return out;
}

/// Surface at its place under uniaxial stress, vertices inside put elsewhere at rest and at the start.
TEST(SolidPatch, a_block_under_uniaxial_load_is_exact_for_every_model) {
  const Vec3d size(1.2, 0.5, 0.6);
  for (const std::string model : {"corotational", "arap", "stvk", "stable_neo_hookean"}) {
    for (const double a : {1.2, 0.9}) {
      SCOPED_TRACE(model + " " + std::to_string(a));
      BodySpec body = block({4, 3, 3}, size);
      body.material.solid_model = model;
      const std::vector<int> outside = surface_vertices(body.mesh);
      std::vector<char> inside(static_cast<std::size_t>(body.mesh.n_vertices()), 1);
      for (const int v : outside) inside[static_cast<std::size_t>(v)] = 0;
      const Uniaxial expected = uniaxial(model, body.material.solid_youngs, body.material.solid_poisson, a);
      const Vec3d stretch(a, expected.lateral, expected.lateral);
      for (int v = 0; v < body.mesh.n_vertices(); ++v) {
        if (inside[static_cast<std::size_t>(v)] != 0)
          body.mesh.vertices.col(v) += 0.03 * Vec3d(wave(v), wave(v + 50), wave(v + 90));
      }
      const Positions exact = stretch.asDiagonal() * body.mesh.vertices;
      body.start = exact;
      int moved = 0;
      for (int v = 0; v < body.mesh.n_vertices(); ++v) {
        if (inside[static_cast<std::size_t>(v)] == 0) continue;
        body.start->col(v) += 0.02 * Vec3d(wave(2 * v), wave(2 * v + 7), wave(2 * v + 9));
        ++moved;
      }
      body.pins.emplace_back().indices = outside;
      const Scene scene = scene_of(body);
      Method method = fixed_method("log", 1, "quasi_static");
      method.step_solver.tol_velocity = 1e-11;
      Simulation simulation(scene, method, 0.01, 1);
      StepObserver observer;
      ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
      EXPECT_EQ(moved, 12);
      EXPECT_LT((simulation.history().x - exact).cwiseAbs().maxCoeff(), 1e-12);
      body.pins.clear();  // with the elements all of whose vertices are held
      const Positions force = elastic_forces(scene_of(body), simulation.history().x);
      Vec3d end = Vec3d::Zero(), side = Vec3d::Zero();
      for (int v = 0; v < scene.n_vertices(); ++v) {
        if (scene.rest(0, v) > 0.5999) end += force.col(v);
        if (scene.rest(1, v) > 0.2499) side += force.col(v);
      }
      const double load = expected.stress * size[1] * size[2];
      EXPECT_GT(std::abs(load), 1000);
      EXPECT_NEAR(end[0], load, 1e-10 * std::abs(load));
      EXPECT_LT(end.tail<2>().norm() + side.norm(), 1e-10 * std::abs(load));
    }
  }
}

TEST(SolidMotion, momentum_is_kept_without_external_force) {
  BodySpec body = block({3, 2, 2}, Vec3d(0.6, 0.4, 0.4));
  body.velocity = Vec3d(1, -2, 0.5);
  for (const std::string model : {"corotational", "stable_neo_hookean"}) {
    body.material.solid_model = model;
    Scene scene = scene_of(body);
    for (Eigen::Index i = 0; i < scene.x0.size(); ++i) scene.x0.data()[i] += 0.02 * wave(i);
    Method method = fixed_method("log", 1);
    Simulation simulation(scene, method, 0.01, 10);
    const Eigen::Map<const VecXd> mass(scene.mass.data(), scene.n_vertices());
    const Vec3d before = scene.v0 * mass;
    StepObserver observer;
    for (int step = 0; step < 10; ++step) {
      ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
    }
    const Positions& v = simulation.history().v;
    EXPECT_LT((v * mass - before).norm(), 1e-12 * before.norm()) << model;
    EXPECT_GT((v - scene.v0).cwiseAbs().maxCoeff(), 0.1) << model;  // it has moved in itself
  }
}

/// Fall of the tip over that of Euler and Bernoulli, rho A g L^4/(8 E I), of a block 1 m x 0.1 m x 0.1 m without Poisson's effect, held at
/// one end, n cells across.
double relative_fall(int n) {
  constexpr double youngs = 1e7, density = 1000, gravity = 0.1, length = 1, side = 0.1;
  BodySpec body = block({10 * n, n, n}, Vec3d(length, side, side));
  body.material.solid_youngs = youngs;
  body.material.solid_poisson = 0;
  body.material.solid_density = density;
  body.pins.emplace_back().box = {Vec3d(-0.5, -1, -1), Vec3d(-0.5, 1, 1)};
  const Scene scene = scene_of(body, Vec3d(0, 0, -gravity));
  Method method = fixed_method("log", 1, "quasi_static");
  Simulation simulation(scene, method, 0.01, 1);
  StepObserver observer;
  EXPECT_EQ(simulation.step(observer).status, StepStatus::converged);
  const double expected = 1.5 * density * gravity * std::pow(length, 4) / (youngs * side * side);
  double fall = 0;
  int count = 0;
  for (int v = 0; v < scene.n_vertices(); ++v) {
    if (scene.rest(0, v) < 0.4999) continue;
    fall += scene.rest(2, v) - simulation.history().x(2, v);
    ++count;
  }
  return fall / count / expected;
}

/// Nothing pulls at it, so energies and directions are rounding, and no comparison of the two says anything.
TEST(SolidMotion, a_body_at_rest_without_a_force_stays_there) {
  BodySpec body;
  body.name = "ball";
  body.mesh = solid_ball_mesh(3, 0.47);
  body.mesh.vertices.row(0).array() += 0.485;
  body.d_hat = 1e-2;
  for (const std::string model : {"corotational", "stable_neo_hookean", "arap", "stvk"}) {
    body.material.solid_model = model;
    const Scene scene = scene_of(body);
    Method method = fixed_method("log", 1);
    Simulation simulation(scene, method, 0.01, 3);
    StepObserver observer;
    for (int step = 0; step < 3; ++step) {
      ASSERT_EQ(simulation.step(observer).status, StepStatus::converged) << model << ", step " << step;
    }
    EXPECT_LT((simulation.history().x - scene.x0).cwiseAbs().maxCoeff(), 1e-15) << model;
  }
}

/// Directions within the rounding of the coordinates are no reason to go on: parts of them lower E by noise alone, without an
/// end. A closed band of cloth, as it is before its pulleys move.
TEST(BodyAtRest, a_band_of_cloth_without_a_force_ends_its_steps_at_once) {
  constexpr int n = 48;
  BodySpec body;
  body.name = "band";
  body.d_hat = 1e-3;
  body.material.model = "baraff_witkin";
  body.material.warp_axis = Vec3d::UnitZ();
  body.material.youngs = 100;
  body.material.density = 1;
  body.material.bending = 6.4e-5;
  body.mesh.vertices.resize(3, 2 * n);
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * 3.14159265358979323846 * i / n;
    body.mesh.vertices.col(2 * i) = Vec3d(1.25 * std::cos(angle), 1.25 * std::sin(angle), -0.4);
    body.mesh.vertices.col(2 * i + 1) = Vec3d(1.25 * std::cos(angle), 1.25 * std::sin(angle), 0.4);
    const int next = (i + 1) % n;
    body.mesh.triangles.push_back({2 * i, 2 * next, 2 * next + 1});
    body.mesh.triangles.push_back({2 * i, 2 * next + 1, 2 * i + 1});
  }
  const Scene scene = scene_of(body);
  Method method = fixed_method("log", 1);
  Simulation simulation(scene, method, 0.025, 20);
  StepObserver observer;
  int iterations = 0;
  for (int step = 0; step < 20; ++step) {
    const StepReport report = simulation.step(observer);
    ASSERT_EQ(report.status, StepStatus::converged) << step << ": " << report.detail;
    iterations = std::max(iterations, report.newton_iterations);
  }
  EXPECT_LE(iterations, 6);
  EXPECT_LT((simulation.history().x - scene.x0).cwiseAbs().maxCoeff(), 1e-15);
}

/// Linear tetrahedra are too stiff in bending, by what falls with the square of their size. Timoshenko's beam, which shears too, falls
/// 0.8 % further.
TEST(SolidBeam, a_cantilever_converges_to_euler_and_bernoulli) {
  const double coarse = 1 / relative_fall(2), fine = 1 / relative_fall(4);
  EXPECT_NEAR(coarse, 1.80, 0.02);
  EXPECT_NEAR(fine, 1.20, 0.02);
  EXPECT_NEAR((coarse - 1) / (fine - 1), 4, 0.2);
  EXPECT_NEAR(fine - (coarse - fine) / 3, 1 / 1.008, 0.02);
}

}  // namespace
}  // namespace bb::test::solids
