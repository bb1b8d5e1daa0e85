// Rest shapes that follow, stiffness that grows, triangles that shrink: closed forms, differences, long double.
#include <gtest/gtest.h>

#include <numbers>

#include "core/energy/creep.hpp"
#include "core/energy/hinge.hpp"
#include "core/energy/hinge_batch.hpp"
#include "core/energy/membrane_batch.hpp"
#include "core/math/error.hpp"
#include "tests/energy/energy_cases.hpp"
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
const std::array<int, 4> one_hinge[] = {{0, 1, 2, 3}};

TEST(HingeBatch, KeepsAnAngleOfClosedFormBeyondItsYield) {
  HingeBatch batch(one_hinge, {0.7}, {0.1});
  EXPECT_TRUE(batch.memory().empty());
  batch.set_creep({0.3}, {4});
  ASSERT_EQ(batch.memory().size(), 1u);
  std::vector<double> memory(batch.memory().begin(), batch.memory().end());
  for (int step = 0; step < 5; ++step) {
    batch.flow(bent(1.2), 0.02, memory);
    batch.set_memory(memory);
  }
  const double excess = 1.2 - 0.1 - 0.3;
  EXPECT_NEAR(memory[0], 0.1 + excess * (1 - std::exp(-4 * 5 * 0.02)), 1e-14);
  double energy = 0;
  batch.values(bent(1.2), &energy);
  EXPECT_NEAR(energy, 0.35 * std::pow(1.2 - memory[0], 2), 1e-14);
  batch.values(bent(memory[0]), &energy);
  EXPECT_LT(energy, 1e-28);  // it rests at the angle that it kept
}

TEST(HingeBatch, KeepsItsRestAngleToTheBitWithinItsYield) {
  HingeBatch batch(one_hinge, {0.7}, {0.1});
  batch.set_creep({0.3}, {1e9});
  std::vector<double> memory{0.1};
  for (const double angle : {0.1, 0.39, -0.19, 0.0}) batch.flow(bent(angle), 1, memory);
  EXPECT_EQ(memory[0], 0.1);
  batch.flow(bent(-0.6), 1, memory);  // beyond it, at once as far as the dead zone reaches
  EXPECT_NEAR(memory[0], -0.3, 1e-14);
}

TEST(HingeBatch, HasTheDerivativesOfAStiffnessThatGrows) {
  const Strip strip(40);
  const std::size_t n = strip.hinges.size();
  HingeBatch batch(strip.hinges, std::vector<double>(n, 0.2), std::vector<double>(n, 0.05));
  batch.set_stiffening(std::vector<double>(n, 0.3), std::vector<double>(n, 2.0));
  LocalTerms out, ahead, behind;
  batch.derivatives(strip.deformed, Projection::none, out);
  std::vector<double> energy(n), more(n), less(n);
  batch.values(strip.deformed, energy.data());
  EXPECT_EQ(energy, out.energy);
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
      batch.values(x, more.data());
      batch.derivatives(x, Projection::none, ahead);
      x(k % 3, v) -= 2 * h;
      batch.values(x, less.data());
      batch.derivatives(x, Projection::none, behind);
      EXPECT_NEAR(gradient[k], (more[e] - less[e]) / (2 * h), 1e-7 * gradient.norm());
      for (std::size_t j = 0; j < 12; ++j) {
        const double difference = (ahead.grad[12 * e + j] - behind.grad[12 * e + j]) / (2 * h);
        EXPECT_NEAR(hess(static_cast<Eigen::Index>(j), k), difference, 1e-7 * hess.norm());
      }
    }
    batch.derivatives(strip.deformed, Projection::psd, ahead);
    const VecXd values = eigenvalues(from_lower_blocks(&ahead.hess[per * e], 4));
    EXPECT_GT(values.minCoeff(), -1e-12 * values.maxCoeff());
    EXPECT_GT(values.maxCoeff(), 1e-3);
  }
}

