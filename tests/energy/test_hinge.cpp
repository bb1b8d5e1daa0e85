// Hinges: angle, exact derivatives at flat, obtuse, folded and inverted shapes, wrapping, projection.
#include <gtest/gtest.h>

#include <numbers>

#include "core/energy/hinge.hpp"
#include "core/energy/hinge_lanes.hpp"
#include "tests/energy/energy_cases.hpp"

namespace bb::test::hinge_test {
namespace {

constexpr double stiffness = 0.7;
constexpr double pi = std::numbers::pi;

/// Edge along x; v0 at (a, h, 0), v1 at distance h1 turned so that the angle is `angle`; then
/// rotated and shifted.
Vec<double, 12> hinge_state(double angle, double a = 0.4, double h = 0.8, double b = 0.5, double h1 = 0.6) {
  Vec<double, 12> x;
  x << 0, 0, 0, 1.2, 0, 0, a, h, 0, b, -h1 * std::cos(angle), -h1 * std::sin(angle);
  std::mt19937 random(1);
  const Mat3d rotation = random_rotation(random);
  for (int i = 0; i < 4; ++i) x.segment<3>(3 * i) = rotation * x.segment<3>(3 * i) + Vec3d(0.3, -0.2, 0.5);
  return x;
}

struct Case {
  const char* name;
  Vec<double, 12> x;
  double angle, rest_angle;
};

const Case cases[] = {
    {"flat, at rest", hinge_state(0), 0, 0},
    {"flat, bent rest", hinge_state(0), 0, 0.4},
    {"nearly flat", hinge_state(1e-6), 1e-6, 0},
    {"bent", hinge_state(0.7), 0.7, 0.1},
    {"bent the other way", hinge_state(-1.3), -1.3, 0.1},
    {"obtuse triangles", hinge_state(0.5, -0.9, 0.3, 2.5, 0.2), 0.5, 0},
    {"folded", hinge_state(3.1), 3.1, 0},
    {"folded past the wrap", hinge_state(-3.1), -3.1, 3.0},
    {"sliver", hinge_state(0.9, 0.4, 1e-3, 0.5, 0.6), 0.9, 0},
};

double angle_of(const Vec<double, 12>& x) { return hinge_angle<double>(Points<double, 4>(x).x); }

TEST(Hinge, AngleAndItsSign) {
  for (const Case& c : cases) EXPECT_NEAR(angle_of(c.x), c.angle, 1e-12) << c.name;
  const Vec3d raised[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0.25}};
  EXPECT_NEAR(hinge_angle<double>(raised), -std::atan(0.25), 1e-15);
}

TEST(Hinge, AngleKeepsItsDigitsNearFlat) {
  const Vec3d raised[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 1e-12}};
  EXPECT_NEAR(hinge_angle<double>(raised), -1e-12, 1e-27);
}

TEST(Hinge, AngleDerivatives) {
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const VecXl x = (c.x.tail<9>() - c.x.head<3>().replicate<3, 1>()).cast<Long>();
    const auto points = [](const VecXl& r) {
      VecXl full = VecXl::Zero(12);
      full.tail(9) = r;
      return Points<Long, 4>(full);
    };
    // the independent angle: from the parts of v0 and v1 at right angles to the edge
    const auto angle = [](const VecXl& r) {
      const Vec<Long, 3> e = r.head<3>().normalized();
      const Vec<Long, 3> a = r.segment<3>(3) - e.dot(r.segment<3>(3)) * e,
                         b = e.dot(r.tail<3>()) * e - r.tail<3>();
      return std::atan2(e.dot(a.cross(b)), a.dot(b));
    };
    const auto gradient = [&](const VecXl& r) { return hinge_angle_terms<Long>(points(r).x).grad; };
    const auto terms = hinge_angle_terms<double>(Points<double, 4>(c.x).x);
    EXPECT_LT(gradient_error(angle, x, terms.grad), 1e-9);
    EXPECT_LT(jacobian_error(gradient, x, terms.hess), 1e-9);
  }
}

TEST(Hinge, EnergyDerivativesAndProjection) {
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const Points<double, 4> p(c.x);
    const auto exact = hinge_terms<double>(p.x, Projection::none, stiffness, c.rest_angle);
    const auto psd = hinge_terms<double>(p.x, Projection::psd, stiffness, c.rest_angle);
    const VecXl at = c.x.cast<Long>();
    const auto value = [&](const VecXl& x) {
      return hinge_energy<Long>(Points<Long, 4>(x).x, stiffness, c.rest_angle).energy;
    };
    const auto gradient = [&](const VecXl& x) {
      return hinge_terms<Long>(Points<Long, 4>(x).x, Projection::none, stiffness, c.rest_angle).grad;
    };
    const double scale = exact.hess.cwiseAbs().maxCoeff();
    EXPECT_EQ(exact.energy, hinge_energy<double>(p.x, stiffness, c.rest_angle).energy);
    if (c.angle == c.rest_angle) {
      EXPECT_LT(exact.grad.norm(), 1e-14);
    } else {
      EXPECT_LT(gradient_error(value, at, exact.grad), 1e-8);
    }
    EXPECT_LT(jacobian_error(gradient, at, exact.hess), 1e-8);
    EXPECT_EQ(exact.hess, exact.hess.transpose());
    EXPECT_EQ(psd.hess, psd.hess.transpose());
    EXPECT_LT(relative_difference(psd.hess, clamped(exact.hess), scale), 1e-10);
    EXPECT_EQ(psd.grad, exact.grad);
  }
}

TEST(Hinge, SomeStateIsIndefinite) {
  const Points<double, 4> p(cases[3].x);
  const auto exact = hinge_terms<double>(p.x, Projection::none, stiffness, 0.1);
  const auto psd = hinge_terms<double>(p.x, Projection::psd, stiffness, 0.1);
  EXPECT_GT((exact.hess - psd.hess).norm(), 0.01);
}

