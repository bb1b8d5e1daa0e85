// Stitches, shrinking, inflation of closed bodies and the spans of pulls against their closed forms. Loads element by element: tests/energy/test_load_families.cpp;
// derivatives of terms against each other: test_every_term.cpp and test_projections.cpp.
#include <gtest/gtest.h>

#include "core/model/mesh/generators.hpp"
#include "core/model/mesh/topology.hpp"
#include "tests/terms/at_iterate.hpp"

namespace bb::driven_terms_test {
namespace {

constexpr double dt = 0.05;

StepFrame frame_of(const Scene& scene, double t_end) {
  StepFrame out;
  out.x_n = out.x_tilde = scene.x0;
  out.dt = dt;
  out.t_end = t_end;
  return out;
}

/// A term of a scene, linearised at x with its exact Hessian.
struct Linearised {
  test::TermsOf all;
  const HostTerm* term = nullptr;
  Linearised(const Scene& scene, const char* name, const Positions& x, double t_end = dt)
      : all(scene, scene.x0, frame_of(scene, t_end)) {
    for (const auto& each : all.terms) {
      if (each->name() != name) continue;
      each->linearise(x, all.context(Projection::none));
      term = each.get();
    }
  }
  const TermFamily& family() const { return term->families()[0]; }
  Positions gradient() const { return test::gradient_of(*term, all.scene.n_vertices()); }
};

BodySpec triangle() {
  BodySpec out;
  out.name = "triangle";
  out.mesh.vertices.resize(3, 3);
  out.mesh.vertices << 0, 0.9, 0.2, 0.1, 0, 0.8, 0, 0.3, -0.2;
  out.mesh.triangles = {{0, 1, 2}};
  out.d_hat = 1e-3;
  return out;
}

Scene built(const BodySpec& body) {
  SceneBuilder builder("scene", false, Vec3d(0, 0, -10), "test");
  builder.add_body(body);
  return builder.finish();
}

TEST(Pull, acts_in_the_steps_whose_middle_is_between_hold_and_release) {
  BodySpec body = triangle();
  PinSpec& pin = body.pins.emplace_back();
  pin.indices = {1};
  pin.pull = 40;
  pin.span = {0.1, 0.3};
  const Scene scene = built(body);
  Positions x = scene.x0;
  x(0, 1) += 0.3;
  const auto force = [&](int step) {
    double t_end = 0;
    for (int i = 0; i < step; ++i) t_end += dt;  // as a run adds them up
    return Linearised(scene, "pull", x, t_end).gradient().norm();
  };
  for (const int step : {1, 2, 7, 8}) EXPECT_EQ(force(step), 0) << step;
  for (const int step : {3, 4, 5, 6}) EXPECT_NEAR(force(step), 12, 1e-12) << step;
}

TEST(Stitch, has_a_length_where_it_pulls_nobody) {
  SceneBuilder builder("scene", false, Vec3d(0, 0, -10), "test");
  BodySpec one = triangle(), other = triangle();
  other.name = "other";
  other.mesh.vertices.row(2).array() += 1;
  builder.add_body(one);
  builder.add_body(other);
  builder.add_stitch({"other", "triangle", {0}, {0}, 6, 0.75}, "/stitches/0");
  const Scene scene = builder.finish();
  const Linearised at_start(scene, "stitch", scene.x0);
  ASSERT_NE(at_start.term, nullptr);
  EXPECT_NEAR(at_start.gradient()(2, 3), 6 * 0.25, 1e-14);
  EXPECT_NEAR(at_start.family().local.energy[0], 3 * 0.25 * 0.25, 1e-15);
  Positions x = scene.x0;
  x(2, 3) = x(2, 0) + 0.5;
  EXPECT_NEAR(Linearised(scene, "stitch", x).gradient()(2, 3), -6 * 0.25, 1e-14) << "it pushes too";
  x(2, 3) = x(2, 0) + 0.75;
  EXPECT_NEAR(Linearised(scene, "stitch", x).gradient().norm(), 0, 1e-14);
}

TEST(Shrinking, over_time_is_that_of_the_factor_at_the_end_of_the_step) {
  for (const char* part : {"membrane", "cloth_springs"}) {
    for (const double creep : {0.0, 3.0}) {
      BodySpec body = triangle();
      if (std::string(part) == "cloth_springs") {
        body.material.model = "none";
        body.material.cloth_tension = body.material.cloth_compression = 20;
        body.material.cloth_creep = creep;
      } else {
        body.material.model = "corotational";
        body.material.membrane_creep = creep;
      }
      BodySpec constant = body;
      constant.material.shrink_warp = 0.9 * 0.8;
      constant.material.shrink_weft = 1.1 * 0.8;
      body.material.shrink_warp = 0.9;
      body.material.shrink_weft = 1.1;
      body.material.shrink_keys = {{0, 1}, {1, 0.6}};
      const Scene scene = built(body), shrunk = built(constant);
      Positions x = scene.x0;
      x(0, 1) += 0.2;
      const Linearised now(scene, part, x, 0.5), expected(shrunk, part, x);
      ASSERT_NE(now.term, nullptr);
      ASSERT_GT(expected.gradient().norm(), 0.1);
      EXPECT_LT((now.gradient() - expected.gradient()).norm(), 1e-12 * expected.gradient().norm()) << part;
      const Linearised later(scene, part, x, 1);
      EXPECT_GT((later.gradient() - expected.gradient()).norm(), 0.01) << part;
    }
  }
}

TEST(Stitch, is_the_square_of_the_distance) {
  SceneBuilder builder("scene", false, Vec3d(0, 0, -10), "test");
  BodySpec one = triangle(), other = triangle();
  other.name = "other";
  other.mesh.vertices.row(2).array() += 1;
  builder.add_body(one);
  builder.add_body(other);
  builder.add_stitch({"other", "triangle", {2, 0}, {1, 0}, 6}, "/stitches/0");
  const Scene scene = builder.finish();
  EXPECT_EQ(scene.stitches.pairs, (std::vector<std::array<int, 2>>{{5, 1}, {3, 0}}));
  Positions x = scene.x0;
  x.col(3) = x.col(0);  // at the length 0 too
  const Linearised stitch(scene, "stitch", x);
  ASSERT_NE(stitch.term, nullptr);
  const Vec3d apart = x.col(1) - x.col(5);
  EXPECT_LT((stitch.gradient().col(1) - 6 * apart).norm(), 1e-13);
  EXPECT_LT((stitch.gradient().col(5) + 6 * apart).norm(), 1e-13);
  EXPECT_EQ(stitch.gradient().col(3), Vec3d(0, 0, 0));
  EXPECT_NEAR(stitch.family().local.energy[0], 3 * apart.squaredNorm(), 1e-13);
  for (const std::size_t e : {0, 1}) {
    const double* blocks = &stitch.family().local.hess[27 * e];
    EXPECT_LT((Mat3d::Map(blocks) - 6 * Mat3d::Identity()).norm(), 1e-13);
    EXPECT_LT((Mat3d::Map(blocks + 9) + 6 * Mat3d::Identity()).norm(), 1e-13);
    EXPECT_LT((Mat3d::Map(blocks + 18) - 6 * Mat3d::Identity()).norm(), 1e-13);
  }
}

TEST(Inflation, is_the_pressure_times_the_volume) {
  BodySpec box;
  box.name = "box";
  box.mesh = solid_box_mesh({2, 1, 1}, Vec3d(0.5, 0.4, 0.3));
  box.d_hat = 1e-3;
  box.pressure = 20;
  const Scene scene = built(box);
  Positions x = scene.x0;
  x.row(1) *= 1.5;
  x.row(0) += 0.2 * x.row(2);  // shear keeps the volume
  const Linearised inflation(scene, "inflation", x);
  ASSERT_NE(inflation.term, nullptr);
  const double volume = 0.5 * 0.4 * 0.3 * 1.5;
  EXPECT_NEAR(test::iterate_energy(*inflation.term), -20 * volume, 1e-13);
  const Positions gradient = inflation.gradient();
  EXPECT_LT(gradient.rowwise().sum().norm(), 1e-13);
  const Positions off = x.colwise() - scene.x0.rowwise().mean();
  EXPECT_NEAR(gradient.cwiseProduct(off).sum(), 3 * -20 * volume, 1e-12) << "a cubic form";
  EXPECT_NEAR(test::curvature_along(*inflation.term, off), 6 * -20 * volume, 1e-12);
  const Positions sideways = Positions::Zero(3, x.cols()).colwise() + Vec3d(1, 2, 3);
  EXPECT_NEAR(test::curvature_along(*inflation.term, sideways), 0, 1e-12);
}

TEST(Inflation, presses_outwards_whichever_way_the_surface_is_seen) {
  BodySpec box;
  box.name = "box";
  box.mesh = solid_box_mesh({1, 1, 1}, Vec3d(0.5, 0.4, 0.3));
  box.mesh.tetrahedra.clear();
  box.mesh.triangles = solid_faces(solid_box_mesh({1, 1, 1}, Vec3d(0.5, 0.4, 0.3)).tetrahedra).surface;
  box.material.density = 1;
  box.d_hat = 1e-3;
  box.pressure = 20;
  const double outward = test::iterate_energy(*Linearised(built(box), "inflation", box.mesh.vertices).term);
  for (auto& t : box.mesh.triangles) std::swap(t[1], t[2]);
  const double inward = test::iterate_energy(*Linearised(built(box), "inflation", box.mesh.vertices).term);
  EXPECT_NEAR(outward, -20 * 0.06, 1e-13);
  EXPECT_NEAR(inward, outward, 1e-13);
  box.mesh.triangles.pop_back();
  try {
    built(box);
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("body \"box\"/pressure"), std::string::npos) << text;
    EXPECT_NE(text.find("does not close at the edge of vertices"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace bb::driven_terms_test
