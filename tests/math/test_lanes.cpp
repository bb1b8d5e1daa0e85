// Numbers side by side: every lane gets what the scalar code gives, whatever its neighbours need.
#include "core/math/lanes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

#include "core/math/lanes_log.hpp"
#include "core/math/psd.hpp"

namespace lanes_test {
namespace {

using namespace bb;
using Four = Lanes<double, 4>;
using Matrix = Mat<double, 9, 9>;

Four four(double a, double b, double c, double d) {
  Four out;
  out.v[0] = a, out.v[1] = b, out.v[2] = c, out.v[3] = d;
  return out;
}

TEST(Lanes, ChoosesLaneByLane) {
  const Four a = four(1, -2, 3, -4), zero(0.0);
  const Four size = select(a < zero, -a, a), root = sqrt(size);
  for (int lane = 0; lane < 4; ++lane) {
    EXPECT_EQ(size[lane], lane + 1);
    EXPECT_EQ(root[lane], std::sqrt(lane + 1.0));
    EXPECT_EQ(abs(a)[lane], lane + 1);
  }
  EXPECT_TRUE(any(a < zero));
  EXPECT_FALSE(any(size < zero));
  EXPECT_FALSE(any(a < zero && a > zero));
  EXPECT_FALSE(any(!(a < zero || a > zero)));
}

TEST(Lanes, PowersOfTwoAreExactAndHaveAnInverse) {
  const Four p = power_of_two_below(four(3, 0, 1, std::numeric_limits<double>::denorm_min()));
  EXPECT_EQ(p[0], 2);
  EXPECT_EQ(p[1], 1);
  EXPECT_EQ(p[2], 1);
  EXPECT_TRUE(std::isfinite(1 / p[3]));
}

template <class T>
void expect_powers_of_two_of_a_number() {
  constexpr int n_lanes = 32 / sizeof(T);
  using Limits = std::numeric_limits<T>;
  int n = 0;
  for (int exponent = Limits::min_exponent - Limits::digits; exponent <= Limits::max_exponent; ++exponent) {
    Lanes<T, n_lanes> of;
    for (int lane = 0; lane < n_lanes; ++lane)
      of.v[lane] = std::ldexp(1 - static_cast<T>(lane + 1) * Limits::epsilon() / 2, exponent);
    of.v[1] = std::ldexp(T(0.5), exponent);  // a power of two itself
    const Lanes<T, n_lanes> found = power_of_two_below(of);
    for (int lane = 0; lane < n_lanes; ++lane) {
      const T m = of[lane], power = found[lane];
      ASSERT_EQ(power, power_of_two_below(m)) << m;
      ASSERT_TRUE((power <= m && m / 2 < power) || power == least_scale<T> || m == 0) << m;
      n += power > least_scale<T>;
    }
  }
  EXPECT_GT(n, 200 * n_lanes);
  const Lanes<T, n_lanes> none = power_of_two_below(Lanes<T, n_lanes>(Limits::quiet_NaN()));
  EXPECT_EQ(none[0], power_of_two_below(Limits::quiet_NaN()));
}

TEST(Lanes, PowersOfTwoAreThoseOfANumberAtEverySize) {
  expect_powers_of_two_of_a_number<double>();
  expect_powers_of_two_of_a_number<float>();
}

Matrix random_symmetric(std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Matrix a;
  for (int j = 0; j < 9; ++j) {
    for (int i = j; i < 9; ++i) a(i, j) = a(j, i) = uniform(rng);
  }
  return a;
}

/// Matrices that take other ways through the eigen-solver: definite, split, of rank one, indefinite.
std::array<Matrix, 4> unlike(std::mt19937& rng) {
  const Matrix a = random_symmetric(rng), b = random_symmetric(rng);
  Matrix split = random_symmetric(rng);
  split.topRightCorner<4, 5>().setZero();
  split.bottomLeftCorner<5, 4>().setZero();
  return {Matrix(a + 9 * Matrix::Identity()), split, Matrix(-b.col(0) * b.col(0).transpose()), b};
}

Mat<Four, 9, 9> side_by_side(const std::array<Matrix, 4>& in) {
  Mat<Four, 9, 9> out;
  for (int k = 0; k < 81; ++k) {
    for (std::size_t lane = 0; lane < 4; ++lane) out.data()[k].v[lane] = in[lane].data()[k];
  }
  return out;
}

TEST(Lanes, EveryLaneIsProjectedAsIfAlone) {
  std::mt19937 rng(11);
  for (int repeat = 0; repeat < 20; ++repeat) {
    const std::array<Matrix, 4> in = unlike(rng);
    const Mat<Four, 9, 9> out = project<Four, 9>(side_by_side(in), Projection::psd);
    const Mat<Four, 9, 9> turned =
        project<Four, 9>(side_by_side({in[1], in[2], in[3], in[0]}), Projection::psd);
    for (int lane = 0; lane < 4; ++lane) {
      const Matrix expected = project<double, 9>(in[static_cast<std::size_t>(lane)], Projection::psd);
      Matrix got, again;
      for (int k = 0; k < 81; ++k) {
        got.data()[k] = out.data()[k][lane];
        again.data()[k] = turned.data()[k][(lane + 3) % 4];
      }
      EXPECT_LE((got - expected).norm(), 1e-14 * in[static_cast<std::size_t>(lane)].norm()) << lane;
      EXPECT_EQ(got, again) << lane;
      if (lane == 0) {
        EXPECT_EQ(got, in[0]);  // definite: untouched, bit for bit
      }
      if (lane != 2) {
        EXPECT_GT(expected.norm(), 0);
      }
    }
  }
}

TEST(Lanes, MinusLogHasTheBitsOfOneNumber) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  int near_one = 0, small = 0;
  for (int i = 0; i < 40000; ++i) {
    Four u, e;
    for (int lane = 0; lane < 4; ++lane) {
      if ((i + lane) % 2 == 0) {  // from e alone where u is close to 1
        e.v[lane] = std::pow(10.0, -20 * unit(random)) / 2;
        u.v[lane] = 1 - e[lane];
        near_one += u[lane] == 1;
      } else {
        u.v[lane] = std::pow(10.0, -300 * std::pow(unit(random), 4));
        e.v[lane] = 1 - u[lane];
        small += u[lane] < 1e-100;
      }
    }
    const Four found = elementary::minus_log_of(u, e);
    for (int lane = 0; lane < 4; ++lane)
      ASSERT_EQ(found[lane], elementary::minus_log(u[lane], e[lane])) << u[lane];
  }
  EXPECT_GT(near_one, 100);
  EXPECT_GT(small, 100);
}

}  // namespace
}  // namespace lanes_test
