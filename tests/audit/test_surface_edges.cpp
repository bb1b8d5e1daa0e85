// The edges of a surface, against a map of all of them.
#include "core/audit/surface_edges.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace bb::audit::surface_edges_test {
namespace {

struct Sharers {
  int triangles = 0, third = -1;
  bool segment = false;
};

TEST(SurfaceEdges, AreThoseOfAMapEntryByEntry) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> vertex(0, 19), size(0, 40);
  int edges = 0, shared = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<TriangleVertices> triangles;
    std::vector<EdgeVertices> segments;
    for (int i = size(random); i > 0; --i)
      triangles.push_back({vertex(random), vertex(random), vertex(random)});
    for (int i = size(random); i > 0; --i) segments.push_back({vertex(random), vertex(random)});
    std::map<EdgeVertices, Sharers> expected;
    for (const TriangleVertices& t : triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        Sharers& edge = expected[ascending(t[k], t[(k + 1) % 3])];
        ++edge.triangles, edge.third = t[(k + 2) % 3];
      }
    }
    for (const EdgeVertices& e : segments) expected[ascending(e[0], e[1])].segment = true;
    for (const bool planar : {false, true}) {
      AuditMesh mesh;
      mesh.planar = planar;
      set_edges(triangles, segments, mesh);
      Eigen::Index i = 0;
      for (const auto& [edge, of] : expected) {
        shared += of.triangles > 1;
        if (planar && of.triangles > 1 && !of.segment) continue;
        ASSERT_LT(i, mesh.edges.cols());
        EXPECT_EQ(mesh.edges(0, i), edge[0]);
        EXPECT_EQ(mesh.edges(1, i), edge[1]);
        if (planar) {
          EXPECT_EQ(mesh.opposite.at(static_cast<std::size_t>(i)), of.third);
        }
        ++i;
      }
      EXPECT_EQ(i, mesh.edges.cols());
      EXPECT_EQ(mesh.opposite.size(), planar ? static_cast<std::size_t>(i) : 0u);
      edges += static_cast<int>(i);
    }
  }
  EXPECT_GT(edges, 1000);
  EXPECT_GT(shared, 100);
}

}  // namespace
}  // namespace bb::audit::surface_edges_test
