// Membrane models in F: derivatives against differences and closed forms, exact projection, limits.
#include <gtest/gtest.h>

#include "tests/energy/energy_cases.hpp"

namespace bb::test {
namespace {

constexpr double lame_mu = 3.0, lame_lambda = 2.0;

/// F with the given singular values between a random frame and a random rotation.
template <int R>
Mat<double, R, 2> random_gradient(double s0, double s1, std::mt19937& random) {
  const Eigen::Rotation2Dd v(std::uniform_real_distribution<double>(-3, 3)(random));
  const Eigen::Rotation2Dd u(std::uniform_real_distribution<double>(-3, 3)(random));
  const Mat<double, 2, 2> middle = Vec2d(s0, s1).asDiagonal() * v.toRotationMatrix();
  if constexpr (R == 2) return u.toRotationMatrix() * middle;
  if constexpr (R == 3) return random_rotation(random).leftCols<2>() * middle;
}

struct State {
  double s0, s1;
};
// near rest, stretched, compressed, equal values (also far from rest), nearly equal, thin
const State states[] = {{1.01, 0.99}, {1.8, 1.2}, {0.6, 0.4},    {1, 1},     {1.3, 1.3},
                        {0.7, 0.7},   {1.2, 0.5}, {1 + 1e-9, 1}, {1.4, 0.02}};
// inverted, up to s0 + s1 -> 0
const State inverted[] = {{1.1, -0.6}, {0.8, -0.79}, {0.5, -0.499999}};

template <class Model, int R>
void check_derivatives(const Mat<double, R, 2>& f, double tolerance) {
  using Flat = Vec<Long, 2 * R>;
  const auto value = [](const Flat& x) {
    return Vec<Long, 1>(Model::template value<Long, R>(Mat<Long, R, 2>(x.data()), lame_mu, lame_lambda));
  };
  const auto gradient = [](const Flat& x) {
    const auto terms =
        Model::template terms<Long, R>(Mat<Long, R, 2>(x.data()), lame_mu, lame_lambda, Projection::none);
    return Flat(terms.pk1.reshaped());
  };
  const Flat x = f.reshaped().template cast<Long>();
  const auto terms = Model::template terms<double, R>(f, lame_mu, lame_lambda, Projection::none);

  EXPECT_EQ(terms.psi, (Model::template value<double, R>(f, lame_mu, lame_lambda)));
  if (terms.pk1.cwiseAbs().maxCoeff() > 1e-8) {
    const Mat<double, 1, 2 * R> row = terms.pk1.reshaped().transpose();
    EXPECT_LT((jacobian_error<2 * R, 1>(value, x, row)), tolerance);
  }
  EXPECT_LT((jacobian_error<2 * R, 2 * R>(gradient, x, terms.hess)), tolerance);
  EXPECT_EQ(terms.hess, terms.hess.transpose());
}

template <class Model, int R>
void check_projection(const Mat<double, R, 2>& f) {
  const auto exact = Model::template terms<double, R>(f, lame_mu, lame_lambda, Projection::none);
  const auto psd = Model::template terms<double, R>(f, lame_mu, lame_lambda, Projection::psd);
  const double scale = exact.hess.cwiseAbs().maxCoeff();
  ASSERT_GT(scale, 0);
  EXPECT_LT(relative_difference(psd.hess, clamped<2 * R>(exact.hess), scale), 1e-10);
  EXPECT_EQ(psd.pk1, exact.pk1);
  EXPECT_EQ(psd.hess, psd.hess.transpose());
}

TEST(Membrane, DerivativesAndProjectionInSpace) {
  for_each_model([]<class Model>(std::string_view name) {
    std::mt19937 random(1);
    for (const State& s : states) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(s.s0) + " " + std::to_string(s.s1));
      const auto f = random_gradient<3>(s.s0, s.s1, random);
      check_derivatives<Model, 3>(f, 1e-9);
      check_projection<Model, 3>(f);
    }
  });
}

TEST(Membrane, DerivativesAndProjectionInThePlane) {
  for_each_model([]<class Model>(std::string_view name) {
    std::mt19937 random(2);
    const auto check = [&](const State& s, double tolerance) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(s.s0) + " " + std::to_string(s.s1));
      const auto f = random_gradient<2>(s.s0, s.s1, random);
      check_derivatives<Model, 2>(f, tolerance);
      check_projection<Model, 2>(f);
    };
    for (const State& s : states) check(s, 1e-9);
    for (const State& s : inverted) check(s, 1e-8);
  });
}

