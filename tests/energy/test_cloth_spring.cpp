// Springs of cloth: exact derivatives in tension and compression against long double differences, their jump, projections.
#include <gtest/gtest.h>

#include "core/energy/cloth_spring.hpp"
#include "core/energy/spring.hpp"
#include "tests/energy/energy_cases.hpp"

namespace bb::test::cloth_spring_test {
namespace {

constexpr double rest_length = 0.8;

template <class T>
SpringLaw<T> law() {
  return {T(50), T(5), T(20), T(3), T(4)};
}

Vec<double, 6> state(double length) {
  Vec<double, 6> x;
  x << 0.1, -0.2, 0.3, 0, 0, 0;
  x.tail<3>() = x.head<3>() + length * Vec3d(0.48, -0.6, 0.64);
  return x;
}

TEST(ClothSpring, HasExactDerivativesOnBothSides) {
  using Long = long double;
  for (const double length : {0.05, 0.5, 0.79, 0.81, 1.1, 2.4}) {
    const Vec<double, 6> x = state(length);
    const auto exact =
        cloth_spring_terms<double>(Points<double, 2>(x).x, rest_length, law<double>(), Projection::none);
    const Long h = 1e-6L;
    for (int i = 0; i < 6; ++i) {
      Vec<Long, 6> ahead = x.cast<Long>(), behind = ahead;
      ahead[i] += h;
      behind[i] -= h;
      const auto more = cloth_spring_terms<Long>(Points<Long, 2>(ahead).x, Long(rest_length), law<Long>(),
                                                 Projection::none);
      const auto less = cloth_spring_terms<Long>(Points<Long, 2>(behind).x, Long(rest_length), law<Long>(),
                                                 Projection::none);
      EXPECT_NEAR(exact.grad[i], static_cast<double>((more.energy - less.energy) / (2 * h)),
                  1e-8 * exact.grad.norm());
      for (int j = 0; j < 6; ++j) {
        EXPECT_NEAR(exact.hess(j, i), static_cast<double>((more.grad[j] - less.grad[j]) / (2 * h)),
                    1e-8 * exact.hess.norm());
      }
    }
    EXPECT_GT(exact.grad.norm(), 0.1);
    EXPECT_GT(exact.energy, 0);
    EXPECT_EQ(exact.energy, cloth_spring_value<double>(Points<double, 2>(x).x, rest_length, law<double>()));
  }
}

TEST(ClothSpring, IsAPlainSpringWithOneLinearStiffness) {
  const SpringLaw<double> plain{3, 0, 3, 0, 10};
  for (const double length : {0.3, 1.3}) {
    const Points<double, 2> p(state(length));
    for (const Projection projection : {Projection::none, Projection::psd, Projection::absolute}) {
      const auto a = cloth_spring_terms<double>(p.x, rest_length, plain, projection);
      const auto b = spring_terms<double>(p.x, 3, rest_length, projection);
      EXPECT_NEAR(a.energy, b.energy, 1e-15);
      EXPECT_LT((a.grad - b.grad).norm(), 1e-14);
      EXPECT_LT((a.hess - b.hess).norm(), 1e-14);
      EXPECT_GT(a.hess.norm(), 1);
    }
  }
}

TEST(ClothSpring, ClampsWhatCompressionMakesNegative) {
  const Points<double, 2> p(state(0.3));
  const auto eigenvalues = [&](Projection projection) {
    const auto terms = cloth_spring_terms<double>(p.x, rest_length, law<double>(), projection);
    return test::eigenvalues(MatXd(terms.hess));
  };
  EXPECT_LT(eigenvalues(Projection::none).minCoeff(), -10);
  EXPECT_GT(eigenvalues(Projection::psd).minCoeff(), -1e-12);
  EXPECT_NEAR(eigenvalues(Projection::absolute)[4], -eigenvalues(Projection::none)[0], 1e-11);
  EXPECT_NEAR(eigenvalues(Projection::none).maxCoeff(), eigenvalues(Projection::psd).maxCoeff(), 1e-11);
}

TEST(ClothSpring, PullsOrPushesAloneWhereOneStiffnessIsZero) {
  const SpringLaw<double> pulls{50, 0, 0, 0, 10};
  const auto shorter =
      cloth_spring_terms<double>(Points<double, 2>(state(0.5)).x, rest_length, pulls, Projection::none);
  EXPECT_EQ(shorter.energy, 0);
  EXPECT_EQ(shorter.hess.norm(), 0);
  EXPECT_GT(cloth_spring_value<double>(Points<double, 2>(state(1)).x, rest_length, pulls), 0.9);
  const auto collapsed =
      cloth_spring_terms<double>(Points<double, 2>(state(0)).x, rest_length, law<double>(), Projection::none);
  EXPECT_EQ(collapsed.grad.norm(), 0);
  EXPECT_GT(collapsed.energy, 1);
}

/// With a softening of s the length is sqrt(d^2 + s^2): the energy of a linear spring as written, in long double.
TEST(ClothSpring, WithASofteningHasTheDerivativesOfItsEnergyAndNoCusp) {
  using Long = long double;
  const Long stiffness = 50, softening = 0.25L, h = 1e-6L;
  const auto energy = [&](const Vec<Long, 6>& x) {
    const Vec<Long, 3> d = x.tail<3>() - x.head<3>();
    const Long stretch = std::sqrt(d.dot(d) + softening * softening) - Long(rest_length);
    return stiffness / 2 * stretch * stretch;
  };
  SpringLaw<double> soft{50, 0, 50, 0, 10};
  soft.softening = 0.25;
  for (const double length : {0.0, 0.1, 0.7, 0.9}) {
    const Vec<double, 6> x = state(length);
    const Points<double, 2> p(x);
    const auto exact = cloth_spring_terms<double>(p.x, rest_length, soft, Projection::none);
    EXPECT_NEAR(exact.energy, static_cast<double>(energy(x.cast<Long>())), 1e-14 * exact.energy);
    EXPECT_EQ(exact.energy, cloth_spring_value<double>(p.x, rest_length, soft));
    EXPECT_FALSE(cloth_spring_is_cusp<double>(p.x, rest_length, soft));
    for (int i = 0; i < 6; ++i) {
      Vec<Long, 6> step = Vec<Long, 6>::Zero();
      step[i] = h;
      const Vec<Long, 6> at = x.cast<Long>();
      EXPECT_NEAR(exact.grad[i], static_cast<double>((energy(at + step) - energy(at - step)) / (2 * h)),
                  1e-8 * (1 + exact.grad.norm()));
      for (int j = 0; j < 6; ++j) {
        Vec<Long, 6> other = Vec<Long, 6>::Zero();
        other[j] = h * 100;
        step[i] = h * 100;
        const Long mixed = (energy(at + step + other) - energy(at + step - other) -
                            energy(at - step + other) + energy(at - step - other)) /
                           (4 * h * h * 10000);
        EXPECT_NEAR(exact.hess(i, j), static_cast<double>(mixed), 1e-5 * exact.hess.norm()) << i << j;
      }
    }
    EXPECT_GT(exact.hess.norm(), 1);
    const Eigen::VectorXd plain = test::eigenvalues(MatXd(exact.hess));
    const auto clamped = cloth_spring_terms<double>(p.x, rest_length, soft, Projection::psd);
    const Eigen::VectorXd kept = test::eigenvalues(MatXd(clamped.hess)), most = plain.cwiseMax(0.0);
    EXPECT_LT((kept - most).norm(), 1e-11) << kept.transpose() << " of " << plain.transpose();
    EXPECT_EQ(plain.minCoeff() < -1, length < 0.75);
  }
}

TEST(ClothSpring, WithoutASofteningIsWhatItWasToTheBit) {
  const Points<double, 2> p(state(0.5));
  EXPECT_EQ(spring_length<double>(p.x, 0), (p.x[1] - p.x[0]).norm());
  SpringLaw<double> none = law<double>();
  none.softening = 0;
  const auto a = cloth_spring_terms<double>(p.x, rest_length, none, Projection::psd);
  EXPECT_EQ(a.grad, cloth_spring_terms<double>(p.x, rest_length, law<double>(), Projection::psd).grad);
  EXPECT_GT(a.grad.norm(), 1);
}

}  // namespace
}  // namespace bb::test::cloth_spring_test