TEST(HingeBatch, IsTheSameToTheBitWithoutAnExponentialPart) {
  const Strip strip(40);
  const std::size_t n = strip.hinges.size();
  HingeBatch plain(strip.hinges, std::vector<double>(n, 0.2), std::vector<double>(n, 0.05));
  LocalTerms out;
  plain.derivatives(strip.deformed, Projection::psd, out);
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

const std::array<int, 3> one_triangle[] = {{0, 1, 2}};
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
MembraneBatch membrane(const Vec3d& warp) {
  const std::vector<Vec3d> directions{warp};
  return {"corotational", one_triangle, triangle(), {mu}, {lambda}, false, directions};
}
double energy_of(const MembraneBatch& batch, const Positions& x) {
  double out = 0;
  batch.values(x, &out);
  return out;
}

TEST(MembraneBatch, ShrinksAlongItsWarpAndAcross) {
  const double angle = 0.4;
  MembraneBatch batch("corotational", one_triangle, triangle(), {mu}, {lambda}, false,
                      std::vector<Vec3d>{Vec3d(std::cos(angle), std::sin(angle), 0)});
  const Vec2d factors[] = {Vec2d(0.8, 1.1)};
  batch.scale_rest(factors);
  EXPECT_LT(energy_of(batch, stretched(0.8, 1.1, angle)), 1e-28);
  EXPECT_GT(energy_of(batch, stretched(1.1, 0.8, angle)), 0.1);
  const double area = 0.8 * 1.1 * area_of(triangle());
  EXPECT_NEAR(energy_of(batch, triangle()), corotational_energy(area, 1 / 0.8, 1 / 1.1), 1e-14);
  EXPECT_THROW(batch.scale_rest({}), ConfigError);
}

TEST(MembraneBatch, KeepsAStretchOfClosedFormBeyondItsYield) {
  const double angle = 0.7, area = area_of(triangle());
  MembraneBatch batch = membrane(Vec3d::UnitX());
  batch.set_creep({0.05}, {2});
  const Positions x = stretched(1.25, 0.9, angle);
  EXPECT_NEAR(energy_of(batch, x), corotational_energy(area, 1.25, 0.9), 1e-14);
  std::vector<double> memory(batch.memory().begin(), batch.memory().end());
  for (int step = 0; step < 3; ++step) {
    batch.flow(x, 0.1, memory);
    batch.set_memory(memory);
  }
  const double kept = std::exp(-2 * 0.3), s0 = 1.05 + kept * 0.2, s1 = 0.95 - kept * 0.05;
  EXPECT_NEAR(energy_of(batch, x), corotational_energy(area, s0, s1), 1e-14);
  EXPECT_LT(energy_of(batch, stretched(1.25 / s0, 0.9 / s1, angle)), 1e-26);  // where it rests now
}

TEST(MembraneBatch, KeepsItsRestShapeToTheBitWithinItsYield) {
  MembraneBatch batch = membrane(Vec3d::UnitX());
  batch.set_creep({0.05}, {1e9});
  const std::vector<double> before(batch.memory().begin(), batch.memory().end());
  std::vector<double> memory = before;
  batch.flow(stretched(1.0499, 0.951, 0.3), 1, memory);
  EXPECT_EQ(memory, before);
  batch.flow(stretched(1.0501, 0.951, 0.3), 1, memory);
  EXPECT_NE(memory, before);
}

TEST(MembraneBatch, KeepsAPlasticPartOfTheRestShapeThatItShrinksTo) {
  MembraneBatch batch = membrane(Vec3d::UnitX());
  const Vec2d factors[] = {Vec2d(0.5, 0.8)};
  batch.scale_rest(factors);
  batch.set_creep({0.1}, {1e9});
  const double area = 0.4 * area_of(triangle());
  std::vector<double> memory(batch.memory().begin(), batch.memory().end());
  batch.flow(stretched(0.75, 0.8, 0), 1, memory);  // 1.5 of what it shrank to
  batch.set_memory(memory);
  EXPECT_NEAR(energy_of(batch, stretched(0.75, 0.8, 0)), corotational_energy(area, 1.1, 1), 1e-14);
  EXPECT_NEAR(memory[0], 1.1 / 1.5, 1e-14);  // a ratio, whatever the shrinking
  EXPECT_NEAR(memory[3], 1, 1e-14);
}

}  // namespace
}  // namespace bb::test::creep_test