TEST(Membrane, SomeStateIsIndefinite) {  // the projection tests would be empty without
  for_each_model([]<class Model>(std::string_view) {
    std::mt19937 random(3);
    const auto f = random_gradient<3>(0.6, 0.4, random);
    const auto exact = Model::template terms<double, 3>(f, lame_mu, lame_lambda, Projection::none);
    const auto psd = Model::template terms<double, 3>(f, lame_mu, lame_lambda, Projection::psd);
    EXPECT_GT((exact.hess - psd.hess).norm(), 0.1);
  });
}

/// psi written in F, without singular values.
template <int R>
Long closed_form(std::string_view name, const Mat<Long, R, 2>& f) {
  const Long mu = lame_mu, lambda = lame_lambda;
  const Mat<Long, 2, 2> c = f.transpose() * f;
  Long j = 0;
  if constexpr (R == 2) j = f(0, 0) * f(1, 1) - f(0, 1) * f(1, 0);
  if constexpr (R == 3) j = Vec<Long, 3>(f.col(0)).cross(Vec<Long, 3>(f.col(1))).norm();
  Long sum = std::sqrt(c.trace() + 2 * j);                                       // s0 + s1
  if constexpr (R == 2) sum = std::hypot(f(0, 0) + f(1, 1), f(1, 0) - f(0, 1));  // without cancellation
  const Long trace = sum - 2;
  const Long arap = mu * (c.trace() - 2 * (trace + 2) + 2);
  const Mat<Long, 2, 2> e = (c - Mat<Long, 2, 2>::Identity()) / 2;
  if (name == "corotational") return arap + lambda / 2 * trace * trace;
  if (name == "arap") return arap;
  if (name == "stvk") return mu * e.squaredNorm() + lambda / 2 * e.trace() * e.trace();
  if (name == "stable_neo_hookean")
    return mu / 2 * (c.trace() - 2) - mu * (j - 1) + lambda / 2 * (j - 1) * (j - 1);
  if (name == "baraff_witkin") {
    const Long u = std::sqrt(c(0, 0)) - 1, v = std::sqrt(c(1, 1)) - 1;
    return mu / 2 * (u * u + v * v) + lambda / 2 * c(0, 1) * c(0, 1);
  }
  return std::numeric_limits<Long>::quiet_NaN();
}

template <class Model, int R>
void check_closed_form(std::string_view name, const State& s, std::mt19937& random) {
  const auto f = random_gradient<R>(s.s0, s.s1, random);
  const Long psi = closed_form<R>(name, f.template cast<Long>());
  if (std::isnan(psi)) return;  // a newcomer: covered by the derivative tests
  SCOPED_TRACE(std::string(name) + " " + std::to_string(s.s0) + " " + std::to_string(s.s1));
  const auto terms = Model::template terms<double, R>(f, lame_mu, lame_lambda, Projection::none);
  EXPECT_NEAR(terms.psi, static_cast<double>(psi), 1e-14 * std::max(1.0, std::abs(terms.psi)));
  if (terms.pk1.cwiseAbs().maxCoeff() < 1e-8) return;
  const Mat<double, 1, 2 * R> row = terms.pk1.reshaped().transpose();
  const auto value = [&](const Vec<Long, 2 * R>& x) {
    return Vec<Long, 1>(closed_form<R>(name, Mat<Long, R, 2>(x.data())));
  };
  EXPECT_LT((jacobian_error<2 * R, 1>(value, f.reshaped().template cast<Long>(), row)), 1e-9);
}

TEST(Membrane, ClosedForms) {
  for_each_model([]<class Model>(std::string_view name) {
    std::mt19937 random(4);
    for (const State& s : states) {
      check_closed_form<Model, 3>(name, s, random);
      check_closed_form<Model, 2>(name, s, random);
    }
    for (const State& s : inverted) check_closed_form<Model, 2>(name, s, random);
  });
}

