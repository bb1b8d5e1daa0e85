// Blocks of nodes: stretches of a Morton curve, and parts of a graph.
#include "core/linear/node_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/math/at.hpp"

namespace bb::node_blocks_test {
namespace {

void expect_partition(const VertexClusters& blocks, int n, int most) {
  std::vector<int> members = blocks.member, all(at(n));
  std::sort(members.begin(), members.end());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(members, all);
  for (int k = 0; k < blocks.size(); ++k) {
    EXPECT_GT(blocks.start[at(k) + 1], blocks.start[at(k)]);
    EXPECT_LE(blocks.start[at(k) + 1] - blocks.start[at(k)], most);
    for (int m = blocks.start[at(k)]; m < blocks.start[at(k) + 1]; ++m) {
      EXPECT_EQ(blocks.of[at(blocks.member[at(m)])], k);
    }
  }
}

TEST(NodeBlocks, ConsecutiveOnesEndWithTheRest) {
  const VertexClusters blocks = consecutive_blocks(70, 32);
  expect_partition(blocks, 70, 32);
  EXPECT_EQ(blocks.start, (std::vector<int>{0, 32, 64, 70}));
  EXPECT_EQ(consecutive_blocks(0, 32).size(), 0);
}

/// On a square grid of 2^k points a side, aligned with the cells, the curve runs through quadrant after quadrant: x
/// before y, lower halves first. Points are given row by row.
TEST(NodeBlocks, MortonCurveIsThatOfInterleavedBits) {
  std::vector<Vec3d> points;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) points.emplace_back(0.25 * x + 7, 0.25 * y - 3, 0);
  }
  points.emplace_back(8, -2, 0);  // the cube has a side of 1
  const VertexClusters blocks = morton_blocks(points, 4);
  expect_partition(blocks, 17, 4);
  // along y first: of two bits at one height that of x stands before that of y
  EXPECT_EQ(blocks.member, (std::vector<int>{0, 4, 1, 5, 8, 12, 9, 13, 2, 6, 3, 7, 10, 14, 11, 15, 16}));
}

/// The noise of a flat sheet is no axis: the order is that of the sheet without it.
TEST(NodeBlocks, MortonCurveHasOneScale) {
  std::vector<Vec3d> flat, noisy;
  for (int i = 0; i < 400; ++i) {
    flat.emplace_back(0.05 * (i % 20), 0.05 * (i / 20), 0);
    noisy.emplace_back(flat.back() + Vec3d(0, 0, 1e-5 * ((i * 37) % 11)));
  }
  EXPECT_EQ(morton_blocks(flat, 16).member, morton_blocks(noisy, 16).member);
  const std::vector<Vec3d> one(5, Vec3d(1, 2, 3)), bad(3, Vec3d(NAN, 0, 0));
  EXPECT_EQ(morton_blocks(one, 2).member, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(morton_blocks(bad, 2).member, (std::vector<int>{0, 1, 2}));
}

struct Graph {
  std::vector<int> row_start, neighbour;
};

/// `copies` square grids of m x m nodes that nothing joins.
Graph grids(int m, int copies) {
  Graph graph;
  graph.row_start.push_back(0);
  for (int c = 0; c < copies; ++c) {
    for (int v = 0; v < m * m; ++v) {
      const auto joins = [&](bool there, int u) {
        if (there) graph.neighbour.push_back(c * m * m + u);
      };
      joins(v >= m, v - m);
      joins(v % m > 0, v - 1);
      joins(v % m + 1 < m, v + 1);
      joins(v + m < m * m, v + m);
      graph.row_start.push_back(static_cast<int>(graph.neighbour.size()));
    }
  }
  return graph;
}

int edges_cut(const Graph& graph, const VertexClusters& blocks) {
  int cut = 0;
  for (int v = 0; v + 1 < static_cast<int>(graph.row_start.size()); ++v) {
    for (int k = graph.row_start[at(v)]; k < graph.row_start[at(v) + 1]; ++k) {
      cut += blocks.of[at(v)] != blocks.of[at(graph.neighbour[at(k)])] ? 1 : 0;
    }
  }
  return cut / 2;
}

TEST(NodeBlocks, PartsCutFewerEdgesThanRowsOfAGrid) {
  const Graph graph = grids(32, 1);
  const VertexClusters parts = partitioned_blocks(graph.row_start, graph.neighbour, 16);
  expect_partition(parts, 1024, 16);
  EXPECT_GE(parts.size(), 64);
  EXPECT_LT(parts.size(), 90);
  EXPECT_LT(edges_cut(graph, parts), edges_cut(graph, consecutive_blocks(1024, 16)) * 3 / 5);
}

TEST(NodeBlocks, PartsKeepToOneComponentAndAreTheSameEachTime) {
  const Graph graph = grids(5, 7);
  const VertexClusters parts = partitioned_blocks(graph.row_start, graph.neighbour, 16);
  expect_partition(parts, 175, 16);
  for (int v = 0; v < 175; ++v) {
    const int first = parts.member[at(parts.start[at(parts.of[at(v)])])];
    EXPECT_EQ(first / 25, v / 25);
  }
  EXPECT_EQ(partitioned_blocks(graph.row_start, graph.neighbour, 16).member, parts.member);
  EXPECT_EQ(partitioned_blocks(std::vector<int>{0}, {}, 16).size(), 0);
  EXPECT_EQ(partitioned_blocks(std::vector<int>{0, 0, 0}, {}, 16).size(), 2);  // two nodes that nothing joins
}

}  // namespace
}  // namespace bb::node_blocks_test
