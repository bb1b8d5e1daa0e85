// Products with the block rows of a symmetric matrix against a dense product, for vertices with one, two and
// three degrees of freedom.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numeric>

#include "core/linear/block_system.hpp"
#include "core/linear/symmetric_product.hpp"
#include "core/math/error.hpp"
#include "tests/linear/systems.hpp"

namespace bb::symmetric_product_test {
namespace {

/// The same matrix with its degrees of freedom cut into blocks of 3, 1, 2, 3, 1, 2, ...
ReducedSystem with_mixed_blocks(ReducedSystem system) {
  const int n = static_cast<int>(system.lower.rows()), sizes[] = {3, 1, 2};
  system.block_start = {0};
  for (int b = 0; system.block_start.back() < n; ++b) {
    system.block_start.push_back(std::min(n, system.block_start.back() + sizes[b % 3]));
  }
  return system;
}

void expect_products(const ReducedSystem& system) {
  const Eigen::MatrixXd a = dense(system);
  const VecXd x = random_vector(a.rows(), 3);
  SymmetricProduct product;
  product.update(system);
  VecXd y;
  product.multiply(x, y);
  std::vector<long double> exact;
  product.multiply_long(x, exact);
  const VecXd truth = a * x, scale = a.cwiseAbs() * x.cwiseAbs();
  ASSERT_EQ(y.size(), a.rows());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    EXPECT_NEAR(y[i], truth[i], 1e-14 * scale[i]);
    EXPECT_NEAR(static_cast<double>(exact[static_cast<std::size_t>(i)]), truth[i], 1e-14 * scale[i]);
  }
  EXPECT_GT(truth.norm(), 0);
  EXPECT_NEAR(product.absolute_quadratic(x), x.cwiseAbs().dot(scale), 1e-13 * x.cwiseAbs().dot(scale));
}

TEST(SymmetricProduct, MeetsTheDenseProduct) {
  expect_products(grid_system(9, 0.1));
  expect_products(with_mixed_blocks(grid_system(9, 0.1)));
  expect_products(from_dense(with_spectrum(spectrum("geometric", 35, 1e3), 2)));  // the last block is smaller
  expect_products(from_dense(Eigen::MatrixXd::Constant(1, 1, 2.5)));
}

/// A block of which only some entries are stored.
TEST(SymmetricProduct, TakesBlocksWithHoles) {
  Eigen::MatrixXd a = 5 * Eigen::MatrixXd::Identity(12, 12);
  a(7, 1) = a(1, 7) = 2;
  a(6, 2) = a(2, 6) = -3;
  a(11, 10) = a(10, 11) = 1;
  a(4, 0) = a(0, 4) = 0.5;
  const ReducedSystem system = from_dense(a);
  ASSERT_EQ(system.lower.nonZeros(), 16);
  expect_products(system);
  expect_products(with_mixed_blocks(system));
}

/// A planar scene has two degrees of freedom a vertex, pinned vertices none.
TEST(SymmetricProduct, MeetsTheProductOfTheBlockSystem) {
  const int n = 5;
  std::vector<std::uint8_t> fixed(3 * n, 0);
  fixed[2] = fixed[5] = fixed[9] = fixed[10] = fixed[11] = 1;  // vertices 0 and 1 in a plane, vertex 3 pinned
  BlockSystem blocks(n, fixed);
  const std::vector<int> pairs = {0, 1, 1, 2, 2, 3, 3, 4, 0, 4};
  blocks.set_elements({{2, pairs}});
  std::vector<double> hess(pairs.size() / 2 * 27);
  std::iota(hess.begin(), hess.end(), 1.0);
  blocks.clear();
  blocks.add_elements(0, hess);
  const ReducedSystem& system = blocks.reduce(blocks.values());
  EXPECT_EQ(system.block_start, (std::vector<int>{0, 2, 4, 7, 10}));
  EXPECT_EQ(system.block_vertex, (std::vector<int>{0, 1, 2, 4}));
  expect_products(system);
}

TEST(SymmetricProduct, KeepsItsRowsWhileThePatternStays) {
  ReducedSystem system = grid_system(6, 0.1, 7);
  SymmetricProduct product;
  product.update(system);
  const VecXd x = random_vector(system.lower.rows(), 1);
  VecXd before, after;
  product.multiply(x, before);
  system.lower.coeffs() *= 4;
  product.update(system);
  product.multiply(x, after);
  EXPECT_EQ(after, 4 * before);
  EXPECT_GT(before.norm(), 0);
  const ReducedSystem other = grid_system(5, 0.1, 8);
  product.update(other);
  EXPECT_EQ(product.n(), other.lower.rows());
  EXPECT_EQ(product.n_blocks(), 25);
}

TEST(SymmetricProduct, ThreadsDoNotChangeABit) {
  const ReducedSystem system = grid_system(60, 0.1, 1);
  const VecXd x = random_vector(system.lower.rows(), 2);
  std::vector<VecXd> y;
  for (const std::size_t threads : {1u, 2u, 4u}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    SymmetricProduct product;
    product.update(system);
    product.multiply(x, y.emplace_back());
  }
  EXPECT_EQ(y[0], y[1]);
  EXPECT_EQ(y[0], y[2]);
}

TEST(SymmetricProduct, RefusesWhatIsNoLowerTriangle) {
  SymmetricProduct product;
  ReducedSystem system = grid_system(3, 0.1, 1);
  system.block_start.pop_back();
  EXPECT_THROW(product.update(system), ConfigError);
  system = grid_system(3, 0.1, 1);
  system.lower = system.lower.transpose().eval();
  EXPECT_THROW(product.update(system), ConfigError);
  EXPECT_THROW(product.update(system), ConfigError);  // nor is it taken for known
}

}  // namespace
}  // namespace bb::symmetric_product_test
