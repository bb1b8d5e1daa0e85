// What a range of loads costs in stiffness (docs/theory/load-ranges.md): the least that it can cost, the shapes that cost
// that, what the others cost, and random forces that keep the conditions of the theorem.
#include <gtest/gtest.h>

#include <random>

#include "tests/barriers/barrier_cases.hpp"

namespace bb::test::load_range_test {
namespace {

double force(const BarrierFunction& fn, double u) { return -fn.eval(u, 1.0).db; }

struct Price {
  double slope = 0;      // largest L f'/max(f, f_lo)
  double curvature = 0;  // largest L^2 f''/max(f, f_lo)
};

/// Of loads of the ratio r of a barrier between the gaps `low` and 1, in units of d_hat. At `low` it carries `over` times
/// the largest load; what carries more than that is not counted.
Price price(const BarrierFunction& fn, double low, double r, double over = 1, int n = 20000) {
  const double f_hi = force(fn, low) / over, f_lo = f_hi / r, range = 1 - low;
  Price out;
  for (int i = 0; i < n; ++i) {
    const double u = low + range * i / n, next = low + range * (i + 1) / n;
    const ShapeTerms<double> at = fn.eval(u, 1.0);
    if (-at.db > f_hi * (1 + 1e-12)) continue;
    const double load = std::max(-at.db, f_lo), bend = (at.d2b - fn.eval(next, 1.0).d2b) * n / range;
    out.slope = std::max(out.slope, range * at.d2b / load);
    out.curvature = std::max(out.curvature, range * range * bend / load);
  }
  return out;
}

/// At the kappa at which it is least.
double least_price(const BarrierFunction& fn, double low, double r) {
  double least = INFINITY;
  for (double over = 1; over < 12; over *= 1.06) least = std::min(least, price(fn, low, r, over, 2000).slope);
  return least;
}

BarrierFunction with_exponent(const char* shape, double a) {
  return barrier((std::string(shape) + ":" + std::to_string(a)).c_str());
}

TEST(LoadRange, MinimaxAttainsTheBoundForItsRatioOfLoads) {
  for (const double r : {2.0, 10.0, 100.0, 1e4}) {
    const double bound = 1.5 + std::log(r), a = 1 + bound;
    const BarrierFunction fn = with_exponent("minimax", a);
    EXPECT_NEAR(price(fn, 1 / a, r).slope, bound, 1e-5) << r;
    EXPECT_LT(price(fn, 1 / a, r).curvature, (1 + 1e-3) * bound * bound) << r;
    EXPECT_LT(relative(force(fn, 1 / a) / force(fn, 1 - 1.5 / a), r), 1e-5) << r;
    for (const double low : {0.1, 0.4}) {
      const double needed = bound / (1 - low);  // an exponent of at least 3 is allowed
      if (needed < 3) continue;
      EXPECT_NEAR(price(with_exponent("minimax_bounded", needed), low, r).slope, bound, 1e-5)
          << r << " " << low;
    }
  }
}

/// The numbers of the page: r = 100, from 0.1 d_hat to d_hat.
TEST(LoadRange, OtherShapesCostWhatThePageSays) {
  const double low = 0.1, r = 100;
  const auto expect = [&](const BarrierFunction& fn, double known) {
    EXPECT_NEAR(least_price(fn, low, r), known, 0.05) << fn.shape.name;
  };
  expect(barrier("quadratic"), 100);
  expect(barrier("two_stage"), 36);
  expect(barrier("cubic"), 20);
  expect(barrier("log"), 10.3);
  expect(barrier("log_squared"), 10.0);
  expect(with_exponent("minimax_bounded", 6.11 / 0.9), 6.1);
  EXPECT_NEAR(price(barrier("quadratic"), low, r).slope, r, 1e-9);
  EXPECT_NEAR(price(barrier("cubic"), low, r).slope, 2 * std::sqrt(r), 1e-2);
  double best = INFINITY, at = 0;
  for (double a = 6; a < 10; a += 0.1) {
    const double cost = least_price(with_exponent("exponential", a), low, r);
    if (cost < best) best = cost, at = a;
  }
  EXPECT_NEAR(best, 8.72, 0.01);
  EXPECT_NEAR(at, 7.7, 0.1);
}

/// Forces of registered shapes are continuous at d_hat, those of two continuous derivatives start without a slope.
TEST(LoadRange, NoShapeIsBelowTheBoundOfItsClass) {
  int smooth = 0, rough = 0;
  for (const Shape& shape : all_shapes()) {
    for (const double low : {0.01, 0.1, 0.3, 0.6}) {
      for (const double r : {1.5, 10.0, 100.0, 1e4}) {
        for (const double over : {1.0, 1.3, 3.0, 10.0}) {
          const Price found = price({shape, Argument::gap}, low, r, over, 4000);
          EXPECT_GE(found.slope, (1 + std::log(r)) * (1 - 1e-3)) << shape.name << " " << low << " " << r;
          ++rough;
          if (shape.smoothness_at_d_hat < 2 || found.curvature > found.slope * found.slope * (1 + 1e-6))
            continue;
          EXPECT_GE(found.slope, (1.5 + std::log(r)) * (1 - 1e-3)) << shape.name << " " << low << " " << r;
          ++smooth;
        }
      }
    }
  }
  EXPECT_GT(smooth, 100);
  EXPECT_GT(rough, smooth);
}

/// f(1) in units of f_lo of a force with f' <= p max(f, 1) and f'' <= bend p^2 max(f, 1), by Euler's steps. These are below
/// what they approximate, which is convex. `share` (0 to 1) says which part of the curvature it has at a depth.
template <class Share>
double carried(double p, double bend, const Share& share, int n = 4000) {
  double f = 0, slope = 0;
  for (int i = 0; i < n; ++i) {
    const double limit = bend * p * p * std::max(f, 1.0);
    f += slope / n;
    slope = std::clamp(slope + share(i) * limit / n, -p, p * std::max(f, 1.0));
  }
  return f;
}

TEST(LoadRange, NoForceThatKeepsTheConditionsCarriesMore) {
  std::mt19937 random(20261130);
  std::uniform_real_distribution<double> uniform(0, 1);
  double most = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const double p = 1.6 + 7 * uniform(random), keep = uniform(random), floor = 2 * uniform(random) - 1;
    const double f = carried(
        p, 1, [&](int) { return uniform(random) < keep ? 1.0 : floor + (1 - floor) * uniform(random); });
    EXPECT_LE(f, std::exp(p - 1.5) * (1 + 1e-12)) << trial;
    most = std::max(most, f / std::exp(p - 1.5));
  }
  EXPECT_GT(most, 0.9);                     // some come near
  for (const double p : {2.0, 5.0, 8.0}) {  // without the condition on the curvature it is the other bound
    const double f = carried(p, 1e3, [](int) { return 1.0; });
    EXPECT_GT(f, 1.4 * std::exp(p - 1.5)) << p;
    EXPECT_LE(f, std::exp(p - 1) * (1 + 1e-12)) << p;
  }
}

/// Of log and cubic, both with the largest load at the gap theta d_hat: which costs more is decided by 1/theta - 2 sqrt(r)
/// where its terms are not within a quarter of each other.
TEST(LoadRange, WhichOfLogAndCubicCostsMoreFollowsFromThetaAndTheRatio) {
  int log_more = 0, cubic_more = 0;
  for (const double theta : {0.2, 0.1, 0.05, 0.01, 0.001}) {
    for (const double r : {2.0, 5.0, 20.0, 100.0, 1e3, 1e4, 1e6}) {
      const double of_log = 1 / theta, of_cubic = 2 * std::sqrt(r);
      if (std::abs(std::log(of_log / of_cubic)) < std::log(1.25)) continue;
      const double log = price(barrier("log"), theta, r).slope,
                   cubic = price(barrier("cubic"), theta, r).slope;
      EXPECT_EQ(log > cubic, of_log > of_cubic) << theta << " " << r;
      ++(log > cubic ? log_more : cubic_more);
    }
  }
  EXPECT_GT(log_more, 8);
  EXPECT_GT(cubic_more, 8);
}

}  // namespace
}  // namespace bb::test::load_range_test
