// Rows on lagged contacts on an executor, and the sums over contacts of the host that they are compared with.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>

#include "core/base/archive/archive.hpp"
#include "core/contact/contact_loads.hpp"
#include "core/contact/executor/lagged_assembly.hpp"
#include "core/energy/friction_law.hpp"
#include "core/energy/friction_list.hpp"
#include "core/exec/sums/executor_sum.hpp"
#include "core/terms/friction_rows.hpp"
#include "core/terms/lagged_family.hpp"
#include "core/terms/restitution_rows.hpp"
#include "tests/executor/assembled.hpp"

namespace bb::lagged_rows_test {

using namespace bb::test;  // NOLINT(google-build-using-namespace): the fixture of two tests of this namespace
using exec::LaggedAssembly;

inline constexpr double eps_m = 2e-3;

inline constexpr double dt = 0.01;  // s

/// Of the bodies and obstacles of full_scene().
inline std::vector<double> coefficients(std::size_t n, double first) {
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(i == 1 ? 0 : first + 0.1 * static_cast<double>(i));
  return out;
}

struct Sides {
  CombineRule rule;
  std::vector<double> of_body, of_obstacle;
  explicit Sides(const Scene& scene, CombineRule of)
      : rule(of),
        of_body(coefficients(scene.bodies.size(), 0.2)),
        of_obstacle(coefficients(scene.obstacles.size(), 0.35)) {}
};
template <class Side>
void set_friction(std::vector<Side>& sides, const std::vector<double>& mu) {
  for (std::size_t i = 0; i < sides.size(); ++i) sides[i].friction = mu[i];
}
/// full_scene() whose bodies and obstacles have these coefficients of friction.
inline Scene with_friction(Scene scene, const Sides& sides) {
  set_friction(scene.bodies, sides.of_body);
  set_friction(scene.obstacles, sides.of_obstacle);
  return scene;
}
/// The same with restitution, and with speeds.
inline Scene with_restitution(Scene scene) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    scene.bodies[i].restitution = 0.3 + 0.1 * static_cast<double>(i);
  scene.obstacles[0].restitution = 0.9;
  scene.v0 = random_motion(Positions::Zero(3, scene.n_vertices()), 0.5, 4);
  return scene;
}
inline Sides restitution_sides(const Scene& scene) {
  Sides out(scene, CombineRule::max);
  const auto of = [](const auto& side) { return restitution_damping(side.restitution.value_or(1)); };
  std::transform(scene.bodies.begin(), scene.bodies.end(), out.of_body.begin(), of);
  std::transform(scene.obstacles.begin(), scene.obstacles.end(), out.of_obstacle.begin(), of);
  return out;
}
inline FrictionOptions friction_options(const std::string& law, CombineRule rule) {
  FrictionOptions out;
  out.law = law;
  out.combine = rule;
  out.eps_v = eps_m / dt;
  return out;
}

/// The rows of the host at x, with loads, and how strong each is.
struct HostLaggedState {
  ContactLoads contacts;
  std::vector<double> strength;
  HostLaggedState(const Scene& scene, const Positions& x, const Sides& sides) {
    ContactSystem system(scene, {});
    Rows rows = rows_at(system, x);
    evaluate_cubic(rows.table);
    evaluate_cubic(rows.mollified);
    add_loads(rows.table, contacts);
    add_loads(rows.mollified, x, contacts);
    for (std::size_t r = 0; r < contacts.size(); ++r) {
      const int* const vertex = &contacts.stencil[4 * r];
      int last = 3;
      while (vertex[last] < 0) --last;
      const auto of_body = [&](int v) { return sides.of_body[at(scene.body[at(v)])]; };
      const int obstacle = pair_obstacle(contacts.pair[r]);
      const double other = obstacle >= 0 ? sides.of_obstacle[at(obstacle)] : of_body(vertex[last]);
      strength.push_back(combined(sides.rule, of_body(vertex[0]), other) * contacts.load[r]);
    }
  }
  Vec3d relative(std::size_t r, const Positions& motion) const {
    Vec3d out = Vec3d::Zero();
    for (std::size_t k = 4 * r; k < 4 * r + 4 && contacts.stencil[k] >= 0; ++k)
      out += contacts.weight[k] * motion.col(contacts.stencil[k]);
    return out;
  }
  Vec3d normal(std::size_t r) const { return Vec3d::Map(&contacts.normal[3 * r]); }
};

struct Sums {
  double energy = 0;
  VecXd gradient, force;
  Matrix matrix;
};

