// Friction of one contact: derivatives, curvature, limits of every registered law.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "core/energy/friction.hpp"
#include "core/energy/friction_law.hpp"
#include "core/energy/friction_list.hpp"
#include "tests/energy/energy_cases.hpp"

namespace bb::test::friction_test {
namespace {

constexpr double eps = 1e-3, strength = 3.5;   // m, N
constexpr double kinetic = 0.6, reach = 7e-3;  // 1, m
template <class T>
constexpr SlideScales<T> scales{T(eps), T(kinetic), T(reach)};
const Vec3d normal = Vec3d(2, -1, 2) / 3;
const Vec<double, 4> weights{{0.2, 0.5, 0.3, -1}};

/// What a slide from eps to y costs under a coefficient that falls from 1 to `kinetic` as 1 - (1 - kinetic) t^2 (3 - 2 t).
Long cost_of_falling(Long y) {
  const Long width = Long(reach) - Long(eps), drop = 1 - Long(kinetic), t = (y - Long(eps)) / width;
  if (t >= 1) return width * (1 - drop / 2) + Long(kinetic) * (y - Long(reach));
  return width * (t - drop * (t * t * t - t * t * t * t / 2));
}

/// f0 as its publication states it.
Long closed_form(std::string_view law, Long y) {
  const Long e = eps;
  if (y >= e) return law == "static_kinetic" ? e + cost_of_falling(y) : y;
  return law == "capped" ? (e + y * y / e) / 2 : e / 3 + y * y / e - y * y * y / (3 * e * e);
}

template <class T>
ElementTerms<T, 12> terms_of(const FrictionLaw<T>& law, const Vec<T, 12>& motion) {
  Vec<T, 3> relative = Vec<T, 3>::Zero();
  for (int i = 0; i < 4; ++i) relative += T(weights[i]) * motion.template segment<3>(3 * i);
  const Vec<T, 3> n = normal.cast<T>(), slide = slide_of<T>(relative, n);
  const T y = slide.norm();
  return motion_in_points<T, 4>(friction_terms<T>(slide, y, n, T(strength), law.eval(y, scales<T>)),
                                weights.cast<T>());
}

/// Motions whose slide is `length`, with some motion along the normal that costs nothing.
Vec<double, 12> motion_with(double length) {
  Vec<double, 12> out;
  for (int i = 0; i < 12; ++i) out[i] = std::sin(1.3 * i + 0.2);
  Vec3d relative = Vec3d::Zero();
  for (int i = 0; i < 4; ++i) relative += weights[i] * out.segment<3>(3 * i);
  return out * (length / slide_of<double>(relative, normal).norm());
}

class EveryFrictionLaw : public testing::TestWithParam<double> {};  // slide/eps

TEST_P(EveryFrictionLaw, HasTheDerivativesOfItsClosedFormAndNegativeCurvatureOnlyWhereItsForceFalls) {
  std::size_t judged = 0;
  int seen_falling = 0;
  for (const FrictionLaw<double>& law : friction_laws_in<double>()) {
    const Vec<double, 12> motion = motion_with(GetParam() * eps);
    const auto energy = [&](const VecXl& at) {
      Eigen::Matrix<Long, 3, 1> relative = Eigen::Matrix<Long, 3, 1>::Zero();
      for (int i = 0; i < 4; ++i) relative += Long(weights[i]) * at.segment<3>(3 * i);
      const Eigen::Matrix<Long, 3, 1> n = normal.cast<Long>().normalized();
      return Long(strength) * closed_form(law.name, (relative - n.dot(relative) * n).norm());
    };
    const auto exact = terms_of<double>(law, motion);
    const auto gradient = [&](const VecXl& at) -> VecXl {
      VecXl out(12);
      for (int i = 0; i < 12; ++i) {  // of the closed form, by a difference of its own
        VecXl up = at, down = at;
        const Long h = 1e-8L;
        up[i] += h;
        down[i] -= h;
        out[i] = (energy(up) - energy(down)) / (2 * h);
      }
      return out;
    };
    EXPECT_NEAR(exact.energy, static_cast<double>(energy(motion.cast<Long>())), 1e-15) << law.name;
    EXPECT_LT(gradient_error(energy, motion.cast<Long>(), exact.grad), 1e-9) << law.name;
    EXPECT_LT(jacobian_error(gradient, motion.cast<Long>(), exact.hess), 1e-6) << law.name;
    EXPECT_EQ(exact.hess, exact.hess.transpose());
    EXPECT_GT(exact.grad.norm(), 1e-3);
    const double largest = eigenvalues(MatXd(exact.hess))[11];
    EXPECT_GT(largest, 1);
    const bool falls = law.two_coefficients && GetParam() > 1 && GetParam() < reach / eps;
    if (falls) {
      EXPECT_LT(eigenvalues(MatXd(exact.hess))[0], -0.001 * largest) << law.name;
    } else {
      EXPECT_GT(eigenvalues(MatXd(exact.hess))[0], -1e-13 * largest) << law.name;
      EXPECT_LT(relative_difference(clamped(exact.hess), exact.hess, largest), 1e-13) << law.name;
    }
    seen_falling += falls;

    const auto& in_float = friction_laws_in<float>().require(law.name, "law");
    const auto single = terms_of<float>(in_float, motion.cast<float>());
    EXPECT_LT(relative_difference(single.hess.cast<double>(), exact.hess, largest), 1e-5) << law.name;
    EXPECT_LT(relative_difference(single.grad.cast<double>(), exact.grad, strength), 1e-5) << law.name;
    ++judged;
  }
  EXPECT_GE(judged, 3U);
  EXPECT_EQ(seen_falling, GetParam() == 1.1 || GetParam() == 4.0 || GetParam() == 6.9 ? 1 : 0);
}
INSTANTIATE_TEST_SUITE_P(StickingAndSliding, EveryFrictionLaw,
                         testing::Values(0.01, 0.4, 0.97, 1.1, 4.0, 6.9, 7.5, 50.0));

TEST(FrictionLaws, AreC1AtEpsAndReachTheWholeForceThere) {
  std::size_t judged = 0;
  for (const FrictionLaw<double>& law : friction_laws_in<double>()) {
    const double below = eps * (1 - 1e-9), above = eps * (1 + 1e-9);
    const auto low = law.eval(below, scales<double>), high = law.eval(above, scales<double>);
    EXPECT_NEAR(low.f0, high.f0, 3e-12) << law.name;
    EXPECT_NEAR(below * low.f1_over_y, 1, 3e-9) << law.name;
    EXPECT_NEAR(above * high.f1_over_y, 1, 1e-15) << law.name;
    EXPECT_NEAR(high.f2, 0, 1e-6 / eps) << law.name;
    EXPECT_EQ(high.f2 == 0, !law.two_coefficients) << law.name;
    EXPECT_EQ(law.eval(eps, scales<double>).f0, eps) << law.name;
    ++judged;
  }
  EXPECT_GE(judged, 2U);
}

// From eps on the force falls by a cubic to the kinetic part, where it stays, without a jump of its slope on either side.
TEST(FrictionLaws, OfTwoCoefficientsComeDownToTheKineticOneAndAreSmoothThere) {
  EXPECT_EQ(two_coefficient_laws(), std::vector<std::string>{"static_kinetic"});
  for (const std::string& name : two_coefficient_laws()) {
    const FrictionLaw<double>& law = friction_laws_in<double>().require(name, "law");
    const auto force = [&](double y) { return y * law.eval(y, scales<double>).f1_over_y; };
    double last = 1;
    for (int k = 1; k <= 100; ++k) {
      const double f1 = force(eps + k * (reach - eps) / 100);
      EXPECT_LT(f1, last);
      last = f1;
    }
    EXPECT_NEAR(force((eps + reach) / 2), (1 + kinetic) / 2, 1e-14);  // half way down in the middle
    EXPECT_NEAR(last, kinetic, 1e-14);
    EXPECT_EQ(force(100 * reach), kinetic);
    const auto below = law.eval(reach * (1 - 1e-9), scales<double>), at = law.eval(reach, scales<double>);
    EXPECT_NEAR(below.f0, at.f0, 1e-9 * reach);
    EXPECT_NEAR(below.f2, at.f2, 1e-6 / eps);
    EXPECT_LT(below.f2, 0);
    const SlideScales<double> one{eps, 1, reach};  // one coefficient: Coulomb's
    const auto coulomb = friction_laws_in<double>().require("smoothed_coulomb", "law");
    for (const double y : {0.3 * eps, 2 * eps, 20 * eps}) {
      EXPECT_NEAR(law.eval(y, one).f0, coulomb.eval(y, one).f0, 1e-15 * y);
      EXPECT_NEAR(law.eval(y, one).f1_over_y, coulomb.eval(y, one).f1_over_y, 1e-14 / y);
    }
  }
}

double energy_of(const FrictionLaw<double>& law, const Vec3d& slide) {
  return strength * law.eval(slide.norm(), scales<double>).f0;
}
/// The energy of the slide u + v less that of the quadratic model in u, whose matrix has that share of the secant.
template <class Law>
double above_model(const FrictionLaw<double>& law, const Vec3d& u, const Vec3d& v, double share) {
  const auto at =
      friction_of_slide<double>(u, normal, strength, LawInTerm<Law, double>{scales<double>, share});
  return energy_of(law, u + v) - at.energy - at.grad.dot(v) - v.dot(at.hess * v) / 2;
}

struct SecantCounts {
  int above = 0, below = 0;
};
template <class Law>
void judge_secant(const FrictionLaw<double>& law, SecantCounts& counts) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> direction(-1, 1), size(-2, 2);
  const auto slide = [&] {
    const Vec3d any(direction(random), direction(random), direction(random));
    return Vec3d(slide_of<double>(any, normal).normalized() * (eps * std::pow(10, size(random))));
  };
  for (int k = 0; k < 2000; ++k) {
    const Vec3d u = slide(), v = slide();
    EXPECT_LE(above_model<Law>(law, u, v, 1), 1e-12 * energy_of(law, u + v)) << law.name;
    counts.below += above_model<Law>(law, u, v, 1) < -1e-6 * energy_of(law, u);
    counts.above += above_model<Law>(law, u, v, 0) > 0.1 * energy_of(law, u);
    const LawInTerm<Law, double> exact{scales<double>}, half{scales<double>, 0.5}, whole{scales<double>, 1};
    const double y = u.norm();
    EXPECT_EQ(exact(y).f2,
              std::max(0., law.eval(y, scales<double>).f2));  // the matrix has no negative curvature
    EXPECT_EQ(whole(y).f1_over_y, exact(y).f1_over_y);
    EXPECT_NEAR(half(y).f2, (exact(y).f2 + exact(y).f1_over_y) / 2, 1e-15 * exact(y).f1_over_y);
  }
}

// No slide has an energy above the model with the secant; many have one above that of the second derivatives.
TEST(FrictionLaws, LieNowhereAboveTheModelWithTheirSecant) {
  std::size_t judged = 0;
#define ENTRY(id, doc)                                                                       \
  {                                                                                          \
    SecantCounts counts;                                                                     \
    judge_secant<friction_laws::id>(friction_laws_in<double>().require(#id, "law"), counts); \
    EXPECT_GT(counts.above, 50) << #id;                                                      \
    EXPECT_GT(counts.below, 1000) << #id;                                                    \
    ++judged;                                                                                \
  }
#include "core/energy/friction_laws/registry.inc"
#undef ENTRY
  EXPECT_EQ(judged, friction_law_names().size());
}

// Without a direction the matrix is the same in all of the tangent plane, and grows out of that of small slides.
TEST(FrictionLaws, HaveALimitWithoutSlide) {
  std::size_t judged = 0;
  for (const FrictionLaw<double>& law : friction_laws_in<double>()) {
    const auto rest = terms_of<double>(law, Vec<double, 12>::Zero());
    EXPECT_NEAR(rest.energy, strength * static_cast<double>(closed_form(law.name, 0)), 1e-18) << law.name;
    EXPECT_TRUE(rest.grad.isZero(0)) << law.name;
    const double largest = eigenvalues(MatXd(rest.hess))[11];
    EXPECT_GT(largest, 1e3) << law.name;
    EXPECT_GT(eigenvalues(MatXd(rest.hess))[0], -1e-13 * largest) << law.name;
    for (const double length : {1e-25, 1e-21, 1e-12}) {
      const auto small = terms_of<double>(law, motion_with(length));
      EXPECT_GT(small.grad.norm(), 0) << law.name;
      EXPECT_LT(relative_difference(small.hess, rest.hess, largest), 1e-8) << law.name << length;
    }
    ++judged;
  }
  EXPECT_GE(judged, 2U);
}

}  // namespace
}  // namespace bb::test::friction_test
