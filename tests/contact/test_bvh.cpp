// Overlapping pairs of trees against the plain double loop.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <random>

#include "core/contact/aabb.hpp"
#include "core/contact/bvh.hpp"

namespace bb::bvh_test {
namespace {

std::vector<TreeBox> random_boxes(int n, double size, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3d(unit(rng), unit(rng), unit(rng)); };
  std::vector<TreeBox> boxes(static_cast<std::size_t>(n));
  for (TreeBox& b : boxes) {
    const Vec3d centre = point();
    b.add(Vec3d(centre + size * point()));
    b.add(Vec3d(centre + size * point()));
    b.inflate(0.01);
  }
  return boxes;
}

std::vector<std::uint8_t> random_flags(int n, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::vector<std::uint8_t> flags(static_cast<std::size_t>(n));
  for (auto& f : flags) f = rng() % 3 == 0 ? 1 : 0;
  return flags;
}

bool keep(IndexPair p) { return (p.first + p.second) % 7 != 0; }

std::vector<IndexPair> brute_force(const std::vector<TreeBox>& a, const std::vector<std::uint8_t>& free_a,
                                   const std::vector<TreeBox>& b, const std::vector<std::uint8_t>& free_b,
                                   bool self) {
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = self ? i + 1 : 0; j < b.size(); ++j) {
      const IndexPair p{static_cast<int>(i), static_cast<int>(j)};
      if ((free_a[i] || free_b[j]) && a[i].overlaps(b[j]) && keep(p)) pairs.push_back(p);
    }
  }
  return pairs;
}

class BvhSizes : public testing::TestWithParam<int> {};

TEST_P(BvhSizes, FindsWhatTheDoubleLoopFinds) {
  const int n = GetParam(), m = n / 2 + 1;
  const auto a = random_boxes(n, 0.1, 1), b = random_boxes(m, 0.2, 2);
  const auto fa = random_flags(n, 3), fb = random_flags(m, 4);
  Bvh ta, tb;
  ta.update(a, fa);
  tb.update(b, fb);

  PairFinder finder;
  std::vector<IndexPair> cross, self;
  finder.find(ta, tb, keep, cross);
  finder.find(ta, ta, keep, self);

  EXPECT_EQ(cross, brute_force(a, fa, b, fb, false));
  EXPECT_EQ(self, brute_force(a, fa, a, fa, true));
  if (n >= 1000) {
    EXPECT_GT(cross.size(), 100U);
    EXPECT_GT(self.size(), 100U);
  }
}
INSTANTIATE_TEST_SUITE_P(, BvhSizes,
                         testing::Values(0, 1, 2, 4, 5, 8, 9, 31, 33, 63, 64, 65, 257, 511, 512, 513, 2000));

/// However many there are of one first member: short and long lists are sorted in two ways.
TEST(Bvh, PairsOfOneAreSortedWhateverTheirNumber) {
  std::vector<TreeBox> one(1);
  one[0].add(Vec3d(-9, -9, -9)), one[0].add(Vec3d(9, 9, 9));
  const std::vector<std::uint8_t> free_one(1, 1);
  Bvh of_one;
  of_one.update(one, free_one);
  PairFinder finder;
  for (const int n : {1, 9, 60, 75, 76, 200, 700, 5000}) {
    const auto boxes = random_boxes(n, 0.1, 5);
    const auto free = random_flags(n, 6);
    Bvh tree;
    tree.update(boxes, free);
    std::vector<IndexPair> pairs;
    finder.find(of_one, tree, keep, pairs);
    EXPECT_EQ(pairs, brute_force(one, free_one, boxes, free, false)) << n;
    EXPECT_GE(pairs.size(), static_cast<std::size_t>(6 * n / 7));
  }
}

TEST(Bvh, SamePairsForAnyNumberOfThreads) {
  const auto boxes = random_boxes(3000, 0.1, 5);
  const std::vector<std::uint8_t> free(boxes.size(), 1);
  Bvh tree;
  tree.update(boxes, free);
  std::vector<IndexPair> reference;
  for (std::size_t threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    PairFinder finder;
    std::vector<IndexPair> pairs;
    finder.find(tree, tree, keep, pairs);
    if (threads == 1) reference = pairs;
    EXPECT_EQ(pairs, reference);
  }
  EXPECT_GT(reference.size(), 1000U);
}

TEST(Bvh, RefitsAfterSmallMotionAndRebuildsAfterLarge) {
  auto boxes = random_boxes(2000, 0.02, 6);
  const std::vector<std::uint8_t> free(boxes.size(), 1);
  Bvh tree;
  tree.update(boxes, free);
  ASSERT_EQ(tree.builds(), 1);

  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto move = [&](double size) {
    for (TreeBox& b : boxes) {
      for (int c = 0; c < 3; ++c) {
        const float shift = static_cast<float>(size * unit(rng));
        b.lo[c] += shift;
        b.hi[c] += shift;
      }
    }
  };
  const auto check = [&] {
    PairFinder finder;
    std::vector<IndexPair> pairs;
    finder.find(tree, tree, keep, pairs);
    EXPECT_EQ(pairs, brute_force(boxes, free, boxes, free, true));
    EXPECT_GT(pairs.size(), 10U);
  };
  move(0.01);
  tree.update(boxes, free);
  EXPECT_EQ(tree.builds(), 1);
  check();
  move(1.0);
  tree.update(boxes, free);
  EXPECT_EQ(tree.builds(), 2);
  check();
}