/// terms(lagged, r, motion): MotionTerms.
template <class Terms>
Sums sums_of(const HostLaggedState& lagged, const Scene& scene, const Positions& way, const Positions& given,
             const Terms& terms) {
  const auto n = 3 * scene.n_vertices();
  const Surface surface(scene);
  Sums out{0, VecXd::Zero(n), VecXd::Zero(n), Matrix::Zero(n, n)};
  for (std::size_t r = 0; r < lagged.contacts.size(); ++r) {
    const MotionTerms<double> of = terms(lagged, r, lagged.relative(r, way));
    out.energy += of.energy;
    const Vec3d moved = of.hess * lagged.relative(r, given);
    for (std::size_t i = 4 * r; i < 4 * r + 4; ++i) {
      const int vi = lagged.contacts.stencil[i];
      if (vi < 0 || surface.vertex_free[at(vi)] == 0) continue;
      out.gradient.segment<3>(3 * vi) += lagged.contacts.weight[i] * of.grad;
      out.force.segment<3>(3 * vi) += lagged.contacts.weight[i] * moved;
      for (std::size_t j = 4 * r; j < 4 * r + 4; ++j) {
        const int vj = lagged.contacts.stencil[j];
        if (vj < 0 || surface.vertex_free[at(vj)] == 0) continue;
        out.matrix.block<3, 3>(3 * vi, 3 * vj) +=
            lagged.contacts.weight[i] * lagged.contacts.weight[j] * of.hess;
      }
    }
  }
  return out;
}

/// A family on an executor with the rows at x, from where a step begins, and what it sums up.
struct OnRows {
  using Family = std::unique_ptr<LaggedFamily>;
  OnExecutor on;
  ContactAssembly contact;
  Family family;
  LaggedAssembly assembly;
  exec::Buffer<double> x_n, y, moved, energy, force, hess, gradient, given;

  /// make(body): the family.
  template <class Make>
  OnRows(exec::Executor& executor, const Scene& scene, const Positions& x, double length, const Make& make)
      : on(executor, scene, x),
        contact(executor, on.surface_there, scene.n_vertices()),
        family(make(on.surface_there.view().body)),
        assembly(executor, family->rows(), scene.n_vertices()),
        x_n(executor, "start"),
        y(executor, "state"),
        moved(executor, "motion"),
        energy(executor, "energy"),
        force(executor, "force"),
        hess(executor, "hess"),
        gradient(executor, "gradient", 3 * scene.n_vertices()),
        given(executor, "given", 3 * scene.n_vertices()) {
    on.rows.uniform_kappa = kappa;
    ExecutorBarrier(cubic(), false).evaluate(executor, on.rows);
    upload(x_n, x);
    FamilyStep step;
    step.x_n = step.x_tilde = x_n.data();
    step.dt = step.t_end = length;
    family->begin_step(step);
    take();
  }
  void take() {
    assembly.take(on.rows);
    family->take(x_n.data(), x_n.size());
    EXPECT_FALSE(family->loads_known());
    assembly.learn(contact.row_energy(on.rows, on.x));
    family->know_loads();
    EXPECT_TRUE(family->loads_known());
  }
  Sums sums(const Positions& to, const Positions& motion) {
    upload(y, to), upload(moved, motion);
    const Index n = family->size();
    energy.resize(n), force.resize(3 * n), hess.resize(6 * n);
    gradient.fill_zero(), given.fill_zero();
    family->changes(y.data(), moved.data(), force.data());
    assembly.add_forces(force.data(), given);
    family->gradients(y.data(), energy.data(), force.data());
    assembly.add_forces(force.data(), gradient);
    const std::vector<double> energies = energy.download();
    family->values(y.data(), energy.data());
    EXPECT_EQ(energy.download(), energies);
    family->hessians(y.data(), hess.data());
    const MatrixPart part = assembly.matrix(hess.data());
    const int n_vertices = static_cast<int>(gradient.size() / 3);
    Sums out{0, VecXd::Map(gradient.data(), gradient.size()), VecXd::Map(given.data(), given.size()),
             dense(part, n_vertices)};
    for (const double e : energies) out.energy += e;
    return out;
  }
};
inline OnRows friction_on(exec::Executor& executor, const Scene& scene, const Positions& x,
                          const FrictionOptions& options) {
  return {executor, scene, x, dt, [&](const int* body) {
            TermOptions all;
            all.friction = options;
            return friction_family({executor}, scene, all, body);
          }};
}
inline OnRows restitution_on(exec::Executor& executor, const Scene& scene, const Positions& x,
                             double length) {
  return {executor, scene, x, length,
          [&](const int* body) { return restitution_family({executor}, scene, {}, body); }};
}

inline void expect_same(const Sums& found, const Sums& expected) {
  ASSERT_GT(expected.energy, 1e-6);
  ASSERT_GT(expected.gradient.norm(), 1e-3);
  ASSERT_GT(expected.force.norm(), 1e-3);
  ASSERT_GT(expected.matrix.norm(), 1);
  EXPECT_NEAR(found.energy, expected.energy, 1e-12 * expected.energy);
  EXPECT_LT((found.gradient - expected.gradient).norm(), 1e-12 * expected.gradient.norm());
  EXPECT_LT((found.force - expected.force).norm(), 1e-12 * expected.force.norm());
  EXPECT_LT((found.matrix - expected.matrix).norm(), 1e-12 * expected.matrix.norm());
}

}  // namespace bb::lagged_rows_test
