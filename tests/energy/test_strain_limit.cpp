// Strain limiting of one triangle: derivatives through a stand-in shape, exact zeros, the exact step bound.
#include <gtest/gtest.h>

#include "core/energy/strain_limit.hpp"
#include "core/energy/strain_stiffness.hpp"
#include "tests/energy/energy_cases.hpp"
#include "tests/energy/strain_shapes.hpp"

namespace bb::test::strain_limit_test {
namespace {

constexpr double kappa = 2.5;
const StrainBand<double> band{0.05, 0.1};

const Vec<double, 9> rest_state{{0, 0, 0, 1, 0, 0, 0.2, 0.9, 0}};

template <class T>
TriangleRest<T> rest_triangle() {
  const Points<T, 3> p(rest_state);
  return triangle_rest<T>(p.x, Vec<T, 3>(p.x[1] - p.x[0]));
}

/// The rest triangle stretched by s0 and s1 along turned axes, then rotated.
Vec<double, 9> stretched(double s0, double s1) {
  std::mt19937 random(1);
  const Mat3d turn = Eigen::AngleAxisd(0.4, Vec3d::UnitZ()).toRotationMatrix();
  const Mat3d map = random_rotation(random) * turn * Vec3d(s0, s1, 1).asDiagonal() * turn.transpose();
  Vec<double, 9> x;
  for (int i = 0; i < 3; ++i) x.segment<3>(3 * i) = map * rest_state.segment<3>(3 * i) + Vec3d(1, 2, 3);
  return x;
}

template <class T, class Shape>
ElementTerms<T, 9> terms_at(const Vec<T, 9>& x, const Shape& shape, Projection projection) {
  const TriangleRest<T> rest = rest_triangle<T>();
  const StrainBand<T> b{T(band.onset), T(band.width)};
  const Svd<T, 3, 2> svd = signed_svd(deformation_gradient<3>(rest, Points<T, 3>(x).x));
  StrainShape<T> terms;
  for (int k = 0; k < 2; ++k) {
    const auto [value, db, d2b] = shape(strain_gap(svd.sigma[k], b), b.width);
    terms.b[k] = value;
    terms.db[k] = db;
    terms.d2b[k] = d2b;
  }
  return strain_limit_terms<3, T>(rest, svd, b, terms, T(kappa), projection);
}

template <class Shape>
void check_derivatives(const Vec<double, 9>& state, const Shape& shape) {
  const auto value = [&](const VecXl& x) { return terms_at<Long>(x, shape, Projection::none).energy; };
  const auto gradient = [&](const VecXl& x) { return terms_at<Long>(x, shape, Projection::none).grad; };
  const auto terms = terms_at<double>(state, shape, Projection::none);
  EXPECT_GT(terms.energy, 0);
  EXPECT_LT(gradient_error(value, state.cast<Long>(), terms.grad), 1e-8);
  EXPECT_LT(jacobian_error(gradient, state.cast<Long>(), terms.hess), 1e-8);
  EXPECT_EQ(terms.hess, terms.hess.transpose());
}

const double active_states[][2] = {{1.1, 0.9}, {1.1, 1.07}, {1.09, 1.09}, {1.149, 1.148}, {1.12, 0.3}};

TEST(StrainLimit, DerivativesAcrossShapes) {
  for (const auto& [s0, s1] : active_states) {
    SCOPED_TRACE(std::to_string(s0) + " " + std::to_string(s1));
    check_derivatives(stretched(s0, s1), QuadraticStandIn{});
    check_derivatives(stretched(s0, s1), LogStandIn{});
  }
}

TEST(StrainLimit, EnergyIsTheShapeAtTheGaps) {
  const auto terms = terms_at<double>(stretched(1.1, 1.07), QuadraticStandIn{}, Projection::none);
  const double y0 = 0.1 - (0.1 - 0.05), y1 = 0.1 - (0.07 - 0.05);
  EXPECT_NEAR(terms.energy, kappa * ((y0 - 0.1) * (y0 - 0.1) + (y1 - 0.1) * (y1 - 0.1)), 1e-14);
}

TEST(StrainLimit, ProjectionIsThatOfTheHessianInF) {
  int changed = 0;
  for (const auto& [s0, s1] : active_states) {
    const TriangleRest<double> rest = rest_triangle<double>();
    const auto svd = signed_svd(deformation_gradient<3>(rest, Points<double, 3>(stretched(s0, s1)).x));
    StrainShape<double> shape;
    for (int k = 0; k < 2; ++k) {
      const auto [value, db, d2b] = LogStandIn{}(strain_gap(svd.sigma[k], band), band.width);
      shape.b[k] = value;
      shape.db[k] = db;
      shape.d2b[k] = d2b;
    }
    const auto density = strain_limit_density<double, 2>(svd.sigma, band, shape, kappa);
    // a concave stand-in for a dip in the shape: only the projection sees it
    Density2<double> bent = density;
    bent.d2psi(1, 1) -= 1.0;
    const auto exact = isotropic_terms<double, 3>(svd, bent, Projection::none);
    const auto psd = isotropic_terms<double, 3>(svd, bent, Projection::psd);
    const double scale = exact.hess.cwiseAbs().maxCoeff();
    EXPECT_LT(relative_difference(psd.hess, clamped(exact.hess), scale), 1e-10);
    changed += (exact.hess - psd.hess).norm() > 1e-3 * scale ? 1 : 0;
  }
  EXPECT_GT(changed, 0);
}

TEST(StrainLimit, ExactlyZeroWhereInactive) {
  for (const auto& state : {stretched(1.04, 0.5), stretched(1.0499, 1.0499), rest_state}) {
    const auto terms = terms_at<double>(state, LogStandIn{}, Projection::psd);
    EXPECT_EQ(terms.energy, 0);
    EXPECT_TRUE(terms.grad.isZero(0));
    EXPECT_TRUE(terms.hess.isZero(0));
  }
}

TEST(StrainLimit, FloatAgreesWithDouble) {
  const auto exact = terms_at<double>(stretched(1.1, 1.07), QuadraticStandIn{}, Projection::psd);
  const auto single =
      terms_at<float>(stretched(1.1, 1.07).cast<float>(), QuadraticStandIn{}, Projection::psd);
  const double scale = exact.hess.cwiseAbs().maxCoeff();
  EXPECT_LT(relative_difference(single.grad.cast<double>(), exact.grad, scale), 1e-4);
  EXPECT_LT(relative_difference(single.hess.cast<double>(), exact.hess, scale), 1e-4);
}

template <class T>
void check_step_bound(const Vec<double, 9>& from, const Vec<double, 9>& to) {
  const StrainBand<T> b{T(band.onset), T(band.width)};
  const TriangleRest<T> rest = rest_triangle<T>();
  const Points<T, 3> x(from), dx(Vec<double, 9>(to - from));
  const auto within = [&](T alpha) {
    const Vec<T, 3> moved[3] = {x.x[0] + alpha * dx.x[0], x.x[1] + alpha * dx.x[1], x.x[2] + alpha * dx.x[2]};
    const auto sigma = signed_svd(deformation_gradient<3>(rest, moved)).sigma;
    return strain_gap(sigma[0], b) > 0 && strain_gap(sigma[1], b) > 0;
  };
  const T alpha = strain_step_bound<3, T>(rest, x.x, dx.x, b);
  ASSERT_GT(alpha, 0);
  ASSERT_LT(alpha, 1);
  EXPECT_TRUE(within(alpha));
  EXPECT_FALSE(within(std::nextafter(alpha, T(1))));
}

TEST(StrainLimit, StepBoundIsTheLastFeasibleNumber) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    Vec<double, 9> to = stretched(1.12, 1.0);
    for (double& coordinate : to) coordinate += uniform(random);
    const Points<double, 3> end(to);
    const auto sigma = signed_svd(deformation_gradient<3>(rest_triangle<double>(), end.x)).sigma;
    if (sigma[0] < 1.2) continue;
    check_step_bound<double>(stretched(1.12, 1.0), to);
    check_step_bound<float>(stretched(1.12, 1.0), to);
  }
  check_step_bound<double>(rest_state, 1e6 * stretched(1.3, 0.2));
}

