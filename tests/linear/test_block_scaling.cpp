// What an iteration of conjugate gradients does beside the product, against its plain form bit for bit: D^-1 b of block-Jacobi,
// and dot products.
#include "core/linear/block_scaling.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/linear/parallel.hpp"
#include "tests/linear/systems.hpp"

namespace bb::block_scaling_test {
namespace {

/// With vertices of three, two and one degree of freedom, whose last block may be smaller.
ReducedSystem with_blocks(ReducedSystem system, const std::vector<int>& sizes) {
  const int n = static_cast<int>(system.lower.rows());
  system.block_start = {0};
  for (std::size_t b = 0; system.block_start.back() < n; ++b) {
    system.block_start.push_back(std::min(n, system.block_start.back() + sizes[b % sizes.size()]));
  }
  return system;
}

void expect_solution(const ReducedSystem& system, Scaling kind) {
  BlockScaling scaling;
  ASSERT_EQ(scaling.setup(system, kind), LinearStatus::ok);
  const VecXd b = random_vector(system.lower.rows(), 5);
  VecXd expected = b, found;
  scaling.solve_lower(expected);
  scaling.solve_upper(expected);
  scaling.solve(b, found);
  EXPECT_EQ(found, expected);
  EXPECT_GT(found.norm(), 0);
}

TEST(BlockScaling, FourBlocksAbreastHaveTheBitsOfOneByOne) {
  for (const int side : {1, 2, 3, 9, 33}) {
    const ReducedSystem whole = grid_system(side, 0.1);
    for (const Scaling kind : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
      SCOPED_TRACE(std::to_string(side) + " " + std::to_string(static_cast<int>(kind)));
      expect_solution(whole, kind);
      expect_solution(with_blocks(whole, {3, 1, 2}), kind);
      expect_solution(with_blocks(whole, {3, 3, 3, 3, 3, 2}), kind);
      expect_solution(with_blocks(whole, {1}), kind);
    }
  }
}

TEST(ChunkedDot, AddsNumberByNumberInChunksWhateverTheThreads) {
  for (const Eigen::Index n : {0, 1, 2, 8191, 8192, 8193, 16384, 16385, 40000}) {
    const VecXd a = random_vector(n, 1), b = random_vector(n, 2);
    double expected = 0;
    for (Eigen::Index begin = 0; begin < n; begin += 8192) {
      double chunk = a[begin] * b[begin];
      for (Eigen::Index i = begin + 1; i < std::min<Eigen::Index>(n, begin + 8192); ++i) chunk += a[i] * b[i];
      expected += chunk;
    }
    for (const std::size_t threads : {1u, 3u}) {
      tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      ChunkedDot dot;
      EXPECT_EQ(dot(a, b), expected) << n;
    }
    EXPECT_EQ(expected == 0, n == 0);
  }
}

TEST(Updates, HaveTheBitsOfNumberByNumber) {
  for (const Eigen::Index n : {0, 1, 3, 4, 5, 1003}) {
    const VecXd x = random_vector(n, 1), start = random_vector(n, 2);
    VecXd y = start, p = start;
    add_scaled(-0.37, x, y);
    scale_and_add(1.91, x, p);
    for (Eigen::Index i = 0; i < n; ++i) {
      EXPECT_EQ(y[i], start[i] - 0.37 * x[i]);
      EXPECT_EQ(p[i], x[i] + 1.91 * start[i]);
    }
  }
}

}  // namespace
}  // namespace bb::block_scaling_test
