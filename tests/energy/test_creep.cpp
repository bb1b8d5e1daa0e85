// Rest shapes that follow, stiffness that grows, triangles that shrink: closed forms, differences, long double.
#include <gtest/gtest.h>

#include <numbers>

#include "core/energy/creep.hpp"
#include "core/energy/hinge.hpp"
#include "core/math/error.hpp"
#include "tests/energy/energy_cases.hpp"
#include "tests/energy/host_family.hpp"
#include "tests/energy/strip.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::creep_test {
namespace {

TEST(Crept, LeavesTheDeadZoneAndDecaysTheRest) {
  EXPECT_EQ(crept(0.3, 0.3, 0.5), 0.3);
  EXPECT_EQ(crept(-0.2, 0.3, 0.0), -0.2);
  EXPECT_DOUBLE_EQ(crept(0.7, 0.3, 0.25), 0.4);
  EXPECT_DOUBLE_EQ(crept(-0.7, 0.3, 0.25), -0.4);
  EXPECT_EQ(crept(0.7, 0.3, 0.0), 0.3);
  EXPECT_EQ(crept(0.7, 0.3, kept_after(0, 0.01)), 0.7);
  // Two halves of a step are the step.
  const double half = kept_after(3, 0.05), whole = kept_after(3, 0.1);
  EXPECT_NEAR(crept(crept(0.9, 0.2, half), 0.2, half), crept(0.9, 0.2, whole), 1e-16);
}

TEST(Stiffened, IsItsClosedFormAtEverySizeAndSign) {
  const long double k = 0.7L, q = 0.4L, a = 3;
  for (const double u : {0.0, 1e-9, 1e-4, 0.05, 0.166, 0.167, 0.5, 2.0, 7.0}) {
    for (const double sign : {-1.0, 1.0}) {
      const auto got = stiffened<double>(sign * u, 0.7, 0.4, 3);
      const long double y = a * u;
      // For small y the sum of the series, since e^y - 1 - y cancels in long double too.
      long double remainder = std::expm1(y) - y;
      if (y < 0.1L)
        remainder = y * y / 2 * (1 + y / 3 * (1 + y / 4 * (1 + y / 5 * (1 + y / 6 * (1 + y / 7)))));
      const long double energy = k / 2 * u * u + q / (a * a) * remainder;
      const double tolerance = u >= 0.05 ? 1e-14 : 1e-8;  // the sum above ends
      EXPECT_NEAR(got.energy, static_cast<double>(energy), tolerance * static_cast<double>(energy));
      EXPECT_NEAR(got.slope, sign * static_cast<double>(k * u + q / a * std::expm1(y)),
                  2e-15 * std::abs(got.slope));
      EXPECT_NEAR(got.curvature, static_cast<double>(k + q * std::exp(y)), 2e-15 * got.curvature);
    }
  }
  EXPECT_EQ(stiffened<double>(0.5, 2, 0, 3).energy, 0.25);
}

TEST(Stiffened, HasNoJumpWhereTheSeriesEnds) {
  const double below = exponential_remainder(0.5), above = exponential_remainder(std::nextafter(0.5, 1.0));
  EXPECT_NEAR(below, above, 3e-15 * above);
  EXPECT_GT(above, 0.14);
}

/// Two triangles over the edge (0, 0, 0) to (1, 0, 0), the second turned by `angle`.
Positions bent(double angle) {
  Positions x(3, 4);
  x << 0, 1, 0.3, 0.6, 0, 0, 0.8, -0.5 * std::cos(angle), 0, 0, 0, -0.5 * std::sin(angle);
  return x;
}
HingePart one_hinge(double yield, double creep) {
  HingePart part;
  part.hinges = {{0, 1, 2, 3}}, part.stiffness = {0.7}, part.rest_angle = {0.1};
  if (creep > 0) part.yield = {yield}, part.creep = {creep};
  return part;
}

TEST(Hinges, KeepAnAngleOfClosedFormBeyondTheirYield) {
  const HingePart stays = one_hinge(0, 0), part = one_hinge(0.3, 4);
  EXPECT_FALSE(HostFamily(hinges_of(stays))->flows());
  HostFamily family(hinges_of(part));
  ASSERT_TRUE(family->flows());
  ASSERT_EQ(family.memory(), std::vector<double>{0.1});
  family.step(bent(1.2), 0.02, 5);
  const double kept = family.memory()[0], excess = 1.2 - 0.1 - 0.3;
  EXPECT_NEAR(kept, 0.1 + excess * (1 - std::exp(-4 * 5 * 0.02)), 1e-14);
  EXPECT_NEAR(family.values(bent(1.2))[0], 0.35 * std::pow(1.2 - kept, 2), 1e-14);
  EXPECT_LT(family.values(bent(kept))[0], 1e-28);  // it rests at the angle that it kept
}

TEST(Hinges, KeepTheirRestAngleToTheBitWithinTheirYield) {
  const HingePart part = one_hinge(0.3, 1e9);
  HostFamily family(hinges_of(part));
  for (const double angle : {0.1, 0.39, -0.19, 0.0}) family.step(bent(angle), 1);
  EXPECT_EQ(family.memory()[0], 0.1);
  family.step(bent(-0.6), 1);  // beyond it, at once as far as the dead zone reaches
  EXPECT_NEAR(family.memory()[0], -0.3, 1e-14);
}

/// Whoever looks at a step that is over sees its own energy.
TEST(Hinges, HaveTheRestAngleOfTheStepUntilTheNextBegins) {
  const HingePart part = one_hinge(0.3, 4);
  HostFamily family(hinges_of(part));
  const double before = family.values(bent(1.2))[0];
  family->end_step(bent(1.2).data(), 0.1);
  EXPECT_EQ(family.values(bent(1.2))[0], before);
  family->begin_step({});
  EXPECT_LT(family.values(bent(1.2))[0], 0.9 * before);
}

HingePart strip_hinges(const Strip& strip) {
  HingePart part;
  part.hinges = strip.hinges;
  part.stiffness.assign(strip.hinges.size(), 0.2), part.rest_angle.assign(strip.hinges.size(), 0.05);
  return part;
}

TEST(Hinges, HaveTheDerivativesOfAStiffnessThatGrows) {
  const Strip strip(40);
  const std::size_t n = strip.hinges.size();
  HingePart part = strip_hinges(strip);
  part.exponential.assign(n, 0.3), part.exponent.assign(n, 2.0);
  const HostFamily family(hinges_of(part));
  LocalTerms out, ahead, behind;
  family.derivatives(strip.deformed, Projection::none, out);
  EXPECT_EQ(family.values(strip.deformed), out.energy);
  const double h = 1e-6;
  for (const std::size_t e : {0u, 7u, 30u}) {
    const std::size_t per = out.hess.size() / n;
    const Eigen::MatrixXd hess = from_lower_blocks(&out.hess[per * e], 4);
    const Eigen::Map<Vec<double, 12>> gradient(&out.grad[12 * e]);
    EXPECT_GT(gradient.norm(), 1e-3);
    for (int k = 0; k < 12; ++k) {
      Positions x = strip.deformed;
      const int v = strip.hinges[e][static_cast<std::size_t>(k / 3)];
      x(k % 3, v) += h;
      const std::vector<double> more = family.values(x);
      family.derivatives(x, Projection::none, ahead);
      x(k % 3, v) -= 2 * h;
      const std::vector<double> less = family.values(x);
      family.derivatives(x, Projection::none, behind);
      EXPECT_NEAR(gradient[k], (more[e] - less[e]) / (2 * h), 1e-7 * gradient.norm());
      for (std::size_t j = 0; j < 12; ++j) {
        const double difference = (ahead.grad[12 * e + j] - behind.grad[12 * e + j]) / (2 * h);
        EXPECT_NEAR(hess(static_cast<Eigen::Index>(j), k), difference, 1e-7 * hess.norm());
      }
    }
    family.derivatives(strip.deformed, Projection::psd, ahead);
    const VecXd values = eigenvalues(from_lower_blocks(&ahead.hess[per * e], 4));
    EXPECT_GT(values.minCoeff(), -1e-12 * values.maxCoeff());
    EXPECT_GT(values.maxCoeff(), 1e-3);
  }
}

TEST(Hinges, AreTheSameToTheBitWithoutAnExponentialPart) {
  const Strip strip(40);
  const HingePart part = strip_hinges(strip);
  LocalTerms out;
  HostFamily(hinges_of(part)).derivatives(strip.deformed, Projection::psd, out);
  for (const std::size_t e : {3u, 5u}) {
    const test::Points<double, 4> p([&] {
      Vec<double, 12> x;
      for (int i = 0; i < 4; ++i)
        x.segment<3>(3 * i) = strip.deformed.col(strip.hinges[e][static_cast<std::size_t>(i)]);
      return x;
    }());
    EXPECT_EQ(out.energy[e], hinge_energy<double>(p.x, 0.2, 0.05).energy);
  }
}

// --- triangles

constexpr double mu = 2, lambda = 3;

Positions triangle() {
  Positions x(3, 3);
  x << 0.1, 1.3, 0.4, 0.2, 0.1, 0.9, 0, 0, 0;
  return x;
}
/// The same stretched along the axis of that angle, and across.
Positions stretched(double along, double across, double angle) {
  Mat3d turn;
  turn = Eigen::AngleAxisd(angle, Vec3d::UnitZ());
  const Mat3d map = turn * Vec3d(along, across, 1).asDiagonal() * turn.transpose();
  return map * triangle();
}
double area_of(const Positions& x) {
  return 0.5 * Vec3d(x.col(1) - x.col(0)).cross(Vec3d(x.col(2) - x.col(0))).norm();
}
/// Of corotational, at those singular values.
double corotational_energy(double area, double s0, double s1) {
  const double a = s0 - 1, b = s1 - 1;
  return area * (mu * (a * a + b * b) + lambda / 2 * (a + b) * (a + b));
}
MembranePart membrane(const Vec3d& warp, const Vec2d& shrink = Vec2d(1, 1)) {
  MembranePart part;
  part.model = "corotational", part.triangles = {{0, 1, 2}};
  part.lame_mu = {mu}, part.lame_lambda = {lambda};
  part.warp = {warp};
  if (shrink != Vec2d(1, 1)) part.shrink = {shrink};
  return part;
}
MembranePart creeping(MembranePart part, double yield, double creep) {
  part.yield = {yield}, part.creep = {creep};
  return part;
}

TEST(Membranes, ShrinkAlongTheirWarpAndAcross) {
  const double angle = 0.4;
  MembranePart part = membrane(Vec3d(std::cos(angle), std::sin(angle), 0), Vec2d(0.8, 1.1));
  const HostFamily family(membranes_of(part, triangle()));
  EXPECT_LT(family.values(stretched(0.8, 1.1, angle))[0], 1e-28);
  EXPECT_GT(family.values(stretched(1.1, 0.8, angle))[0], 0.1);
  const double area = 0.8 * 1.1 * area_of(triangle());
  EXPECT_NEAR(family.values(triangle())[0], corotational_energy(area, 1 / 0.8, 1 / 1.1), 1e-14);
}

TEST(Membranes, KeepAStretchOfClosedFormBeyondTheirYield) {
  const double angle = 0.7, area = area_of(triangle());
  const MembranePart part = creeping(membrane(Vec3d::UnitX()), 0.05, 2);
  HostFamily family(membranes_of(part, triangle()));
  const Positions x = stretched(1.25, 0.9, angle);
  EXPECT_NEAR(family.values(x)[0], corotational_energy(area, 1.25, 0.9), 1e-14);
  family.step(x, 0.1, 3);
  const double kept = std::exp(-2 * 0.3), s0 = 1.05 + kept * 0.2, s1 = 0.95 - kept * 0.05;
  EXPECT_NEAR(family.values(x)[0], corotational_energy(area, s0, s1), 1e-14);
  EXPECT_LT(family.values(stretched(1.25 / s0, 0.9 / s1, angle))[0], 1e-26);  // where it rests now
}

TEST(Membranes, KeepTheirRestShapeToTheBitWithinTheirYield) {
  const MembranePart part = creeping(membrane(Vec3d::UnitX()), 0.05, 1e9);
  HostFamily family(membranes_of(part, triangle()));
  const std::vector<double> before = family.memory();
  ASSERT_EQ(before, (std::vector<double>{1, 0, 0, 1}));
  family.step(stretched(1.0499, 0.951, 0.3), 1);
  EXPECT_EQ(family.memory(), before);
  family.step(stretched(1.0501, 0.951, 0.3), 1);
  EXPECT_NE(family.memory(), before);
}

TEST(Membranes, KeepAPlasticPartOfTheRestShapeThatTheyShrinkTo) {
  const MembranePart part = creeping(membrane(Vec3d::UnitX(), Vec2d(0.5, 0.8)), 0.1, 1e9);
  HostFamily family(membranes_of(part, triangle()));
  const double area = 0.4 * area_of(triangle());
  family.step(stretched(0.75, 0.8, 0), 1);  // 1.5 of what it shrank to
  EXPECT_NEAR(family.values(stretched(0.75, 0.8, 0))[0], corotational_energy(area, 1.1, 1), 1e-14);
  const std::vector<double> plastic_inv = family.memory();
  EXPECT_NEAR(plastic_inv[0], 1.1 / 1.5, 1e-14);  // a ratio, whatever the shrinking
  EXPECT_NEAR(plastic_inv[3], 1, 1e-14);
}

TEST(Membranes, ShrinkOverTimeFromWhatTheyWereGiven) {
  MembranePart part = membrane(Vec3d::UnitX());
  const Scene scene = scaled_rest(triangle(), {{0, 1}, {1, 0.8}});
  HostFamily family([&](const FamilyPlace& place) {
    return membrane_family(place, part, scene.rest, false, MovingRest(scene));
  });
  EXPECT_LT(family.values(triangle())[0], 1e-28);
  for (const double t : {0.5, 0.25, 0.5}) {
    FamilyStep step;
    step.t_end = t;
    family->change_step(step);
    const double factor = 1 - 0.2 * t;
    EXPECT_LT(family.values(stretched(factor, factor, 0))[0], 1e-28) << t;
    EXPECT_GT(family.values(triangle())[0], 1e-3) << t;
  }
}

}  // namespace
}  // namespace bb::test::creep_test
