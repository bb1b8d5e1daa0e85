// A rod that comes to rest in the groove of two others: what carries it is its weight, at every small angle between
// them. From 1.5 degrees on its ends stand out of the groove and it turns out of it.
#include <gtest/gtest.h>

#include "tests/newton/small_scenes.hpp"

namespace bb::rods_test {
namespace {

constexpr double d_hat = 0.005, line_density = 0.02, length = 0.4;

BodySpec rod(const std::string& name, int n_segments, double rod_length, const Vec3d& middle, double turn) {
  BodySpec body;
  body.name = name;
  body.mesh.vertices.resize(3, n_segments + 1);
  for (int i = 0; i <= n_segments; ++i) {
    const double s = rod_length * (static_cast<double>(i) / n_segments - 0.5);
    body.mesh.vertices.col(i) = middle + s * Vec3d(std::cos(turn), std::sin(turn), 0);
  }
  for (int i = 0; i < n_segments; ++i) body.mesh.segments.push_back({i, i + 1});
  body.material.line_density = line_density;
  body.material.springs = 2000;
  body.material.model = "none";
  body.d_hat = d_hat;
  return body;
}

/// The force that contact puts on all free vertices, N.
Vec3d contact_force(const ContactState& contacts, const Positions& x) {
  Vec3d out = Vec3d::Zero();
  std::vector<double> grad, hess;
  const auto add = [&](const auto& table) {
    for (std::size_t r = 0; r < table.size(); ++r) {
      for (int k = 0; k < table.n_free[r]; ++k) {
        out -= Vec3d::Map(&grad[12 * r + 3 * static_cast<std::size_t>(k)]);
      }
    }
  };
  contact_terms(contacts.rows, x, HessianMode::gauss_newton, Projection::none, grad, hess);
  add(contacts.rows);
  mollified_terms(contacts.mollified, x, Projection::none, grad, hess);
  add(contacts.mollified);
  return out;
}

TEST(Rods, RestInAGrooveByTheirWeight) {
  for (const double degrees : {0.0, 1e-7, 1e-3, 0.1, 0.5}) {
    SceneBuilder builder("rods", false, Vec3d(0, 0, -10), "test");
    builder.add_body(rod("falling", 4, length, Vec3d(0.03, 0, 0.0042), degrees * std::numbers::pi / 180));
    for (const double y : {-0.002, 0.002}) {
      BodySpec fixed = rod("fixed", 3, 1.0, Vec3d(0, y, 0), 0);
      fixed.name += y < 0 ? "_left" : "_right";
      fixed.kind = BodyKind::rigid;
      builder.add_body(fixed);
    }
    const Scene scene = builder.finish();
    Method method = test::fixed_method("log", 50);
    method.step_solver.tol_velocity = 1e-9;
    Simulation simulation(scene, method, 0.01, 150);
    StepObserver observer;
    for (int i = 0; i < 150; ++i) {
      const StepReport report = simulation.step(observer);
      ASSERT_EQ(report.status, StepStatus::converged) << degrees << ", step " << i << ": " << report.detail;
    }
    const ContactState& contacts = test::rows_of(simulation.system());
    ASSERT_GT(contacts.size(), 0U);
    EXPECT_GT(contacts.gap_min, 0.1 * d_hat) << degrees;
    const double weight = 10 * line_density * length;
    EXPECT_NEAR(contact_force(contacts, simulation.history().x)[2], weight, 0.01 * weight) << degrees;
    EXPECT_LT(simulation.history().v.leftCols(5).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace bb::rods_test
