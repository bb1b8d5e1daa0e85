// The broad phase finds exactly the boxes that meet: against all pairs, with touching, flat and equal boxes.
#include "core/audit/box_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace bb::audit::box_tree_test {
namespace {

std::vector<Box> grid_boxes(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> coordinate(0, 12), extent(0, 2);
  std::vector<Box> boxes(static_cast<std::size_t>(n));
  for (Box& b : boxes) {
    const Vec3d lo(coordinate(random), coordinate(random), coordinate(random));
    b.add(lo);
    b.add(lo + Vec3d(extent(random), extent(random), extent(random)));
  }
  return boxes;
}

TEST(BoxTree, finds_each_meeting_box_once) {
  for (int n : {0, 1, 4, 5, 33, 400}) {
    const std::vector<Box> boxes = grid_boxes(n, 5), queries = grid_boxes(60, 6);
    const BoxTree tree(boxes);
    std::size_t total = 0;
    for (const Box& q : queries) {
      std::vector<int> found, expected;
      tree.query(q, [&](int i) { found.push_back(i); });
      for (int i = 0; i < n; ++i) {
        if (q.meets(boxes[static_cast<std::size_t>(i)])) expected.push_back(i);
      }
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, expected) << n;
      total += found.size();
    }
    if (n == 400) {
      EXPECT_GT(total, 100u);
    }
  }
}

TEST(BoxTree, equal_boxes_and_boxes_that_share_a_face) {
  Box unit, next;
  unit.add(Vec3d(0, 0, 0)), unit.add(Vec3d(1, 1, 1));
  next.add(Vec3d(1, 1, 1)), next.add(Vec3d(2, 2, 2));
  const BoxTree tree(std::vector<Box>(9, unit));
  int found = 0;
  tree.query(next, [&](int) { ++found; });
  EXPECT_EQ(found, 9);
  next.lo = Vec3d::Constant(1.0 + 0x1p-52);
  tree.query(next, [&](int) { ++found; });
  EXPECT_EQ(found, 9);
}

}  // namespace
}  // namespace bb::audit::box_tree_test