TEST(Bvh, ForgetsItsPrimitivesWhenThereAreNoneLeft) {
  const auto boxes = random_boxes(20, 0.5, 8);
  const std::vector<std::uint8_t> free(boxes.size(), 1);
  Bvh full, emptied;
  full.update(boxes, free);
  emptied.update(boxes, free);
  emptied.update({}, {});
  PairFinder finder;
  std::vector<IndexPair> pairs{{1, 2}};
  finder.find(full, emptied, keep, pairs);
  EXPECT_TRUE(pairs.empty());
  finder.find(emptied, full, keep, pairs);
  EXPECT_TRUE(pairs.empty());
}

TEST(BoxBlock, OverlapsWhatTheBoxesDoAndNothingInUnsetLanes) {
  const auto boxes = random_boxes(300, 1.0, 9);
  TreeBox everything;
  std::swap(everything.lo, everything.hi);  // an empty box is inside out
  BoxBlock asking;
  asking.set(5, everything);
  int hits = 0;
  for (std::size_t first = 0; first + 6 < boxes.size(); first += 6) {
    BoxBlock block;
    for (std::size_t k = 0; k < 6; ++k) block.set(k, boxes[first + k]);
    asking.set(2, boxes[first + 6]);
    LaneSet expected = 0;
    TreeBox hull;
    double half_area = 0;
    for (std::size_t k = 0; k < 6; ++k) {
      const TreeBox& box = boxes[first + k];
      expected |= static_cast<LaneSet>(box.overlaps(boxes[first + 6])) << k;
      hull.add(box);
      const TreeBox::Four e = box.hi - box.lo;
      half_area += static_cast<double>(e[0] * e[1] + e[1] * e[2] + e[2] * e[0]);
    }
    EXPECT_EQ(block.overlaps(asking.asking(2)), expected);
    EXPECT_EQ(block.overlaps(asking.asking(5)), 0x3fU);
    const TreeBox found = block.hull();
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(found.lo[c], hull.lo[c]);
      EXPECT_EQ(found.hi[c], hull.hi[c]);
    }
    EXPECT_NEAR(block.half_area(), half_area, 1e-6 * half_area);
    hits += expected != 0 ? 1 : 0;
  }
  EXPECT_GT(hits, 10);
}

TEST(LaneSet, PacksTheNumbersOfEverySet) {
  const EightInts numbers = {10, -11, 12, 13, 14, 15, 16, 1 << 30};
  for (LaneSet lanes = 0; lanes < 256; ++lanes) {
    std::vector<int> expected;
    EightInts comparison{};
    for (int k = 0; k < 8; ++k) {
      if ((lanes >> k & 1) == 0) continue;
      expected.push_back(numbers[k]);
      comparison[k] = -1;
    }
    EXPECT_EQ(lanes_of(comparison), lanes);
    std::vector<int> found(8);
    found.resize(pack(numbers, lanes, found.data()));
    EXPECT_EQ(found, expected);
  }
}

/// A box holds every point and margin that it was made from, to the last bit, and little more.
TEST(TreeBox, RoundsOutward) {
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    const double size = std::pow(10.0, 6 * unit(rng)), margin = std::pow(10.0, 8 * unit(rng) - 4);
    const Vec3d p = size * Vec3d(unit(rng), unit(rng), i % 5 == 0 ? 0 : unit(rng));
    TreeBox box;
    box.add(p);
    const TreeBox tight = box;
    box.inflate(margin);
    for (int c = 0; c < 3; ++c) {
      ASSERT_LE(static_cast<double>(tight.lo[c]), p[c]);
      ASSERT_GE(static_cast<double>(tight.hi[c]), p[c]);
      using Exact = long double;
      const Exact ulps = 8e-7L * (std::abs(static_cast<Exact>(p[c])) + margin) + 1e-36L;
      ASSERT_LE(static_cast<Exact>(box.lo[c]), static_cast<Exact>(p[c]) - margin);
      ASSERT_GE(static_cast<Exact>(box.hi[c]), static_cast<Exact>(p[c]) + margin);
      ASSERT_GE(static_cast<Exact>(box.lo[c]), static_cast<Exact>(p[c]) - margin - ulps);
      ASSERT_LE(static_cast<Exact>(box.hi[c]), static_cast<Exact>(p[c]) + margin + ulps);
    }
  }
}

/// What no float holds reaches to infinity on its side; two of them overlap, as far as floats decide.
TEST(TreeBox, BeyondFloatIsStillABox) {
  TreeBox far, farther, near;
  far.add(Vec3d(1e300, 0, 0));
  farther.add(Vec3d(1e301, 0, 0));
  near.add(Vec3d(1e30, 0, 0));
  for (TreeBox* box : {&far, &farther, &near}) box->inflate(0.1);
  EXPECT_TRUE(far.overlaps(farther));
  EXPECT_FALSE(far.overlaps(near));
}

TEST(Aabb, DistanceOfBoxesIsAcrossTheGapAlone) {
  Aabb a, b;
  a.add(Vec3d(0, 0, 0));
  a.add(Vec3d(1, 1, 1));
  b.add(Vec3d(4, 5, 0.5));
  EXPECT_EQ(box_distance(a, b), 5);
}

}  // namespace
}  // namespace bb::bvh_test
