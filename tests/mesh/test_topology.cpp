// Edges, boundary, hinges and components of small meshes worked out by hand.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/model/mesh/generators.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

// 2 - 3
// | / |   two triangles (0, 1, 3) and (0, 3, 2), and a lone edge to vertex 4; vertex 5 stands alone
// 0 - 1
TriangleMesh two_triangles() {
  TriangleMesh mesh = grid_mesh(2, 2, 1, 1);
  mesh.vertices.conservativeResize(3, 6);
  mesh.vertices.col(4) = Vec3d(2, 0, 0);
  mesh.vertices.col(5) = Vec3d(3, 0, 0);
  mesh.segments = {{4, 1}};
  return mesh;
}

TEST(topology, lists_every_edge_once) {
  EXPECT_EQ(unique_edges(two_triangles()),
            (std::vector<std::array<int, 2>>{{0, 1}, {0, 2}, {0, 3}, {1, 3}, {1, 4}, {2, 3}}));
}

TEST(topology, directs_the_boundary_like_its_triangles) {
  EXPECT_EQ(boundary_edges(two_triangles().triangles),
            (std::vector<std::array<int, 2>>{{0, 1}, {2, 0}, {1, 3}, {3, 2}}));
}

TEST(topology, gives_a_hinge_its_two_opposite_vertices) {
  // triangle (0, 1, 3) runs 3 -> 0 with 1 opposite; (0, 3, 2) has 2 opposite
  EXPECT_EQ(edge_hinges(two_triangles().triangles), (std::vector<std::array<int, 4>>{{3, 0, 1, 2}}));
}

TEST(topology, names_an_edge_of_three_triangles_or_more) {
  const std::vector<std::array<int, 3>> fan = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const std::vector<std::array<int, 3>> wider = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {5, 0, 1}};

  const auto three = crowded_edge(fan), four = crowded_edge(wider);

  ASSERT_TRUE(three && four);
  EXPECT_EQ(three->edge, (std::array{0, 1}));
  EXPECT_EQ(three->n_triangles, 3);
  EXPECT_EQ(four->n_triangles, 4);
  EXPECT_EQ(boundary_edges(fan).size(), 6u);
}

TEST(topology, finds_no_crowded_edge_in_a_manifold) {
  EXPECT_FALSE(crowded_edge(two_triangles().triangles));
  EXPECT_FALSE(crowded_edge(icosphere_mesh(2, 1.0).triangles));
  EXPECT_FALSE(crowded_edge({}));
}

TEST(topology, counts_the_hinges_of_a_grid) {
  const TriangleMesh mesh = grid_mesh(5, 4, 1, 1);

  const std::size_t interior = unique_edges(mesh).size() - boundary_edges(mesh.triangles).size();

  EXPECT_EQ(edge_hinges(mesh.triangles).size(), interior);
  EXPECT_EQ(interior, 12u + 4u * 2u + 3u * 3u);  // diagonals, inner rows, inner columns
}

TEST(topology, joins_vertices_two_apart_along_the_lines_of_a_grid) {
  const GridLines lines = skip_one_pairs(grid_mesh(4, 3, 1.5, 1.0));
  EXPECT_EQ(lines.fault, "");
  EXPECT_EQ(lines.pairs,
            (std::vector<std::array<int, 2>>{
                {0, 2}, {0, 8}, {1, 3}, {1, 9}, {2, 10}, {3, 11}, {4, 6}, {5, 7}, {8, 10}, {9, 11}}));
  EXPECT_EQ(skip_one_pairs(grid_mesh(15, 15, 1.4, 1.4)).pairs.size(), 2u * 13u * 15u);
  EXPECT_EQ(skip_one_pairs(grid_mesh(2, 2, 1, 1)).pairs.size(), 0u);
}

TEST(topology, names_what_no_line_of_a_grid_goes_through) {
  EXPECT_EQ(skip_one_pairs(icosphere_mesh(0, 1)).fault, "triangle 0, which is no half of a quad");
  TriangleMesh corner = grid_mesh(3, 3, 1, 1);  // of its four quads three are left
  corner.triangles.resize(6);
  corner.fans.pop_back();
  EXPECT_EQ(skip_one_pairs(corner).fault, "vertex 4, at which no line of a grid goes on: it is in 3 quads");
  TriangleMesh tie = grid_mesh(2, 2, 1, 1);  // two quads that have one vertex in common
  tie.vertices.conservativeResize(3, 7);
  tie.fans.push_back({2, 2});
  tie.triangles.push_back({3, 4, 6});
  tie.triangles.push_back({3, 6, 5});
  EXPECT_EQ(skip_one_pairs(tie).fault, "vertex 3, at which no line of a grid goes on: it is in 2 quads");
}

}  // namespace
}  // namespace bb
