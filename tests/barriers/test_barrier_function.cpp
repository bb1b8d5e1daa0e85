// The batch calls: the same numbers row by row, over chunk borders, in float, and on the squared gap.
#include <gtest/gtest.h>

#include <random>

#include "tests/barriers/barrier_cases.hpp"

namespace bb::test::barrier_function_test {
namespace {

template <class T>
void expect_batch_equals_rows(const BarrierFunction& fn, std::size_t n) {
  std::mt19937 random(7);
  std::uniform_real_distribution<T> uniform(T(0.01), T(1.3));
  std::vector<T> d(n), d_hat(n), b(n, T(-1)), db(n, T(-1)), d2b(n, T(-1));
  for (std::size_t i = 0; i < n; ++i) {
    d_hat[i] = T(1e-3) * uniform(random);
    d[i] = d_hat[i] * uniform(random);
  }
  fn.eval(n, d.data(), d_hat.data(), b.data(), db.data(), d2b.data());
  std::size_t active = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const ShapeTerms<T> one = fn.eval(d[i], d_hat[i]);
    EXPECT_EQ(b[i], one.b) << label(fn) << " row " << i;
    EXPECT_EQ(db[i], one.db) << label(fn) << " row " << i;
    EXPECT_EQ(d2b[i], one.d2b) << label(fn) << " row " << i;
    active += one.b > 0;
  }
  EXPECT_GE(active, n / 2);
}

TEST(BarrierFunction, BatchEqualsRowsOverChunkBorders) {
  for (const BarrierFunction& fn : all_barriers()) {
    for (const std::size_t n : {0u, 1u, 31u, 127u, 128u, 129u, 1000u}) {
      expect_batch_equals_rows<double>(fn, n);
      expect_batch_equals_rows<float>(fn, n);
    }
  }
}

TEST(BarrierFunction, FloatIsTheDoubleFormulaInFloat) {
  for (const BarrierFunction& fn : all_barriers()) {
    for (const double u : spaced_u(1e-4, 1e-2)) {
      const float d = static_cast<float>(u * 1e-3), d_hat = 1e-3F;
      const ShapeTerms<float> single = fn.eval(d, d_hat);
      const ShapeTerms<double> exact = fn.eval(static_cast<double>(d), static_cast<double>(d_hat));
      EXPECT_LT(relative(single.b, exact.b), 1e-4) << label(fn) << " u = " << u;
      EXPECT_LT(relative(single.db, exact.db), 1e-4) << label(fn) << " u = " << u;
      EXPECT_NE(static_cast<double>(single.b), 0.0);
    }
  }
}

/// b(d) = f(d^2; d_hat^2)/d_hat^2 with f the shape's own formula, for every shape.
TEST(BarrierFunction, SquaredGapIsTheShapeOfTheSquare) {
  const double d_hat = 0.05;
  for (const Shape& shape : all_shapes()) {
    const BarrierFunction plain{shape, Argument::gap}, squared{shape, Argument::squared_gap};
    for (const double u : {0.01, 0.3, 0.7, 0.99}) {
      const double d = u * d_hat;
      const double f = plain.eval(d * d, d_hat * d_hat).b;
      ASSERT_GT(f, 0);
      EXPECT_DOUBLE_EQ(squared.eval(d, d_hat).b, f / (d_hat * d_hat)) << shape.name << " u = " << u;
    }
  }
}

TEST(BarrierFunction, ArgumentsHaveNames) {
  EXPECT_EQ(to_string(Argument::gap), "gap");
  EXPECT_EQ(to_string(Argument::squared_gap), "squared_gap");
}

}  // namespace
}  // namespace bb::test::barrier_function_test
