// Logarithm, exponential function and angle against long double, over all that a double can be, and their special values.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <utility>

#include "core/math/atan2.hpp"
#include "core/math/exp.hpp"
#include "core/math/log.hpp"

namespace elementary_test {
namespace {

using namespace bb;
using Long = long double;

/// The error in units of the last place of `exact` as a double. Zeros of the other sign are far apart.
double ulps(double found, Long exact) {
  const auto rounded = static_cast<double>(exact);
  if (rounded == 0 || !std::isfinite(rounded)) {
    const bool same =
        std::isnan(rounded) ? std::isnan(found) : std::memcmp(&found, &rounded, sizeof found) == 0;
    return same ? 0 : 1e9;
  }
  if (std::isnan(found)) return 1e9;
  int exponent = 0;
  std::frexp(std::fabs(rounded), &exponent);
  const Long unit = std::ldexp(1.0L, std::max(exponent - 53, -1074));
  return static_cast<double>(std::fabs((found - exact) / unit));
}

struct Random {
  std::mt19937_64 bits{7};
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(bits); }
  double power(double low, double high) { return std::exp2(in(low, high)); }
  double sign() { return bits() % 2 == 0 ? -1 : 1; }
};

constexpr int n = 500000;

/// The largest error of n arguments; none is skipped.
double worst(const std::function<std::pair<double, Long>(Random&)>& found_and_exact) {
  Random random;
  double out = 0;
  int compared = 0;
  for (; compared < n; ++compared) {
    const auto [found, exact] = found_and_exact(random);
    out = std::max(out, ulps(found, exact));
  }
  EXPECT_EQ(compared, n);
  return out;
}

template <class F, class Exact>
double worst_of(F f, Exact exact, const std::function<double(Random&)>& argument) {
  return worst([&](Random& random) {
    const double x = argument(random);
    return std::pair(f(x), exact(static_cast<Long>(x)));
  });
}
const auto log_of_long = [](Long x) { return std::log(x); };
const auto log_here = [](double x) { return elementary::log(x); };
const auto exp_of_long = [](Long x) { return std::exp(x); };
const auto exp_here = [](double x) { return elementary::exp(x); };
const auto expm1_of_long = [](Long x) { return std::expm1(x); };
const auto expm1_here = [](double x) { return elementary::expm1(x); };

double every_size(Random& r) { return r.power(-1074, 1024); }
double near_one(Random& r) { return 1 + r.sign() * r.power(-52, -1); }
double around_one(Random& r) { return r.power(-2, 2); }
double small(Random& r) { return r.sign() * r.power(-80, 1); }

TEST(Elementary, TheLogarithmIsWithinOneUlp) {
  for (const auto argument : {every_size, near_one, around_one}) {
    const double found = worst_of(log_here, log_of_long, argument);
    EXPECT_LT(found, 0.9);
    EXPECT_GT(found, 0.5);  // less no rounding can reach: something was compared
  }
}

TEST(Elementary, TheLogarithmKeepsItsSignAndOrderNearOne) {
  EXPECT_EQ(elementary::log(1.0), 0);
  EXPECT_FALSE(std::signbit(elementary::log(1.0)));
  for (double x = 1, last = 0; x < 1 + 1e-12; last = elementary::log(x)) {
    x = std::nextafter(x, 2);
    ASSERT_GT(elementary::log(x), last);
  }
  for (double x = 1, last = 0; x > 1 - 1e-12; last = elementary::log(x)) {
    x = std::nextafter(x, 0);
    ASSERT_LT(elementary::log(x), last);
  }
}

TEST(Elementary, MinusLogTakesTheMoreExactOfItsArguments) {
  constexpr double root_half = 0x1.6a09e667f3bcdp-1;
  int near = 0, far = 0;
  const double found = worst([&](Random& random) {
    const double u = random.bits() % 2 == 0 ? random.power(-1074, 0) : 1 - random.power(-70, -1), e = 1 - u;
    if (u < root_half) {
      ++far;
      return std::pair(elementary::minus_log(u, e), -std::log(static_cast<Long>(u)));
    }
    ++near;
    const double exact_e =
        e == 0 ? random.power(-70, -54) : e;  // u rounds to 1, and only e says how close it is
    return std::pair(elementary::minus_log(u, exact_e), -std::log1p(-static_cast<Long>(exact_e)));
  });
  EXPECT_LT(found, 0.9);
  EXPECT_GT(found, 0.5);
  EXPECT_GT(std::min(near, far), n / 10);
}

TEST(Elementary, TheExponentialFunctionIsWithinOneUlp) {
  const std::function<double(Random&)> arguments[] = {[](Random& r) { return r.in(-709, 709.7); }, small,
                                                      [](Random& r) { return r.in(-1, 1); }};
  for (const auto& argument : arguments) {
    const double of_exp = worst_of(exp_here, exp_of_long, argument),
                 of_expm1 = worst_of(expm1_here, expm1_of_long, argument);
    EXPECT_LT(of_exp, 0.8);
    EXPECT_LT(of_expm1, 1);
    EXPECT_GT(std::min(of_exp, of_expm1), 0.49);  // less no rounding can reach: something was compared
  }
  EXPECT_LE(worst_of(exp_here, exp_of_long, [](Random& r) { return r.in(-746, -708); }),
            1);  // numbers with fewer digits
}

TEST(Elementary, TheAngleIsWithinOneUlp) {
  const auto angle = [](double y, double x) {
    return std::pair(elementary::atan2(y, x), std::atan2(static_cast<Long>(y), static_cast<Long>(x)));
  };
  const std::function<std::pair<double, Long>(Random&)> arguments[] = {
      [&](Random& r) { return angle(r.in(-1, 1), r.in(-1, 1)); },
      [&](Random& r) { return angle(r.in(-1, 1) * r.power(-70, 0), r.in(-1, 1)); },
      [&](Random& r) { return angle(r.in(-1, 1), r.in(-1, 1) * r.power(-70, 0)); },
      [&](Random& r) { return angle(r.sign() * every_size(r), r.sign() * every_size(r)); },
      [&](Random& r) { return angle(r.power(-1074, -1000), r.sign() * r.power(-1074, -1000)); },
      [&](Random& r) { return angle(r.power(1000, 1024), r.sign() * r.power(1000, 1024)); }};
  for (const auto& argument : arguments) {
    const double found = worst(argument);
    EXPECT_LE(found, 0.53);
    EXPECT_GT(found, 0.49);
  }
}

TEST(Elementary, HaveTheSpecialValuesOfTheStandardLibrary) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const double numbers[] = {0.0,    -0.0,    1,      -1,      inf,      -inf, nan,
                            5e-324, -5e-324, 1e-310, 1.7e308, -1.7e308, 0.25, 1e-300};
  for (const double x : numbers) {
    EXPECT_LE(ulps(elementary::log(x), std::log(x)), 1) << x;
    EXPECT_LE(ulps(elementary::minus_log(x, 1 - x), -std::log(x)), 1) << x;
    EXPECT_LE(ulps(elementary::exp(x), std::exp(x)), 1) << x;
    EXPECT_LE(ulps(elementary::expm1(x), std::expm1(x)), 1) << x;
    for (const double y : numbers)
      EXPECT_LE(ulps(elementary::atan2(y, x), std::atan2(y, x)), 1) << y << " " << x;
  }
}

TEST(Elementary, FloatsAreTheRoundedDoubles) {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<float>(random.power(-100, 100)), y = static_cast<float>(random.in(-80, 80));
    EXPECT_EQ(elementary::log(x), static_cast<float>(elementary::log(static_cast<double>(x))));
    EXPECT_EQ(elementary::exp(y), static_cast<float>(elementary::exp(static_cast<double>(y))));
    EXPECT_EQ(elementary::expm1(y), static_cast<float>(elementary::expm1(static_cast<double>(y))));
    EXPECT_EQ(elementary::atan2(y, x),
              static_cast<float>(elementary::atan2(static_cast<double>(y), static_cast<double>(x))));
  }
}

}  // namespace
}  // namespace elementary_test
