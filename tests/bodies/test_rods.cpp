// Rods of a body: where they bend, how stiff, at which rest angles, what is refused; their stretch.
#include <gtest/gtest.h>

#include <numbers>

#include "core/exec/host_executor.hpp"
#include "core/model/bodies/part.hpp"
#include "tests/bodies/bodies.hpp"

namespace bb::rods_test {
namespace {

using namespace test;
using parts::rods::RestAngle;

constexpr double pi = std::numbers::pi;

BodySpec rod_of(TriangleMesh mesh) {
  BodySpec rod;
  rod.name = "rod";
  rod.mesh = std::move(mesh);
  rod.material.line_density = 0.3;
  rod.material.rod_bending = 0.02;
  rod.d_hat = 0.001;
  return rod;
}

TEST(rods, bend_at_every_inner_vertex_of_a_chain) {
  const Scene scene = scene_of({rod_of(rod_mesh(4, Vec3d(0, 1, 0), Vec3d(2, 0, 0)))});

  EXPECT_EQ(scene.rods.corners, (std::vector<std::array<int, 3>>{{0, 1, 2}, {1, 2, 3}, {2, 3, 4}}));
  for (const double k : scene.rods.stiffness) EXPECT_NEAR(k, 0.02 / (std::sqrt(5) / 4), 1e-15);
  EXPECT_EQ(scene.rods.rest_angle,
            std::vector<double>(3, 0.0));  // exactly, whatever the rounding of the mesh
}

TEST(rods, are_as_stiff_as_their_mean_segment_and_mass_say) {
  BodySpec rod = rod_of(rod_mesh(2, Vec3d(0, 0, 0), Vec3d(2, 0, 0)));
  rod.mesh.vertices.col(1) = Vec3d(0.5, 0, 0);
  rod.mesh.vertices.col(2) = Vec3d(0.5, 2, 0);

  EXPECT_NEAR(scene_of({rod}).rods.stiffness[0], 0.02 / 1.25, 1e-17);
  EXPECT_NEAR(scene_of({rod}).rods.rest_angle[0], pi / 2, 1e-15);
  rod.material.rod_bending_per_mass = 7;
  EXPECT_NEAR(scene_of({rod}).rods.stiffness[0], 0.02 / 1.25 + 7 * 0.3 * 1.25, 1e-15);
  rod.material.rod_bending = 0;
  EXPECT_NEAR(scene_of({rod}).rods.stiffness[0], 7 * 0.3 * 1.25, 1e-15);
  BodySpec weightless = rod;
  weightless.material.line_density = 0;
  const std::string said = complaint({weightless});
  EXPECT_NE(said.find("/material/rod_bending_J_per_kg: found 7"), std::string::npos) << said;
  rod.material.rod_bending_per_mass = 0;
  EXPECT_TRUE(scene_of({rod}).rods.corners.empty());
}

double bending_energy(const Scene& scene) {
  exec::HostExecutor executor;
  std::vector<std::unique_ptr<ElementFamily>> families;
  parts::rods::part().add_families(scene, {executor}, families);
  std::vector<double> energy(static_cast<std::size_t>(families.at(0)->size()));
  families[0]->values(scene.x0.data(), energy.data());
  double sum = 0;
  for (const double each : energy) sum += each;
  return sum;
}

/// E I/2 times 1/R^2 over 2 pi R is pi E I/R, to which the polygon's energy converges with the square of its segments.
TEST(rods, of_a_closed_loop_have_the_energy_of_its_curvature) {
  double error[3];
  for (int level = 0; level < 3; ++level) {
    const int n = 12 << level;
    BodySpec ring = rod_of(ring_mesh(n, 0.4));
    EXPECT_EQ(scene_of({ring}).rods.corners.size(), static_cast<std::size_t>(n));
    EXPECT_NEAR(scene_of({ring}).rods.rest_angle[0], 2 * pi / n, 1e-14);
    EXPECT_LT(bending_energy(scene_of({ring})), 1e-25);
    ring.material.rod_rest = RestAngle::straight;
    error[level] = bending_energy(scene_of({ring})) / (pi * 0.02 / 0.4) - 1;
  }
  EXPECT_GT(error[0], 1e-3);
  EXPECT_LT(error[0], 0.02);
  EXPECT_NEAR(error[0] / error[1], 4, 0.1);
  EXPECT_NEAR(error[1] / error[2], 4, 0.1);
}

TEST(rods, that_branch_are_refused_only_where_they_bend) {
  BodySpec star = rod_of(rod_mesh(3, Vec3d(0, 0, 0), Vec3d(3, 0, 0)));
  star.mesh.vertices.col(3) = Vec3d(1, 1, 0);
  star.mesh.segments = {{0, 1}, {1, 2}, {1, 3}};

  const std::string said = complaint({star});
  EXPECT_NE(said.find("body \"rod\"/material/rod_bending_N_m2"), std::string::npos) << said;
  EXPECT_NE(said.find("vertex 1 in 3 lone edges"), std::string::npos) << said;
  EXPECT_NE(said.find("at most 2"), std::string::npos) << said;
  star.material.rod_bending = 0;
  EXPECT_EQ(complaint({star}), "");
  star.material.rod_bending_per_mass = 1;
  EXPECT_NE(complaint({star}).find("/material/rod_bending_J_per_kg"), std::string::npos);
}

TEST(rods, with_no_angle_at_rest_are_refused) {
  BodySpec rod = rod_of(rod_mesh(2, Vec3d(0, 0, 0), Vec3d(2, 0, 0)));
  rod.mesh.vertices.col(2) = Vec3d(0.25, 0, 0);
  EXPECT_NE(complaint({rod}).find("folds back at vertex 1"), std::string::npos) << complaint({rod});
  rod.material.rod_rest = RestAngle::straight;
  EXPECT_EQ(complaint({rod}), "");
  rod.mesh.vertices.col(2) = rod.mesh.vertices.col(1);
  EXPECT_NE(complaint({rod}).find("without length at vertex 1"), std::string::npos) << complaint({rod});
}

TEST(rods, do_not_bend_where_all_three_vertices_are_held) {
  BodySpec rod = rod_of(rod_mesh(5, Vec3d(0, 0, 0), Vec3d(1, 0, 0)));
  rod.pins.emplace_back().indices = {0, 1, 2, 5};
  EXPECT_EQ(scene_of({rod}).rods.corners.size(), 3u);
}

TEST(rods, stretch_by_their_force_a_strain_whatever_the_length_of_their_segments) {
  BodySpec rod = rod_of(rod_mesh(4, Vec3d(0, 0, 0), Vec3d(2, 0, 0)));
  rod.material.rod_stretching = 30;
  EXPECT_EQ(scene_of({rod}).springs.stiffness, std::vector<double>(4, 60.0));
  rod.material.springs = 5;
  EXPECT_EQ(scene_of({rod}).springs.stiffness, std::vector<double>(4, 65.0));

  BodySpec sheet = cloth("sheet");
  sheet.material.rod_stretching = 30;
  EXPECT_NE(complaint({sheet}).find("found 30.0; allowed: nothing: the body has no lone edge"),
            std::string::npos)
      << complaint({sheet});
  rod.material.springs = 0;
  rod.mesh.vertices.col(4) = rod.mesh.vertices.col(3);
  EXPECT_NE(complaint({rod}).find("/material/rod_stretching_N"), std::string::npos) << complaint({rod});
}

}  // namespace
}  // namespace bb::rods_test