TEST(Membrane, RestIsAStressFreeMinimum) {
  for_each_model([]<class Model>(std::string_view name) {
    SCOPED_TRACE(name);
    const Mat<double, 3, 2> f = Mat<double, 3, 2>::Identity();
    const auto terms = Model::template terms<double, 3>(f, lame_mu, lame_lambda, Projection::psd);
    EXPECT_EQ(terms.psi, 0);
    EXPECT_TRUE(terms.pk1.isZero(0));
    EXPECT_GT(terms.hess(0, 0), 0);
  });
}

template <class Model>
double uniaxial_stiffness_at_rest() {
  const Mat<double, 3, 2> f = Mat<double, 3, 2>::Identity();
  return Model::template terms<double, 3>(f, lame_mu, lame_lambda, Projection::psd).hess(0, 0);
}

TEST(Membrane, UniaxialStiffnessAtRest) {
  EXPECT_NEAR(uniaxial_stiffness_at_rest<membrane::corotational>(), 2 * lame_mu + lame_lambda, 1e-12);
  EXPECT_NEAR(uniaxial_stiffness_at_rest<membrane::stvk>(), 2 * lame_mu + lame_lambda, 1e-12);
  EXPECT_NEAR(uniaxial_stiffness_at_rest<membrane::arap>(), 2 * lame_mu, 1e-12);
  EXPECT_NEAR(uniaxial_stiffness_at_rest<membrane::stable_neo_hookean>(), lame_mu + lame_lambda, 1e-12);
  EXPECT_NEAR(uniaxial_stiffness_at_rest<membrane::baraff_witkin>(), lame_mu, 1e-12);
}

TEST(Membrane, TwistLimitOfSmoothModelsAtOppositeSingularValues) {
  std::mt19937 random(5);
  const auto f = random_gradient<2>(0.8, -0.8, random);
  check_derivatives<membrane::stvk, 2>(f, 1e-9);
  check_derivatives<membrane::stable_neo_hookean, 2>(f, 1e-9);
}

TEST(Membrane, CollapsedStatesAreFiniteAndPsd) {
  for_each_model([]<class Model>(std::string_view name) {
    std::mt19937 random(6);
    Mat<double, 3, 2> line = Mat<double, 3, 2>::Zero();
    line(0, 0) = 1.5;
    for (const Mat<double, 3, 2>& f : {Mat<double, 3, 2>(Mat<double, 3, 2>::Zero()), line}) {
      SCOPED_TRACE(name);
      const auto terms = Model::template terms<double, 3>(f, lame_mu, lame_lambda, Projection::psd);
      EXPECT_GT(terms.psi, 0);
      ASSERT_TRUE(terms.pk1.allFinite() && terms.hess.allFinite());
      const Eigen::SelfAdjointEigenSolver<Mat<double, 6, 6>> solver(terms.hess);
      EXPECT_GE(solver.eigenvalues()[0], -1e-12 * solver.eigenvalues()[5]);
    }
    const Mat<double, 2, 2> opposite = Vec2d(0.7, -0.7).asDiagonal();
    const auto planar = Model::template terms<double, 2>(opposite, lame_mu, lame_lambda, Projection::psd);
    EXPECT_TRUE(planar.pk1.allFinite() && planar.hess.allFinite());
  });
}

TEST(Membrane, FloatAgreesWithDouble) {
  for_each_model([]<class Model>(std::string_view name) {
    std::mt19937 random(7);
    for (const State& s : {State{1.01, 0.99}, State{1.8, 1.2}, State{0.6, 0.4}, State{1, 1}}) {
      SCOPED_TRACE(name);
      const auto f = random_gradient<3>(s.s0, s.s1, random);
      const auto exact = Model::template terms<double, 3>(f, lame_mu, lame_lambda, Projection::psd);
      const auto single =
          Model::template terms<float, 3>(f.template cast<float>(), lame_mu, lame_lambda, Projection::psd);
      const double scale = lame_mu + lame_lambda;  // stvk in compression projects to the zero matrix
      EXPECT_NEAR(static_cast<double>(single.psi), exact.psi, 1e-5 * exact.psi + 1e-7);
      EXPECT_LT(relative_difference(single.pk1.template cast<double>(), exact.pk1, scale), 1e-5);
      EXPECT_LT(relative_difference(single.hess.template cast<double>(), exact.hess, scale), 1e-5);
    }
  });
}

}  // namespace
}  // namespace bb::test