// Where ACCD would stop: at the park level, or at half the start gap of an element already below it.
TEST(StrainLimit, StepBoundKeepsTheParkLevel) {
  const TriangleRest<double> rest = rest_triangle<double>();
  const double park = 1e-3;
  const auto end_gap = [&](const Vec<double, 9>& from, const Vec<double, 9>& to) {
    const Points<double, 3> x(from), dx(Vec<double, 9>(to - from));
    const double alpha = strain_step_bound<3>(rest, x.x, dx.x, band, 1.0, park);
    EXPECT_LT(alpha, 1);
    const Points<double, 3> end(Vec<double, 9>(from + alpha * (to - from)));
    return smallest_strain_gap<3>(rest, end.x, band);
  };
  EXPECT_NEAR(end_gap(rest_state, stretched(1.3, 1)), park * band.width, 1e-15);
  const Vec<double, 9> close = stretched(1 + band.onset + band.width * (1 - 1e-4), 1);
  EXPECT_NEAR(end_gap(close, stretched(1.3, 1)), 0.5e-4 * band.width, 1e-15);
}

TEST(StrainLimit, StepBoundOfFreeAndOfInfeasibleSteps) {
  const TriangleRest<double> rest = rest_triangle<double>();
  const auto bound = [&](const Vec<double, 9>& from, const Vec<double, 9>& to) {
    const Points<double, 3> x(from), dx(Vec<double, 9>(to - from));
    return strain_step_bound<3>(rest, x.x, dx.x, band);
  };
  EXPECT_EQ(bound(rest_state, stretched(1.14, 0.2)), 1);
  EXPECT_EQ(bound(stretched(1.151, 1), stretched(1.3, 1)), 0);
  EXPECT_EQ(bound(stretched(1.151, 1), stretched(1.0, 1)), 1);
}

TEST(StrainStiffness, SumsMatchHandComputedTerms) {
  // equilateral-like hand case: points at (+-1, 0, 0) and (0, 3, 0): centroid (0, 1, 0)
  const Vec3d x[3] = {{-1, 0, 0}, {1, 0, 0}, {0, 3, 0}};
  Mat<double, 9, 9> h = Mat<double, 9, 9>::Identity();
  h(0, 3) = h(3, 0) = 0.5;  // couples x of points 0 and 1: w_0x w_1x = -1
  const auto hessian = [&] { return h; };
  const ElementSums<double> sums = element_sums<double>(x, Vec3d(2, 3, 4), 6, 0.7, hessian, true);
  EXPECT_NEAR(sums.elastic, 2 + 2 + 4 - 1, 1e-14);
  EXPECT_NEAR(sums.mass, 2 * 2 + 3 * 2 + 4 * 4, 1e-14);
  EXPECT_EQ(sums.element_mass, 6);
  EXPECT_EQ(sums.measure, 0.7);
  EXPECT_EQ(element_sums<double>(x, Vec3d(2, 3, 4), 6, 0.7, hessian, false).elastic, 0);
}

}  // namespace
}  // namespace bb::test::strain_limit_test
