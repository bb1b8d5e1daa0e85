// Meshes of tetrahedra: generators (volumes, surfaces, conformity), the surface of a solid, PLY there and back, refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <numeric>

#include "core/math/error.hpp"
#include "core/model/mesh/read_mesh.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "core/model/mesh/topology.hpp"
#include "core/model/mesh/write_mesh.hpp"

namespace bb::test::solid_meshes {
namespace {

constexpr double pi = std::numbers::pi;

double volume_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.tetrahedra) sum += tetrahedron_volume(mesh.vertices, t);
  return sum;
}

double smallest_volume(const TriangleMesh& mesh) {
  double least = 1e300;
  for (const auto& t : mesh.tetrahedra) least = std::min(least, tetrahedron_volume(mesh.vertices, t));
  return least;
}

/// Volume inside the surface: that of the tetrahedra exactly where they fill it once.
double enclosed_volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : solid_faces(mesh.tetrahedra).surface) {
    sum += mesh.vertices.col(a).dot(mesh.vertices.col(b).cross(mesh.vertices.col(c))) / 6;
  }
  return sum;
}

long euler_of_surface(const TriangleMesh& mesh) {
  TriangleMesh surface;
  surface.triangles = solid_faces(mesh.tetrahedra).surface;
  std::vector<char> seen(static_cast<std::size_t>(mesh.n_vertices()), 0);
  for (const auto& t : surface.triangles) {
    for (const int v : t) seen[static_cast<std::size_t>(v)] = 1;
  }
  return std::count(seen.begin(), seen.end(), 1) - static_cast<long>(unique_edges(surface).size()) +
         static_cast<long>(surface.triangles.size());
}

/// By its edges: every vertex takes the lowest number that a neighbour has, until none changes.
bool in_one_piece(const TriangleMesh& mesh) {
  std::vector<int> lowest(static_cast<std::size_t>(mesh.n_vertices()));
  std::iota(lowest.begin(), lowest.end(), 0);
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [from, to] : unique_edges(mesh)) {
      int &a = lowest[static_cast<std::size_t>(from)], &b = lowest[static_cast<std::size_t>(to)];
      changed = changed || a != b;
      a = b = std::min(a, b);
    }
  }
  return std::count(lowest.begin(), lowest.end(), 0) == mesh.n_vertices();
}

struct Kind {
  const char* name;
  TriangleMesh (*make)(int n);
  double volume;  // of the curved body, m^3
  long euler;     // of its surface
  bool exact;     // the mesh has that volume
  std::size_t (*count)(std::size_t n);
};

const Kind kinds[] = {
    {"box",
     [](int n) {
       return solid_box_mesh({n, 2 * n, n}, Vec3d(0.4, 0.9, 0.5));
     },
     0.18, 2, true, [](std::size_t n) { return 12 * n * n * n; }},
    {"ball", [](int n) { return solid_ball_mesh(n, 0.7); }, 4 * pi / 3 * 0.343, 2, false,
     [](std::size_t n) { return 20 * n * n * n; }},
    {"cylinder", [](int n) { return solid_cylinder_mesh(n, 2 * n, 0.3, 1.1); }, pi * 0.09 * 1.1, 2, false,
     [](std::size_t n) { return 36 * n * n * n; }},
    {"torus", [](int n) { return solid_torus_mesh(n, 6 * n, 0.5, 0.2); }, 2 * pi* pi * 0.5 * 0.04, 0, false,
     [](std::size_t n) { return 108 * n * n * n; }},
};

TEST(SolidGenerators, fill_their_closed_surface_once_with_tetrahedra_of_positive_volume) {
  for (const Kind& kind : kinds) {
    for (const int n : {1, 2, 3}) {
      SCOPED_TRACE(std::string(kind.name) + " " + std::to_string(n));
      const TriangleMesh mesh = kind.make(n);
      EXPECT_EQ(mesh.tetrahedra.size(), kind.count(static_cast<std::size_t>(n)));
      EXPECT_TRUE(mesh.triangles.empty());
      const SolidFaces faces = solid_faces(mesh.tetrahedra);
      EXPECT_EQ(faces.crowded, -1);
      EXPECT_TRUE(boundary_edges(faces.surface).empty());
      EXPECT_EQ(2 * edge_hinges(faces.surface).size(), 3 * faces.surface.size());
      EXPECT_EQ(euler_of_surface(mesh), kind.euler);
      EXPECT_GT(smallest_volume(mesh), 0.4 * volume_of(mesh) / static_cast<double>(mesh.tetrahedra.size()));
      EXPECT_NEAR(enclosed_volume(mesh), volume_of(mesh), 1e-13);
      EXPECT_TRUE(in_one_piece(mesh));
    }
  }
}

