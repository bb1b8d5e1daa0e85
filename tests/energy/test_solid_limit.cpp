// Strain limiting of a tetrahedron: derivatives against differences of the closed form, inverted states included, exact zeros, the
// step bound.
#include <gtest/gtest.h>

#include "core/energy/strain_limit.hpp"
#include "tests/energy/energy_cases.hpp"
#include "tests/energy/strain_shapes.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::test::solid_limit_test {
namespace {

constexpr double kappa = 2.5;
const StrainBand<double> band{0.05, 0.1};
const Vec<double, 12> rest_state{{0, 0, 0.1, 1.1, 0.2, 0.1, -0.2, 0.9, 0.2, 0.3, 0.1, 0.8}};

// one, two and three stretches above 1.05, equal and nearly equal ones; inverted from s2 < 0 on, up to s1 + s2 -> 0
const Vec3d upright[] = {{1.1, 0.9, 0.8},     {1.1, 1.07, 1.06},  {1.09, 1.09, 1.09},
                         {1.149, 1.148, 0.4}, {1.12, 1.12, 0.02}, {1.1, 1.1 - 1e-9, 1.06}};
const Vec3d inverted[] = {
    {1.12, 0.3, -0.2}, {1.12, 1.08, -1.07}, {1.1, 1.08, -1.08 + 1e-9}, {1.09, 1.09, -1.09}};

std::vector<Vec3d> all_states() {
  std::vector<Vec3d> out(std::begin(upright), std::end(upright));
  out.insert(out.end(), std::begin(inverted), std::end(inverted));
  return out;
}

/// The rest tetrahedron stretched along turned axes, then rotated.
Vec<double, 12> stretched(const Vec3d& sigma) {
  std::mt19937 random(1);
  const Mat3d map = random_rotation(random) * sigma.asDiagonal() * random_rotation(random);
  Vec<double, 12> x;
  for (int i = 0; i < 4; ++i) x.segment<3>(3 * i) = map * rest_state.segment<3>(3 * i) + Vec3d(1, 2, 3);
  return x;
}

template <class T>
TetrahedronRest<T> rest_tetrahedron() {
  return tetrahedron_rest<T>(Points<T, 4>(rest_state).x);
}

template <class T, class Shape>
ElementTerms<T, 12> terms_at(const VecXl& x, const Shape& shape, Projection projection) {
  const StrainBand<T> b{T(band.onset), T(band.width)};
  const TetrahedronRest<T> rest = rest_tetrahedron<T>();
  const Svd<T, 3, 3> svd = signed_svd(deformation_gradient<3>(rest, Points<T, 4>(x).x));
  StrainShape<T, 3> terms;
  for (int k = 0; k < 3; ++k) {
    const auto [value, db, d2b] = shape(stretch_gap(svd.sigma[k], b), b.width);
    terms.b[k] = value;
    terms.db[k] = db;
    terms.d2b[k] = d2b;
  }
  return strain_limit_terms<3, T>(rest, svd, b, terms, T(kappa), projection);
}

/// S of the eigenvalues of F^T F.
template <class Shape>
Long closed_form(const VecXl& x, const Shape& shape) {
  const Mat<Long, 3, 3> f = deformation_gradient(rest_tetrahedron<Long>(), Points<Long, 4>(x).x);
  const Vec<Long, 3> squares = eigenvalues(MatXl(f.transpose() * f));
  Long sum = 0;
  for (int k = 0; k < 3; ++k) {
    const Long y = Long(band.width) - (std::sqrt(squares[k]) - 1 - Long(band.onset));
    sum += shape(y, Long(band.width)).b;
  }
  return kappa * sum;
}

template <class Shape>
void check_derivatives(const Vec3d& sigma, const Shape& shape) {
  SCOPED_TRACE(std::to_string(sigma[0]) + " " + std::to_string(sigma[1]) + " " + std::to_string(sigma[2]));
  const VecXl x = stretched(sigma).cast<Long>();
  const auto value = [&](const VecXl& at) { return closed_form(at, shape); };
  const auto gradient = [&](const VecXl& at) -> VecXl {
    return terms_at<Long>(at, shape, Projection::none).grad;
  };
  const auto terms = terms_at<double>(x, shape, Projection::none);
  EXPECT_GT(terms.energy, 0);
  EXPECT_NEAR(terms.energy, static_cast<double>(value(x)), 1e-12);
  EXPECT_LT(gradient_error(value, x, terms.grad), 1e-7);
  EXPECT_LT(jacobian_error(gradient, x, terms.hess), 1e-7);
  EXPECT_EQ(terms.hess, terms.hess.transpose());
}

TEST(SolidLimit, derivatives_are_those_of_the_closed_form_inverted_states_included) {
  for (const Vec3d& sigma : all_states()) {
    check_derivatives(sigma, LogStandIn{});
    check_derivatives(sigma, QuadraticStandIn{});
  }
}

/// A sum of convex functions of the stretches that do not fall is convex in F, so that the projection has nothing to take away; with
/// a sign on the last stretch it would not be where F is inverted.
TEST(SolidLimit, it_is_convex_inverted_states_included) {
  for (const Vec3d& sigma : all_states()) {
    SCOPED_TRACE(std::to_string(sigma[0]) + " " + std::to_string(sigma[1]) + " " + std::to_string(sigma[2]));
    const VecXl x = stretched(sigma).cast<Long>();
    const auto exact = terms_at<double>(x, LogStandIn{}, Projection::none);
    const auto psd = terms_at<double>(x, LogStandIn{}, Projection::psd);
    const double scale = exact.hess.cwiseAbs().maxCoeff();
    EXPECT_GT(scale, 0);
    EXPECT_GE(eigenvalues(MatXd(exact.hess))[0], -1e-12 * scale);
    EXPECT_LT(relative_difference(psd.hess, exact.hess, scale), 1e-12);
    EXPECT_EQ(psd.grad, exact.grad);
  }
}

/// It is a function of F^T F.
TEST(SolidLimit, an_inverted_element_has_the_energy_of_its_mirror_image) {
  Vec<double, 12> x = stretched(Vec3d(1.12, 1.08, 1.07)), mirrored = x;
  for (int i = 0; i < 4; ++i) mirrored[3 * i] = -x[3 * i];
  const auto one = terms_at<double>(x.cast<Long>(), LogStandIn{}, Projection::none);
  const auto other = terms_at<double>(mirrored.cast<Long>(), LogStandIn{}, Projection::none);
  EXPECT_GT(one.energy, 0);
  EXPECT_NEAR(other.energy, one.energy, 1e-14);
  for (int i = 0; i < 12; ++i) EXPECT_NEAR(other.grad[i], i % 3 == 0 ? -one.grad[i] : one.grad[i], 1e-12);
}

TEST(SolidLimit, exactly_zero_where_nothing_is_stretched_beyond_the_onset) {
  for (const Vec3d& sigma : {Vec3d(1.04, 0.5, 0.2), Vec3d(1.04, 1.03, -1.02), Vec3d(1, 1, 1)}) {
    const auto terms = terms_at<double>(stretched(sigma).cast<Long>(), LogStandIn{}, Projection::psd);
    EXPECT_EQ(terms.energy, 0);
    EXPECT_TRUE(terms.grad.isZero(0));
    EXPECT_TRUE(terms.hess.isZero(0));
  }
}

template <class T>
void check_step_bound(const Vec<double, 12>& from, const Vec<double, 12>& to) {
  const StrainBand<T> b{T(band.onset), T(band.width)};
  const TetrahedronRest<T> rest = rest_tetrahedron<T>();
  const Points<T, 4> x(from), dx(Vec<double, 12>(to - from));
  const auto within = [&](T alpha) {
    Vec<T, 3> moved[4];
    for (int i = 0; i < 4; ++i) moved[i] = x.x[i] + alpha * dx.x[i];
    const auto sigma = signed_svd(deformation_gradient<3>(rest, moved)).sigma;
    for (int k = 0; k < 3; ++k) {
      if (!(stretch_gap(sigma[k], b) > 0)) return false;
    }
    return true;
  };
  const T alpha = strain_step_bound<3, T>(rest, x.x, dx.x, b);
  ASSERT_GT(alpha, 0);
  ASSERT_LT(alpha, 1);
  EXPECT_TRUE(within(alpha));
  EXPECT_FALSE(within(std::nextafter(alpha, T(1))));
}

TEST(SolidLimit, the_step_bound_is_the_last_feasible_number_through_inversion_too) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Vec<double, 12> from = stretched(Vec3d(1.12, 1.0, 0.9));
  int through = 0;
  for (int trial = 0; trial < 50; ++trial) {
    Vec<double, 12> to = from;
    for (double& coordinate : to) coordinate += uniform(random);
    const auto f = deformation_gradient<3>(rest_tetrahedron<double>(), Points<double, 4>(to).x);
    if (signed_svd(f).sigma[0] < 1.2) continue;
    through += f.determinant() < 0 ? 1 : 0;
    check_step_bound<double>(from, to);
    check_step_bound<float>(from, to);
  }
  EXPECT_GT(through, 3);
}

}  // namespace
}  // namespace bb::test::solid_limit_test
