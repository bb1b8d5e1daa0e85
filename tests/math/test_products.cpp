// Products by fused multiply-add against long double.
#include "core/math/products.hpp"

#include <gtest/gtest.h>

#include <random>

namespace {

using namespace bb;

TEST(DifferenceOfProducts, KeepsDigitsWhenProductsCancel) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> uniform(0.5F, 1);
  int cancelling = 0;
  for (int k = 0; k < 1000; ++k) {
    const float a = uniform(rng), b = uniform(rng), c = a * (1 + 1e-6F * uniform(rng)), d = b;
    const double exact = static_cast<double>(a) * b - static_cast<double>(c) * d;  // exact in double
    const float plain = a * b - c * d;
    cancelling += std::abs(plain - exact) > 1e-2 * std::abs(exact);
    EXPECT_NEAR(difference_of_products(a, b, c, d), exact, 2e-7 * std::abs(exact));
  }
  EXPECT_GT(cancelling, 100);
}

TEST(AccurateCross, NearlyParallelVectors) {
  const Vec3d a(1, 0.7, -0.3), b = a * 3 + Vec3d(1e-12, -2e-12, 5e-13);
  using Long = long double;
  const Vec<Long, 3> la = a.cast<Long>(), lb = b.cast<Long>();
  const Vec<Long, 3> exact(la[1] * lb[2] - la[2] * lb[1], la[2] * lb[0] - la[0] * lb[2],
                           la[0] * lb[1] - la[1] * lb[0]);
  const Vec3d cross = accurate_cross(a, b);
  ASSERT_GT(exact.norm(), 1e-12L);
  EXPECT_LE((cross.cast<Long>() - exact).norm(), 1e-6L * exact.norm());  // long double itself cancels
  EXPECT_EQ(accurate_cross(a, Vec3d(2 * a)), Vec3d(0, 0, 0));
  EXPECT_EQ(accurate_cross(Vec3d(1, 0, 0), Vec3d(0, 1, 0)), Vec3d(0, 0, 1));
}

}  // namespace