TEST(SolidGenerators, have_volumes_that_converge_to_those_of_the_curved_bodies) {
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.name);
    const auto missing = [&](int n) { return kind.volume - volume_of(kind.make(n)); };
    if (kind.exact) {
      EXPECT_NEAR(missing(3), 0, 1e-15);
      continue;
    }
    const double coarse = missing(3), fine = missing(6);
    EXPECT_GT(fine, 0);
    EXPECT_LT(fine, 0.04 * kind.volume);
    EXPECT_NEAR(coarse / fine, 4, 0.25);
  }
}

TEST(SolidGenerators, refuse_counts_and_sizes_out_of_range) {
  EXPECT_THROW(solid_box_mesh({1, 0, 1}, Vec3d(1, 1, 1)), ConfigError);
  EXPECT_THROW(solid_box_mesh({1, 1, 1}, Vec3d(1, 0, 1)), ConfigError);
  EXPECT_THROW(solid_ball_mesh(0, 1), ConfigError);
  EXPECT_THROW(solid_ball_mesh(1, -1), ConfigError);
  EXPECT_THROW(solid_cylinder_mesh(1, 0, 1, 1), ConfigError);
  EXPECT_THROW(solid_torus_mesh(1, 2, 1, 0.5), ConfigError);
  EXPECT_THROW(solid_torus_mesh(1, 8, 0.5, 0.5), ConfigError);
  EXPECT_THROW(solid_box_mesh({1000, 1000, 1000}, Vec3d(1, 1, 1)), ConfigError);  // memory
}

TEST(solid_faces, are_seen_from_outside_and_find_a_face_of_three) {
  const std::vector<std::array<int, 4>> one{{0, 1, 2, 3}};
  Positions x(3, 4);
  x << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_DOUBLE_EQ(tetrahedron_volume(x, one[0]), 1.0 / 6);
  for (const auto& face : solid_faces(one).surface) {
    const Vec3d middle = (x.col(face[0]) + x.col(face[1]) + x.col(face[2])) / 3;
    EXPECT_GT(area_vector(x, face).dot(middle - Vec3d(0.1, 0.1, 0.1)), 0);
  }
  const std::vector<std::array<int, 4>> three{{0, 1, 2, 3}, {0, 2, 1, 4}, {0, 1, 2, 5}};
  EXPECT_EQ(solid_faces(three).crowded, 0);
  EXPECT_EQ(solid_faces(std::span(three).first(2)).crowded, -1);
  EXPECT_EQ(solid_faces(std::span(three).first(2)).surface.size(), 6u);
}

TEST(SolidFiles, ply_reads_back_bit_for_bit) {
  TriangleMesh mesh = solid_ball_mesh(2, 0.37);
  mesh.triangles = {{0, 1, 2}};
  mesh.segments = {{3, 4}};
  const TriangleMesh back = parse_mesh(ply_bytes(mesh), "ball.ply");
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.tetrahedra, mesh.tetrahedra);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.segments, mesh.segments);
}

/// Four points in space and the lines of `element tetrahedron`.
std::string ascii_ply(int n, const std::string& body, const std::string& list = "uchar int vertex_indices") {
  return "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\nproperty double z\n"
         "element tetrahedron " +
         std::to_string(n) + "\nproperty list " + list + "\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 0\n" +
         body;
}

void expect_refused(const std::string& bytes, const std::string& where, const std::string& found) {
  try {
    parse_mesh(bytes, "a.ply");
    ADD_FAILURE() << "accepted: " << found;
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.violations().front().where, where);
    EXPECT_NE(error.violations().front().found.find(found), std::string::npos)
        << error.violations().front().found;
  }
}

TEST(SolidFiles, refuse_what_is_no_tetrahedron_with_its_line) {
  EXPECT_EQ(parse_mesh(ascii_ply(1, "4 0 1 2 3\n"), "a.ply").tetrahedra,
            (std::vector<std::array<int, 4>>{{0, 1, 2, 3}}));
  expect_refused(ascii_ply(1, "3 0 1 2\n"), "a.ply:15", "3 corners");
  expect_refused(ascii_ply(1, "5 0 1 2 3 4\n"), "a.ply:15", "5 corners");
  expect_refused(ascii_ply(1, "4 0 1 2 7\n"), "a.ply:15", "vertex 7");
  expect_refused(ascii_ply(1, "4 0 1 2 -1\n"), "a.ply:15", "vertex -1");
  expect_refused(ascii_ply(1, "4 0 2 1 3\n"), "a.ply:15", "a tetrahedron of -0.166667 m^3");
  expect_refused(ascii_ply(1, "4 0 1 2 4\n"), "a.ply:15", "a tetrahedron of 0 m^3");
  expect_refused(ascii_ply(1, "4 0 1 1 3\n"), "a.ply:15", "a tetrahedron of 0 m^3");
  expect_refused(ascii_ply(2, "4 0 1 2 3\n4 1 2 0 3\n"), "a.ply:16", "the same corners as at 15");
  expect_refused(ascii_ply(1, "4 0 1 2 3\n", "uchar int corners"), "a.ply",
                 "element tetrahedron without its corners");
}

}  // namespace
}  // namespace bb::test::solid_meshes
