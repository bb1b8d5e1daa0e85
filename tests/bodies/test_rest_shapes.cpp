// Bodies whose rest shape differs from their mesh: shrinking, creep, springs of cloth; and what is refused of them by name.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/energy/families/element_family.hpp"
#include "core/energy/stiffening.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/mesh/topology.hpp"
#include "tests/bodies/bodies.hpp"
#include "tests/energy/host_family.hpp"

namespace bb::rest_shapes_test {
namespace {

using namespace test;

double energy_of(const Scene& scene, const Positions& x) {
  exec::HostExecutor executor;
  std::vector<std::unique_ptr<ElementFamily>> families;
  for (const PartEntry& entry : part_entries()) entry.part.add_families(scene, {executor}, families);
  double sum = 0;
  for (const auto& family : families) {
    std::vector<double> energy(static_cast<std::size_t>(family->size()));
    family->values(x.data(), energy.data());
    for (const double e : energy) sum += e;
  }
  return sum;
}
Positions scaled(const Scene& scene, double x, double y) { return Vec3d(x, y, 1).asDiagonal() * scene.rest; }

TEST(Shrinking, HasItsRestWhereBothFactorsSay) {
  BodySpec body = cloth("cloth");
  body.material.shrink_warp = 0.8;
  body.material.shrink_weft = 1.1;
  const Scene along_x = scene_of({body});
  EXPECT_LT(energy_of(along_x, scaled(along_x, 0.8, 1.1)), 1e-20);
  EXPECT_GT(energy_of(along_x, along_x.rest), 100);
  body.material.warp_axis = Vec3d::UnitY();
  const Scene along_y = scene_of({body});
  EXPECT_LT(energy_of(along_y, scaled(along_y, 1.1, 0.8)), 1e-20);
  EXPECT_EQ(along_x.mass, scene_of({cloth("cloth")}).mass);
}

TEST(Shrinking, LeavesOtherBodiesAsTheyAre) {
  BodySpec plain = cloth("plain"), shrunk = cloth("shrunk", 1), last = cloth("last", 2);
  shrunk.material.shrink_warp = 0.8;
  const Scene scene = scene_of({plain, shrunk, last});
  ASSERT_EQ(scene.membranes.size(), 1u);
  const MembranePart& part = scene.membranes[0];
  const std::size_t n = plain.mesh.triangles.size();
  ASSERT_EQ(part.shrink.size(), 3 * n);
  ASSERT_EQ(part.warp.size(), 3 * n);
  EXPECT_EQ(part.shrink[n - 1], Vec2d(1, 1));
  EXPECT_EQ(part.shrink[n], Vec2d(0.8, 1));
  EXPECT_EQ(part.shrink[2 * n], Vec2d(1, 1));
  const auto first_edge = [&](std::size_t t) {
    const auto& v = part.triangles[t];
    return Vec3d(scene.rest.col(v[1]) - scene.rest.col(v[0]));
  };
  EXPECT_EQ(part.warp[1], first_edge(1));
  EXPECT_EQ(part.warp[n], Vec3d(1, 0, 0));
  EXPECT_EQ(part.warp[3 * n - 1], first_edge(3 * n - 1));
  EXPECT_TRUE(part.creep.empty());
}

TEST(Shrinking, EquallyInAllDirectionsNeedsNone) {
  BodySpec body = cloth("cloth");
  body.material.shrink_warp = body.material.shrink_weft = 0.7;
  const Scene scene = scene_of({body});
  EXPECT_TRUE(scene.membranes[0].warp.empty());
  EXPECT_LT(energy_of(scene, scaled(scene, 0.7, 0.7)), 1e-20);
  body.material.warp_axis = Vec3d::UnitX();
  EXPECT_NE(complaint({body}).find("warp_axis"), std::string::npos);
}

std::string refused(const std::function<void(Material&)>& change) {
  BodySpec body = cloth("cloth");
  change(body.material);
  return complaint({body});
}
void expect_refused(const std::function<void(Material&)>& change, const std::string& words) {
  EXPECT_NE(refused(change).find(words), std::string::npos) << words << "\n" << refused(change);
}

TEST(RestShapes, AreRefusedByNameWhereTheyMeanNothing) {
  expect_refused([](Material& m) { m.shrink_warp = 0.9, m.springs = 5; },
                 "/material/shrink_warp: found 0.9; allowed: 1 with springs_N_per_m");
  expect_refused([](Material& m) { m.membrane_yield = 0.1; }, "/material/membrane_yield: found 0.1");
  expect_refused([](Material& m) { m.membrane_creep = 2, m.model = "none"; }, "0 without a membrane model");
  expect_refused([](Material& m) { m.bending_yield = 0.1, m.bending = 1; },
                 "/material/bending_yield_rad: found 0.1");
  expect_refused([](Material& m) { m.bending_creep = 1; }, "0 without bending_J or bending_exponential_J");
  expect_refused([](Material& m) { m.cloth_yield = 0.1, m.cloth_tension = 1; },
                 "/material/cloth_yield: found 0.1");
  expect_refused([](Material& m) { m.cloth_creep = 0.1; }, "0 without a cloth spring");
  expect_refused([](Material& m) { m.cloth_softening = 0.1; },
                 "/material/cloth_softening_m: found 0.1; allowed: 0 without a cloth spring");
  expect_refused([](Material& m) { m.shrink_weft = 0; }, "shrink_weft");
  expect_refused([](Material& m) { m.shrink_weft = 0.9, m.model = "none"; },
                 "/material/shrink_weft: found 0.9; allowed: 1 without a membrane model");
  expect_refused([](Material& m) { m.bending_exponent = 3, m.bending = 1; },
                 "/material/bending_exponent_per_rad: found 3");
  expect_refused([](Material& m) { m.cloth_exponent = 3, m.cloth_tension = 1; },
                 "/material/cloth_exponent: found 3");
  BodySpec ball = cloth("ball");
  ball.mesh = icosphere_mesh(1, 1);
  ball.material.cloth_skip_one = 4;
  ball.material.cloth_shear = 2, ball.material.cloth_shear_growing = 3;
  for (const char* said :
       {"/cloth_skip_one_N_per_m: found 4; allowed: 0: the mesh is no grid, it has triangle 0, which is no "
        "half of a quad",
        "/cloth_shear_N_per_m: found 2; allowed: 0: no face of the mesh has more than three corners",
        "/cloth_shear_exponential_N_per_m: found 3"}) {
    EXPECT_NE(complaint({ball}).find(said), std::string::npos) << complaint({ball});
  }
  EXPECT_EQ(refused([](Material& m) {
              m.shrink_warp = 0.9, m.membrane_creep = 1, m.membrane_yield = 0.1, m.bending_exponential = 1;
              m.bending_creep = 1, m.cloth_shear = 1, m.cloth_creep = 1;
            }),
            "");
}

TEST(RequireKernels, IsContentWithRestShapesThatChange) {
  BodySpec body = cloth("cloth");
  Material& m = body.material;
  m.bending = m.bending_exponential = m.bending_creep = m.membrane_creep = m.cloth_tension = m.cloth_creep =
      1;
  m.shrink_keys = {{0, 1}, {1, 0.5}};
  EXPECT_NO_THROW(require_kernels(part_entries(), scene_of({body}), "/scene"));
}

// --- springs of cloth

TEST(FaceDiagonals, AreThoseOfQuadsAndPolygons) {
  const TriangleMesh quads = grid_mesh(2, 2, 1, 1);  // 0 1 above 2 3
  EXPECT_EQ(face_diagonals(quads), (std::vector<std::array<int, 2>>{{0, 3}, {1, 2}}));
  EXPECT_EQ(face_sides(quads), (std::vector<std::array<int, 2>>{{0, 1}, {0, 2}, {1, 3}, {2, 3}}));
  EXPECT_EQ(face_diagonals(grid_mesh(4, 3, 1, 1)).size(), 12u);
  EXPECT_EQ(face_sides(grid_mesh(4, 3, 1, 1)).size(), 17u);
  EXPECT_TRUE(face_diagonals(icosphere_mesh(1, 1)).empty());
  EXPECT_EQ(face_sides(icosphere_mesh(1, 1)), unique_edges(icosphere_mesh(1, 1)));
}

/// A sheet of springs alone, with shear.
BodySpec spring_sheet() {
  BodySpec body = cloth("sheet");
  body.material.model = "none";
  body.material.cloth_tension = 50;
  body.material.cloth_compression = 20;
  body.material.cloth_shear = 10;
  return body;
}

TEST(ClothSprings, AreOnSidesAndDiagonalsAndNowhereElse) {
  const Scene scene = scene_of({spring_sheet()});
  EXPECT_EQ(scene.cloth_springs.pairs.size(), 17u + 12u);
  EXPECT_TRUE(scene.springs.edges.empty());
  BodySpec no_shear = spring_sheet();
  no_shear.material.cloth_shear = 0;
  EXPECT_EQ(scene_of({no_shear}).cloth_springs.pairs.size(), 17u);
}

TEST(ClothSprings, OfVerticesTwoApartAreAlongTheLinesOfAGrid) {
  BodySpec body = cloth("net");
  body.mesh = grid_mesh(15, 15, 1.4, 1.4);
  body.material = spring_sheet().material;
  body.material.cloth_skip_one = 7;
  body.material.cloth_softening = 1e-3;
  const ClothSpringPart& springs = scene_of({body}).cloth_springs;
  ASSERT_EQ(springs.pairs.size(), 1202U);  // as the net of jaxls's example has
  int two_apart = 0;
  for (std::size_t e = 0; e < springs.pairs.size(); ++e) {
    EXPECT_EQ(springs.softening[e], 1e-3);
    if (springs.tension[e] != 7) continue;
    ++two_apart;
    EXPECT_EQ(springs.compression[e], 7);
    EXPECT_NEAR(springs.rest_length[e], 0.2, 1e-15);
    const int way = springs.pairs[e][1] - springs.pairs[e][0];
    EXPECT_TRUE(way == 2 || way == 30) << way;
  }
  EXPECT_EQ(two_apart, 2 * 13 * 15);
  body.material.cloth_tension = body.material.cloth_compression = body.material.cloth_shear = 0;
  EXPECT_EQ(scene_of({body}).cloth_springs.pairs.size(), 390U);
}

TEST(ClothSprings, HaveTheEnergyOfTheirClosedForm) {
  BodySpec body = spring_sheet();
  body.material.cloth_tension_growing = 5;
  body.material.cloth_compression_growing = 2;
  body.material.cloth_shear_growing = 1;
  body.material.cloth_exponent = 4;
  const Scene scene = scene_of({body});
  const Positions x = scaled(scene, 1.2, 0.9);
  // 4 x 3 vertices over 1.5 m x 1 m: sides of 0.5 m.
  const auto of = [](double l, double l0, double k, double q) {
    return stiffened<double>(l - l0, k, q, 4 / l0).energy;
  };
  const double diagonal = std::sqrt(0.5), turned = std::hypot(0.6, 0.45);
  const double expected =
      9 * of(0.6, 0.5, 50, 5) + 8 * of(0.45, 0.5, 20, 2) + 12 * of(turned, diagonal, 10, 1);
  EXPECT_NEAR(energy_of(scene, x), expected, 1e-12 * expected);
  EXPECT_GT(expected, 1);
}

TEST(ClothSprings, HoldAQuadThatSidesAloneLetShear) {
  BodySpec body = spring_sheet();
  const Scene sheared = scene_of({body});
  body.material.cloth_shear = 0;
  const Scene free = scene_of({body});
  Positions x = sheared.rest;  // sides keep their lengths, a mechanism of the sides alone
  const double angle = 0.3;
  for (int v = 0; v < x.cols(); ++v) {
    const double a = sheared.rest(0, v), b = sheared.rest(1, v);
    x.col(v) = Vec3d(a + b * std::sin(angle), b * std::cos(angle), 0);
  }
  EXPECT_LT(energy_of(free, x), 1e-20);
  EXPECT_GT(energy_of(sheared, x), 0.1);
}

TEST(ClothSprings, ShrinkWithTheBody) {
  BodySpec body = spring_sheet();
  body.material.shrink_warp = 0.8;
  body.material.shrink_weft = 1.1;
  const Scene scene = scene_of({body});
  EXPECT_LT(energy_of(scene, scaled(scene, 0.8, 1.1)), 1e-20);
  EXPECT_GT(energy_of(scene, scene.rest), 0.5);
}

TEST(ClothSprings, RememberRatiosOfTheirRestLengths) {
  BodySpec body = spring_sheet();
  body.material.shrink_warp = body.material.shrink_weft = 0.5;
  body.material.cloth_shear = 0;
  body.material.cloth_yield = 0.1;
  body.material.cloth_creep = 3;
  const Scene scene = scene_of({body});
  HostFamily family(
      [&](const FamilyPlace& place) { return cloth_spring_family(place, scene.cloth_springs); });
  ASSERT_EQ(family.memory(), std::vector<double>(17, 1.0));
  family.step(scaled(scene, 0.5 * 1.1, 0.5 * 0.95), 0.2);
  for (const double ratio : family.memory()) EXPECT_NEAR(ratio, 1, 1e-15);  // within the yield
  family.step(scaled(scene, 0.5 * 1.5, 0.5 * 0.6), 0.2);
  const double kept = std::exp(-0.6);
  const std::vector<double> memory = family.memory(), energy = family.values(scaled(scene, 0.75, 0.3));
  const double longer = 1.5 / (1 + 0.1 + 0.4 * kept), shorter = 0.6 / (1 - 0.1 - 0.3 * kept);
  int n_long = 0;
  for (std::size_t e = 0; e < 17; ++e) {
    const auto& [a, b] = scene.cloth_springs.pairs[e];
    const bool along_x = std::abs(scene.rest(1, a) - scene.rest(1, b)) < 1e-9;
    n_long += along_x;
    EXPECT_NEAR(memory[e], along_x ? longer : shorter, 1e-14);
    const double l = along_x ? 0.375 : 0.15, l0 = 0.25 * memory[e];
    EXPECT_NEAR(energy[e], 0.5 * (along_x ? 50 : 20) * (l - l0) * (l - l0), 1e-14);
  }
  EXPECT_EQ(n_long, 9);
}

}  // namespace
}  // namespace bb::rest_shapes_test