/// However little: so whoever clamps hinges has to clamp all that are not at rest.
TEST(Hinge, EveryStateOffItsRestAngleIsIndefinite) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double size : {1e-6, 1e-4, 1e-2, 0.1, 0.3}) {
    for (int k = 0; k < 200; ++k) {
      Vec<double, 12> x = hinge_state(0);
      for (double& coordinate : x) coordinate += size * unit(random);
      const Mat<double, 12, 12> hess =
          hinge_terms<double>(Points<double, 4>(x).x, Projection::none, stiffness, 0.0).hess;
      Vec<double, 12> values;
      Mat<double, 12, 12> vectors;
      sym_eigen<double, 12>(hess, values, vectors);
      EXPECT_LT(values[0], -1e-11 * values[11]) << size;
    }
  }
}

TEST(Hinge, DeviationIsTheShortWayRound) {
  EXPECT_NEAR(hinge_deviation(-3.1, 3.0), 2 * pi - 6.1, 1e-15);
  EXPECT_NEAR(hinge_deviation(3.1, -3.0), 6.1 - 2 * pi, 1e-15);
  EXPECT_EQ(hinge_deviation(0.5, 0.25), 0.25);
  EXPECT_EQ(hinge_deviation(0.0, pi), pi);
  EXPECT_EQ(hinge_deviation(pi, 0.0), pi);
}

TEST(Hinge, NoForceOnTheWholeAndNoTorque) {
  for (const Case& c : cases) {
    if (c.angle == c.rest_angle) continue;
    SCOPED_TRACE(c.name);
    const auto terms =
        hinge_terms<double>(Points<double, 4>(c.x).x, Projection::psd, stiffness, c.rest_angle);
    Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
    for (int i = 0; i < 4; ++i) {
      force += terms.grad.segment<3>(3 * i);
      torque += c.x.segment<3>(3 * i).cross(terms.grad.segment<3>(3 * i));
    }
    const double scale = terms.grad.norm();
    EXPECT_GT(scale, 0);
    EXPECT_LT(force.norm(), 1e-13 * scale);
    EXPECT_LT(torque.norm(), 1e-12 * scale);
  }
}

TEST(Hinge, FloatAgreesWithDouble) {
  for (const int i : {1, 3, 4, 5}) {
    const Case& c = cases[i];
    SCOPED_TRACE(c.name);
    const auto exact =
        hinge_terms<double>(Points<double, 4>(c.x).x, Projection::psd, stiffness, c.rest_angle);
    const auto single =
        hinge_terms<float>(Points<float, 4>(c.x).x, Projection::psd, float(stiffness), float(c.rest_angle));
    const double scale = exact.hess.cwiseAbs().maxCoeff();
    EXPECT_NEAR(static_cast<double>(single.energy), exact.energy, 1e-5 * exact.energy);
    EXPECT_LT(relative_difference(single.grad.cast<double>(), exact.grad, scale), 1e-4);
    EXPECT_LT(relative_difference(single.hess.cast<double>(), exact.hess, scale), 1e-4);
  }
}

/// Within half a turn, where most hinges are, and beyond it.
template <class T>
void compare_deviations() {
  const T half_turn = T(pi);
  int beyond = 0;
  for (int i = -900; i <= 900; ++i) {
    const T rest = T(0.4), angle = T(i) / T(100) * half_turn / T(3) + rest,
            turns = std::remainder(angle - rest, T(2) * half_turn);
    EXPECT_EQ(hinge_deviation<T>(angle, rest), turns > -half_turn ? turns : turns + T(2) * half_turn) << i;
    beyond += std::abs(angle - rest) > half_turn;
  }
  EXPECT_GT(beyond, 100);
  EXPECT_LT(beyond, 1700);
}

TEST(Hinge, DeviationIsWhatIsLeftOfWholeTurns) { compare_deviations<double>(), compare_deviations<float>(); }

/// Bits: what kernels on the host and the CPU path take four of.
template <class T>
void compare_abreast() {
  constexpr int n = static_cast<int>(std::size(cases));
  for (int first = 0; first < n; ++first) {
    HingesAbreast<T> hinges;
    const auto points = [&](int lane) { return Points<T, 4>(cases[(first + lane) % n].x); };
    const auto energy = [&](int lane) {
      return hinge_energy<T>(points(lane).x, T(stiffness), T(cases[(first + lane) % n].rest_angle));
    };
    for (int lane = 0; lane < hinge_lanes; ++lane) hinges.set(lane, points(lane).x, energy(lane));
    for (const Projection projection : {Projection::none, Projection::psd}) {
      TermsAbreast<T, hinge_lanes, 4> got;
      hinge_terms_abreast(hinges, projection, got);
      for (int lane = 0; lane < hinge_lanes; ++lane) {
        SCOPED_TRACE(cases[(first + lane) % n].name);
        const auto one = hinge_terms_of<T>(points(lane).x, energy(lane), projection);
        EXPECT_EQ(got.energy[lane], one.energy);
        for (int k = 0; k < 12; ++k) EXPECT_EQ(got.grad[k][lane], one.grad[k]);
        EXPECT_GT(one.hess.norm(), 0);
        const auto* number = got.hess;
        for_each_lower_number(
            4, [&](int row, int column) { EXPECT_EQ((*number++)[lane], one.hess(row, column)); });
      }
    }
  }
}

TEST(Hinge, FourAbreastHaveTheBitsOfOneByOne) { compare_abreast<double>(), compare_abreast<float>(); }

}  // namespace
}  // namespace bb::test::hinge_test
