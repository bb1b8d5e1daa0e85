// Bending of rods: angle, derivatives against differences and against the closed form in long double, the straight limit, cusps.
#include <gtest/gtest.h>

#include <numbers>

#include "core/energy/rod_bend.hpp"
#include "tests/energy/energy_cases.hpp"

namespace bb::test::rod_bend_test {
namespace {

constexpr double stiffness = 0.7;
constexpr double pi = std::numbers::pi;

/// Segments of lengths la and lb with that angle between them, turned and shifted.
Vec<double, 9> rod_state(double angle, double la = 0.8, double lb = 0.5) {
  Vec<double, 9> x;
  x << -la, 0, 0, 0, 0, 0, lb * std::cos(angle), lb * std::sin(angle), 0;
  std::mt19937 random(1);
  const Mat3d rotation = random_rotation(random);
  for (int i = 0; i < 3; ++i) x.segment<3>(3 * i) = rotation * x.segment<3>(3 * i) + Vec3d(0.3, -0.2, 0.5);
  return x;
}

struct Case {
  const char* name;
  Vec<double, 9> x;
  double angle, rest_angle;
};

const Case smooth_cases[] = {
    {"slightly bent", rod_state(1e-3), 1e-3, 0},
    {"bent", rod_state(0.7), 0.7, 0},
    {"a right angle", rod_state(pi / 2), pi / 2, 0.3},
    {"less bent than at rest", rod_state(0.4), 0.4, 1.2},
    {"sharp, unequal segments", rod_state(2.9, 0.01, 0.6), 2.9, 0.1},
    {"near a fold", rod_state(pi - 1e-3), pi - 1e-3, 0.2},
};

ElementTerms<double, 9> terms_of(const Vec<double, 9>& x, double rest_angle, Projection projection) {
  return rod_bend_terms<double>(Points<double, 3>(x).x, stiffness, rest_angle, projection);
}

/// The angle by the inverse cosine of Kahan's half angles: another formula than the code's.
Long angle_of(const VecXl& x) {
  const Vec<Long, 3> a = (x.segment<3>(3) - x.head<3>()).normalized(),
                     b = (x.tail<3>() - x.segment<3>(3)).normalized();
  return 2 * std::atan2((a - b).norm(), (a + b).norm());
}

TEST(RodBend, AngleAndItsDigitsAtBothEnds) {
  for (const Case& c : smooth_cases) {
    const Points<double, 3> p(c.x);
    EXPECT_NEAR(rod_corner<double>(p.x).angle, c.angle, 1e-14) << c.name;
  }
  const Vec3d nearly_straight[3] = {{-1, 0, 0}, {0, 0, 0}, {2, 1e-12, 0}};
  EXPECT_NEAR(rod_corner<double>(nearly_straight).angle, 5e-13, 1e-27);
  const Vec3d nearly_folded[3] = {{-1, 0, 0}, {0, 0, 0}, {-2, 1e-6, 0}};
  EXPECT_NEAR(pi - rod_corner<double>(nearly_folded).angle, 5e-7, 1e-15);
}

TEST(RodBend, DerivativesAreDifferencesOfTheClosedForm) {
  for (const Case& c : smooth_cases) {
    SCOPED_TRACE(c.name);
    const auto exact = terms_of(c.x, c.rest_angle, Projection::none);
    const VecXl at = c.x.cast<Long>();
    const auto value = [&](const VecXl& x) {
      const Long deviation = angle_of(x) - Long(c.rest_angle);
      return Long(stiffness) / 2 * deviation * deviation;
    };
    const auto gradient = [&](const VecXl& x) {
      return rod_bend_terms<Long>(Points<Long, 3>(x).x, stiffness, c.rest_angle, Projection::none).grad;
    };
    EXPECT_NEAR(exact.energy, static_cast<double>(value(at)), 1e-12 * exact.energy);
    EXPECT_GT(exact.energy, 1e-8);
    EXPECT_LT(gradient_error(value, at, exact.grad), 1e-8);
    EXPECT_LT(jacobian_error(gradient, at, exact.hess), 1e-8);
    EXPECT_EQ(exact.energy, rod_bend_value<double>(Points<double, 3>(c.x).x, stiffness, c.rest_angle));
  }
}

TEST(RodBend, DerivativesAreThoseOfLongDouble) {
  for (const Case& c : smooth_cases) {
    SCOPED_TRACE(c.name);
    const auto exact = terms_of(c.x, c.rest_angle, Projection::none);
    const auto longer =
        rod_bend_terms<Long>(Points<Long, 3>(c.x).x, stiffness, c.rest_angle, Projection::none);
    EXPECT_LT((exact.grad - longer.grad.cast<double>()).norm(), 1e-11 * exact.grad.norm());
    EXPECT_LT((exact.hess - longer.hess.cast<double>()).norm(), 1e-11 * exact.hess.norm());
  }
}

/// Two segments of length l in a plane, the outer ends at rest: theta is the turn of the middle, by hand.
TEST(RodBend, TransverseStiffnessOfAStraightRodByHand) {
  const double l = 0.25;
  const Vec3d x[3] = {{-l, 0, 0}, {0, 0, 0}, {l, 0, 0}};
  const auto terms = rod_bend_terms<double>(x, stiffness, 0, Projection::none);
  // y of p1 alone turns both segments by y/l, so theta = 2 y/l and the stiffness is 4 k/l^2; that of an end is k/l^2
  for (const int axis : {1, 2}) {
    EXPECT_NEAR(terms.hess(3 + axis, 3 + axis), 4 * stiffness / (l * l), 1e-12);
    EXPECT_NEAR(terms.hess(axis, axis), stiffness / (l * l), 1e-12);
    EXPECT_NEAR(terms.hess(axis, 3 + axis), -2 * stiffness / (l * l), 1e-12);
    EXPECT_NEAR(terms.hess(axis, 6 + axis), stiffness / (l * l), 1e-12);
  }
  EXPECT_EQ(terms.hess(0, 0), 0);
  EXPECT_TRUE(terms.grad.isZero(0));
  EXPECT_EQ(terms.energy, 0);
}

TEST(RodBend, IsSmoothWhereAStraightRodIsStraight) {
  const auto straight = terms_of(rod_state(0), 0, Projection::none);
  const double scale = straight.hess.cwiseAbs().maxCoeff();
  ASSERT_GT(scale, 1);
  EXPECT_LT(straight.grad.norm(), 1e-14);
  const double a = 1 / 0.8, b = 1 / 0.5, slope = std::sqrt(a * a + b * b + (a + b) * (a + b));
  double before = 1;
  for (const double angle : {1e-2, 1e-3, 1e-5, 1e-8}) {
    const auto bent = terms_of(rod_state(angle), 0, Projection::none);
    const double off = relative_difference(bent.hess, straight.hess, scale);
    EXPECT_LT(off, 3 * angle + 1e-9) << angle;  // the Hessian is linear in the angle: no jump
    EXPECT_LT(off, before);
    before = off;
    EXPECT_NEAR(bent.grad.norm(), stiffness * angle * slope, 1e-3 * angle + 1e-14) << angle;
  }
  for (const double y : {1e-200, 1e-30, 1e-12}) {
    const Vec3d x[3] = {{-1, 0, 0}, {0, 0, 0}, {2, y, 0}};
    const auto terms = rod_bend_terms<double>(x, stiffness, 0, Projection::none);
    EXPECT_TRUE(terms.hess.allFinite()) << y;
    if (y > 1e-100) {
      EXPECT_NEAR(terms.grad[7], stiffness * y / 4, 1e-14 * y);
    }
  }
}

/// At rest as a bent rod, stretched straight; and any rod folded back: no plane is the one in which it bends.
TEST(RodBend, HasFiniteTermsAtItsCusps) {
  const double l = 0.5;
  for (const bool folded : {false, true}) {
    const Vec3d x[3] = {{-l, 0, 0}, {0, 0, 0}, {folded ? -l : l, 0, 0}};
    EXPECT_TRUE(is_rod_cusp<double>(rod_corner<double>(x), 0.4));
    EXPECT_EQ(is_rod_cusp<double>(rod_corner<double>(x), 0.0), folded);
    for (const Projection projection : {Projection::none, Projection::psd, Projection::absolute}) {
      const auto terms = rod_bend_terms<double>(x, stiffness, 0.4, projection);
      const double deviation = (folded ? pi : 0) - 0.4;
      EXPECT_NEAR(terms.energy, stiffness / 2 * deviation * deviation, 1e-15);
      EXPECT_TRUE(terms.grad.isZero(0));
      // half of the straight rod's: the mean over the planes through the line
      EXPECT_NEAR(terms.hess(7, 7), stiffness / (2 * l * l), 1e-12);
      EXPECT_NEAR(terms.hess(8, 8), stiffness / (2 * l * l), 1e-12);
      EXPECT_NEAR(terms.hess(4, 4), (folded ? 0 : 4) * stiffness / (2 * l * l), 1e-12);
      EXPECT_NEAR(terms.hess(6, 6), 0, 1e-15);
      EXPECT_GE(eigenvalues(MatXd(terms.hess))[0], -1e-14);
    }
  }
}

TEST(RodBend, HasNoNumberWhereNeighboursCoincide) {
  const Vec3d p(0.3, 0.1, 0.2), q(0.4, 0.1, 0.2);
  for (const auto& points : {std::array{p, p, q}, std::array{p, q, q}}) {
    const Vec3d x[3] = {points[0], points[1], points[2]};
    EXPECT_TRUE(std::isnan(rod_bend_value<double>(x, stiffness, 0.4)));
    EXPECT_FALSE(rod_bend_terms<double>(x, stiffness, 0.4, Projection::none).grad.allFinite());
  }
}

TEST(RodBend, StaysFiniteUpToTheCusps) {
  for (const double off : {1e-4, 1e-8, 1e-12, 3e-16, 1e-18}) {
    for (const bool folded : {false, true}) {
      const Vec3d x[3] = {{-0.5, 0, 0}, {0, 0, 0}, {folded ? -0.5 : 0.5, 0.5 * off, 0}};
      const auto exact = rod_bend_terms<double>(x, stiffness, 0.4, Projection::none);
      const auto psd = rod_bend_terms<double>(x, stiffness, 0.4, Projection::psd);
      EXPECT_TRUE(exact.hess.allFinite() && psd.hess.allFinite()) << off;
      EXPECT_LE(exact.grad.norm(), 3 * stiffness * pi / 0.5) << off;
      EXPECT_GE(eigenvalues(MatXd(psd.hess))[0], -1e-12 * psd.hess.norm()) << off;
    }
  }
}

TEST(RodBend, ProjectionIsThatOfTheWholeMatrix) {
  int indefinite = 0;
  for (const Case& c : smooth_cases) {
    SCOPED_TRACE(c.name);
    const auto exact = terms_of(c.x, c.rest_angle, Projection::none);
    const auto psd = terms_of(c.x, c.rest_angle, Projection::psd);
    const auto absolute = terms_of(c.x, c.rest_angle, Projection::absolute);
    const double scale = exact.hess.cwiseAbs().maxCoeff();
    EXPECT_EQ(exact.hess, exact.hess.transpose());
    EXPECT_EQ(psd.hess, psd.hess.transpose());
    EXPECT_LT(relative_difference(psd.hess, clamped(exact.hess), scale), 1e-12);
    const MatXd flipped = clamped(exact.hess) + clamped(MatXd(-exact.hess));
    EXPECT_LT(relative_difference(absolute.hess, flipped, scale), 1e-12);
    EXPECT_EQ(psd.grad, exact.grad);
    EXPECT_GT(eigenvalues(MatXd(psd.hess))[8], 0);
    indefinite += eigenvalues(MatXd(exact.hess))[0] < -1e-3 * scale;
  }
  EXPECT_GE(indefinite, 3);
}

TEST(RodBend, NoForceOnTheWholeAndNoTorque) {
  for (const Case& c : smooth_cases) {
    SCOPED_TRACE(c.name);
    const auto terms = terms_of(c.x, c.rest_angle, Projection::psd);
    Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
    for (int i = 0; i < 3; ++i) {
      force += terms.grad.segment<3>(3 * i);
      torque += c.x.segment<3>(3 * i).cross(terms.grad.segment<3>(3 * i));
    }
    ASSERT_GT(terms.grad.norm(), 1e-6);
    EXPECT_LT(force.norm(), 1e-15 * terms.grad.norm());
    EXPECT_LT(torque.norm(), 1e-13 * terms.grad.norm());
  }
}

TEST(RodBend, FloatAgreesWithDouble) {
  for (const int i : {1, 2, 3}) {
    const Case& c = smooth_cases[i];
    SCOPED_TRACE(c.name);
    const auto exact = terms_of(c.x, c.rest_angle, Projection::psd);
    const auto single = rod_bend_terms<float>(Points<float, 3>(c.x).x, float(stiffness), float(c.rest_angle),
                                              Projection::psd);
    const double scale = exact.hess.cwiseAbs().maxCoeff();
    EXPECT_NEAR(static_cast<double>(single.energy), exact.energy, 1e-5 * exact.energy);
    EXPECT_LT(relative_difference(single.grad.cast<double>(), exact.grad, scale), 1e-5);
    EXPECT_LT(relative_difference(single.hess.cast<double>(), exact.hess, scale), 1e-5);
  }
}

}  // namespace
}  // namespace bb::test::rod_bend_test
