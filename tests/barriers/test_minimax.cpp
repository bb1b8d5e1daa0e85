// The shapes `minimax` and `minimax_bounded`: their terms for every exponent, joints, capacity, names with an exponent.
// What they are made for is in test_load_range.cpp.
#include <gtest/gtest.h>

#include "barriers/matching.hpp"
#include "core/math/error.hpp"
#include "tests/barriers/barrier_cases.hpp"
#include "tests/barriers/minimax_terms.hpp"

namespace bb::test::minimax_test {
namespace {

const std::vector<double> exponents{3, 5, 7, 12, 40};
const std::vector<const char*> shapes{"minimax_bounded", "minimax"};

BarrierFunction with_exponent(const char* shape, double a) {
  return barrier((std::string(shape) + ":" + std::to_string(a)).c_str());
}

/// Gaps in units of d_hat where the formulas of the shape meet.
std::vector<double> joints(const std::string& shape, double a) {
  std::vector<double> all{1 - 1 / a, 1 - 1.5 / a};
  if (shape == "minimax") all.push_back(1 / a);
  return all;
}

TEST(Minimax, MatchesIntegralsOfItsForceForEveryExponent) {
  for (const char* shape : shapes) {
    for (const double a : exponents) {
      const BarrierFunction fn = with_exponent(shape, a);
      std::vector<double> gaps = spaced_u(1e-12, 1e-12);
      for (const double joint : joints(shape, a))
        gaps.insert(gaps.end(), {joint, std::nextafter(joint, 0), std::nextafter(joint, 1), joint - 1e-3});
      const double rounding = 2e-15 * (3 + a);  // of exp(1 - a u)
      for (const double u : gaps) {
        const ShapeTerms<double> at = fn.eval(u, 1.0);
        const ShapeTerms<long double> exact = minimax_terms(a, u, fn.shape.infinite_at_zero);
        EXPECT_LT(relative(at.b, static_cast<double>(exact.b)), rounding) << shape << " " << a << " " << u;
        EXPECT_LT(relative(at.db, static_cast<double>(exact.db)), rounding) << shape << " " << a << " " << u;
        EXPECT_LT(relative(at.d2b, static_cast<double>(exact.d2b)), rounding)
            << shape << " " << a << " " << u;
      }
    }
  }
}

TEST(Minimax, DerivativesAreThoseOfItsDifferencesOnBothSidesOfEveryJoint) {
  for (const char* shape : shapes) {
    for (const double a : exponents) {
      const BarrierFunction fn = with_exponent(shape, a);
      for (const double joint : {1 / a, 1 - 1.5 / a, 1 - 1 / a, 1 - 0.2 / a}) {
        for (const double u : {joint - 0.1 / a, joint + 0.1 / a}) {
          const double h = 1e-6 / a;
          const ShapeTerms<double> up = fn.eval(u + h, 1.0), down = fn.eval(u - h, 1.0), at = fn.eval(u, 1.0);
          ASSERT_LT(at.db, 0);
          ASSERT_GT(at.d2b, 0);
          EXPECT_LT(relative((up.b - down.b) / (2 * h), at.db), 1e-7) << shape << " " << a << " " << u;
          EXPECT_LT(relative((up.db - down.db) / (2 * h), at.d2b), 1e-7) << shape << " " << a << " " << u;
        }
      }
    }
  }
}

/// Energy, force and stiffness have no jump where the formulas meet; the slope of the stiffness has one.
TEST(Minimax, IsTwiceDifferentiableAtItsJoints) {
  for (const char* shape : shapes) {
    for (const double a : exponents) {
      const BarrierFunction fn = with_exponent(shape, a);
      ASSERT_EQ(fn.shape.joints, joints(shape, a));
      for (const double joint : joints(shape, a)) {
        const double h = 1e-9 / a;
        const ShapeTerms<double> at = fn.eval(joint, 1.0), up = fn.eval(joint + h, 1.0),
                                 down = fn.eval(joint - h, 1.0);
        EXPECT_LT(relative(up.b + down.b, 2 * at.b), 1e-12) << shape << " " << a << " " << joint;
        EXPECT_LT(relative(up.b - down.b, 2 * h * at.db), 1e-5) << shape << " " << a << " " << joint;
        EXPECT_LT(relative(up.db, down.db), 1e-8) << shape << " " << a << " " << joint;
        EXPECT_LT(relative(up.d2b, down.d2b), 1e-8) << shape << " " << a << " " << joint;
        const double wide = 1e-4 / a;
        const double jump =
            (fn.eval(joint - wide, 1.0).d2b + fn.eval(joint + wide, 1.0).d2b - 2 * at.d2b) / wide;
        EXPECT_GT(std::abs(jump), 0.9 * a * at.d2b) << shape << " " << a << " " << joint;
      }
    }
  }
}

TEST(Minimax, IsExponentialBetweenItsJoints) {
  for (const char* shape : shapes) {
    for (const double a : exponents) {
      const BarrierFunction fn = with_exponent(shape, a);
      for (const double share : {0.0, 0.3, 1.0})
        EXPECT_NEAR(rho(fn, 1 / a + share * (1 - 2.5 / a)), a, 1e-13 * a) << shape << " " << a;
      EXPECT_LT(relative(fn.eval(1 / a, 1.0).db, -1), 1e-14) << shape << " " << a;
    }
  }
}

TEST(Minimax, BoundedCarriesItsCapacityAndUnboundedAnyLoad) {
  const double kappa = 350, d_hat = 1.7e-3, capacity = std::exp(1.0) * kappa * d_hat;
  for (const double a : exponents) {
    const BarrierFunction bounded = with_exponent("minimax_bounded", a);
    const Equilibrium within = equilibrium(bounded, kappa, d_hat, 0.999 * capacity);
    ASSERT_FALSE(within.above_capacity) << a;
    EXPECT_LT(relative(*within.capacity, capacity), 1e-12) << a;
    EXPECT_TRUE(equilibrium(bounded, kappa, d_hat, 1.001 * capacity).above_capacity) << a;
    const Equilibrium deep = equilibrium(with_exponent("minimax", a), kappa, d_hat, 1e3 * capacity);
    ASSERT_FALSE(deep.above_capacity) << a;
    EXPECT_LT(relative(*deep.d, d_hat / (a * 1e3 * std::exp(1.0))), 1e-9)
        << a;  // kappa d_hat/(a u) is the load
  }
}

TEST(Minimax, TheExponentIsPartOfTheName) {
  const std::vector<std::string> names = shape_names();
  for (const char* shape : shapes) {
    EXPECT_NE(std::find(names.begin(), names.end(), std::string(shape) + ":A"), names.end());
    const BarrierFunction plain = barrier(shape), seven = barrier((std::string(shape) + ":7").c_str()),
                          other = barrier((std::string(shape) + ":4.8").c_str());
    EXPECT_EQ(other.shape.name, std::string(shape) + ":4.8");
    for (const double u : {0.01, 0.4, 0.8, 0.95}) {
      EXPECT_EQ(plain.eval(u, 1.0).b, seven.eval(u, 1.0).b);
      EXPECT_NE(plain.eval(u, 1.0).b, other.eval(u, 1.0).b);
      const float single = static_cast<float>(u);
      EXPECT_LT(relative(other.eval(single, 1.0F).db, other.eval(static_cast<double>(single), 1.0).db), 1e-5);
    }
  }
}

TEST(Minimax, AnExponentThatIsNotAllowedIsNamed) {
  for (const char* name : {"minimax:2.9", "minimax:41", "minimax_bounded:x", "minimax_bounded:"}) {
    EXPECT_FALSE(find_shape(name)) << name;
    try {
      require_shape(name, "/formulation/shape");
      FAIL() << name;
    } catch (const ConfigError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(":A with an exponent A from 3 to 40, 7 without one"), std::string::npos) << text;
      EXPECT_NE(text.find(name), std::string::npos) << text;
    }
  }
}

}  // namespace
}  // namespace bb::test::minimax_test
