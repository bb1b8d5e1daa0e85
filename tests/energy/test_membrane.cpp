// Membrane models in F: derivatives against differences and closed forms, exact projection, limits.
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "tests/energy/energy_cases.hpp"

namespace bb::test::membrane_test {
namespace {

constexpr double lame_mu = 3.0, lame_lambda = 2.0;

struct Terms {
  Long psi;
  VecXl pk1;   // dpsi/dF, column-stacked as F is
  MatXd hess;  // d2psi/dF2
};

/// A model in one scalar; F comes and psi and dpsi/dF go as Long, which holds every float and double.
struct Density {
  Long (*value)(const VecXl& f);
  Terms (*terms)(const VecXl& f, Projection projection);
};

template <class Model, class T, int R>
Density density() {
  const auto value = [](const VecXl& f) -> Long {
    return Model::template value<T, R>(unstacked<R, 2>(f).template cast<T>(), lame_mu, lame_lambda);
  };
  const auto terms = [](const VecXl& f, Projection projection) {
    const auto at =
        Model::template terms<T, R>(unstacked<R, 2>(f).template cast<T>(), lame_mu, lame_lambda, projection);
    return Terms{at.psi, stacked(at.pk1).template cast<Long>(), at.hess.template cast<double>()};
  };
  return {value, terms};
}

/// A line of registry.inc; `rows` of F: 3 in space, 2 in the plane.
struct Model {
  std::string name;
  int rows;
  Density in_double, in_long;
};

template <int R>
const std::vector<Model>& models_of() {
  static const std::vector<Model> all = [] {
    std::vector<Model> list;
    for_each_model([&]<class M>(std::string_view name) {
      list.push_back({std::string(name), R, density<M, double, R>(), density<M, Long, R>()});
    });
    return list;
  }();
  return all;
}
const std::vector<Model>& models(int rows) { return rows == 3 ? models_of<3>() : models_of<2>(); }

const Model& model(std::string_view name, int rows) {
  for (const Model& m : models(rows)) {
    if (m.name == name) return m;
  }
  throw std::invalid_argument(std::string(name));
}

/// F with the given singular values between a random frame and a random rotation.
VecXl random_gradient(int rows, double s0, double s1, std::mt19937& random) {
  const Eigen::Rotation2Dd v(std::uniform_real_distribution<double>(-3, 3)(random));
  const Eigen::Rotation2Dd u(std::uniform_real_distribution<double>(-3, 3)(random));
  const Mat<double, 2, 2> middle = Vec2d(s0, s1).asDiagonal() * v.toRotationMatrix();
  if (rows == 2) return stacked(u.toRotationMatrix() * middle).cast<Long>();
  return stacked(random_rotation(random).leftCols<2>() * middle).cast<Long>();
}

struct State {
  double s0, s1;
};
// near rest, stretched, compressed, equal values (also far from rest), nearly equal, thin
const State states[] = {{1.01, 0.99}, {1.8, 1.2}, {0.6, 0.4},    {1, 1},     {1.3, 1.3},
                        {0.7, 0.7},   {1.2, 0.5}, {1 + 1e-9, 1}, {1.4, 0.02}};
// inverted, up to s0 + s1 -> 0
const State inverted[] = {{1.1, -0.6}, {0.8, -0.79}, {0.5, -0.499999}};

void check_derivatives(const Model& m, const VecXl& f, double tolerance) {
  const Terms terms = m.in_double.terms(f, Projection::none);
  EXPECT_EQ(terms.psi, m.in_double.value(f));
  if (terms.pk1.cwiseAbs().maxCoeff() > 1e-8) {
    EXPECT_LT(gradient_error(m.in_long.value, f, terms.pk1.cast<double>()), tolerance);
  }
  const auto gradient = [&](const VecXl& x) { return m.in_long.terms(x, Projection::none).pk1; };
  EXPECT_LT(jacobian_error(gradient, f, terms.hess), tolerance);
  EXPECT_EQ(terms.hess, terms.hess.transpose());
}

void check_projection(const Model& m, const VecXl& f) {
  const Terms exact = m.in_double.terms(f, Projection::none);
  const Terms psd = m.in_double.terms(f, Projection::psd);
  const double scale = exact.hess.cwiseAbs().maxCoeff();
  ASSERT_GT(scale, 0);
  EXPECT_LT(relative_difference(psd.hess, clamped(exact.hess), scale), 1e-10);
  EXPECT_EQ(psd.pk1, exact.pk1);
  EXPECT_EQ(psd.hess, psd.hess.transpose());
}

std::string trace(const Model& m, const State& s) {
  return m.name + " " + std::to_string(s.s0) + " " + std::to_string(s.s1);
}

TEST(Membrane, DerivativesAndProjectionInSpace) {
  for (const Model& m : models(3)) {
    std::mt19937 random(1);
    for (const State& s : states) {
      SCOPED_TRACE(trace(m, s));
      const VecXl f = random_gradient(3, s.s0, s.s1, random);
      check_derivatives(m, f, 1e-9);
      check_projection(m, f);
    }
  }
}

TEST(Membrane, DerivativesAndProjectionInThePlane) {
  for (const Model& m : models(2)) {
    std::mt19937 random(2);
    const auto check = [&](const State& s, double tolerance) {
      SCOPED_TRACE(trace(m, s));
      const VecXl f = random_gradient(2, s.s0, s.s1, random);
      check_derivatives(m, f, tolerance);
      check_projection(m, f);
    };
    for (const State& s : states) check(s, 1e-9);
    for (const State& s : inverted) check(s, 1e-8);
  }
}

TEST(Membrane, SomeStateIsIndefinite) {  // the projection tests would be empty without
  for (const Model& m : models(3)) {
    std::mt19937 random(3);
    const VecXl f = random_gradient(3, 0.6, 0.4, random);
    const Terms exact = m.in_double.terms(f, Projection::none);
    const Terms psd = m.in_double.terms(f, Projection::psd);
    EXPECT_GT((exact.hess - psd.hess).norm(), 0.1);
  }
}

/// psi written in F, without singular values.
Long closed_form(const Model& m, const VecXl& f) {
  const Long mu = lame_mu, lambda = lame_lambda;
  const VecXl f0 = f.head(m.rows), f1 = f.tail(m.rows);
  Mat<Long, 2, 2> c;
  c << f0.dot(f0), f0.dot(f1), f1.dot(f0), f1.dot(f1);
  const bool planar = m.rows == 2;
  const Long j = planar ? f0[0] * f1[1] - f0[1] * f1[0] : Vec<Long, 3>(f0).cross(Vec<Long, 3>(f1)).norm();
  const Long sum = planar ? std::hypot(f0[0] + f1[1], f0[1] - f1[0])  // s0 + s1, without cancellation
                          : std::sqrt(c.trace() + 2 * j);
  const Long arap = mu * (c.trace() - 2 * sum + 2);
  const Mat<Long, 2, 2> e = (c - Mat<Long, 2, 2>::Identity()) / 2;
  if (m.name == "corotational") return arap + lambda / 2 * (sum - 2) * (sum - 2);
  if (m.name == "arap") return arap;
  if (m.name == "stvk") return mu * e.squaredNorm() + lambda / 2 * e.trace() * e.trace();
  if (m.name == "stable_neo_hookean")
    return mu / 2 * (c.trace() - 2) - mu * (j - 1) + lambda / 2 * (j - 1) * (j - 1);
  if (m.name == "baraff_witkin") {
    const Long u = std::sqrt(c(0, 0)) - 1, v = std::sqrt(c(1, 1)) - 1;
    return mu / 2 * (u * u + v * v) + lambda / 2 * c(0, 1) * c(0, 1);
  }
  return std::numeric_limits<Long>::quiet_NaN();
}

void check_closed_form(const Model& m, const State& s, std::mt19937& random) {
  const VecXl f = random_gradient(m.rows, s.s0, s.s1, random);
  const Long psi = closed_form(m, f);
  if (std::isnan(psi)) return;  // a newcomer: covered by the derivative tests
  SCOPED_TRACE(trace(m, s));
  const Terms terms = m.in_double.terms(f, Projection::none);
  EXPECT_LE(std::abs(terms.psi - psi), 1e-14 * std::max(1.0L, std::abs(terms.psi)));
  if (terms.pk1.cwiseAbs().maxCoeff() < 1e-8) return;
  const auto value = [&](const VecXl& x) { return closed_form(m, x); };
  EXPECT_LT(gradient_error(value, f, terms.pk1.cast<double>()), 1e-9);
}

TEST(Membrane, ClosedForms) {
  for (std::size_t k = 0; k < models(3).size(); ++k) {
    std::mt19937 random(4);
    for (const State& s : states) {
      check_closed_form(models(3)[k], s, random);
      check_closed_form(models(2)[k], s, random);
    }
    for (const State& s : inverted) check_closed_form(models(2)[k], s, random);
  }
}

const VecXl identity = stacked(Mat<Long, 3, 2>::Identity());

TEST(Membrane, RestIsAStressFreeMinimum) {
  for (const Model& m : models(3)) {
    SCOPED_TRACE(m.name);
    const Terms terms = m.in_double.terms(identity, Projection::psd);
    EXPECT_EQ(terms.psi, 0);
    EXPECT_TRUE(terms.pk1.isZero(0));
    EXPECT_GT(terms.hess(0, 0), 0);
  }
}

double uniaxial_stiffness_at_rest(std::string_view name) {
  return static_cast<double>(model(name, 3).in_double.terms(identity, Projection::psd).hess(0, 0));
}

TEST(Membrane, UniaxialStiffnessAtRest) {
  EXPECT_NEAR(uniaxial_stiffness_at_rest("corotational"), 2 * lame_mu + lame_lambda, 1e-12);
  EXPECT_NEAR(uniaxial_stiffness_at_rest("stvk"), 2 * lame_mu + lame_lambda, 1e-12);
  EXPECT_NEAR(uniaxial_stiffness_at_rest("arap"), 2 * lame_mu, 1e-12);
  EXPECT_NEAR(uniaxial_stiffness_at_rest("stable_neo_hookean"), lame_mu + lame_lambda, 1e-12);
  EXPECT_NEAR(uniaxial_stiffness_at_rest("baraff_witkin"), lame_mu, 1e-12);
}

TEST(Membrane, TwistLimitOfSmoothModelsAtOppositeSingularValues) {
  std::mt19937 random(5);
  const VecXl f = random_gradient(2, 0.8, -0.8, random);
  check_derivatives(model("stvk", 2), f, 1e-9);
  check_derivatives(model("stable_neo_hookean", 2), f, 1e-9);
}

TEST(Membrane, CollapsedStatesAreFiniteAndPsd) {
  const VecXl point = VecXl::Zero(6), line = 1.5L * VecXl::Unit(6, 0);
  for (const Model& m : models(3)) {
    for (const VecXl& f : {point, line}) {
      SCOPED_TRACE(m.name);
      const Terms terms = m.in_double.terms(f, Projection::psd);
      EXPECT_GT(terms.psi, 0);
      ASSERT_TRUE(terms.pk1.allFinite() && terms.hess.allFinite());
      const VecXd values = eigenvalues(terms.hess);
      EXPECT_GE(values[0], -1e-12 * values[5]);
    }
  }
  const VecXl opposite{{0.7L, 0, 0, -0.7L}};
  for (const Model& m : models(2)) {
    SCOPED_TRACE(m.name);
    const Terms terms = m.in_double.terms(opposite, Projection::psd);
    EXPECT_TRUE(terms.pk1.allFinite() && terms.hess.allFinite());
  }
}

void check_float(std::string_view name, const Density& in_double, const Density& in_float) {
  std::mt19937 random(7);
  for (const State& s : {State{1.01, 0.99}, State{1.8, 1.2}, State{0.6, 0.4}, State{1, 1}}) {
    SCOPED_TRACE(name);
    const VecXl f = random_gradient(3, s.s0, s.s1, random);
    const Terms exact = in_double.terms(f, Projection::psd), single = in_float.terms(f, Projection::psd);
    const double scale = lame_mu + lame_lambda;  // stvk in compression projects to the zero matrix
    EXPECT_LE(std::abs(single.psi - exact.psi), 1e-5 * exact.psi + 1e-7);
    EXPECT_LT(relative_difference(single.pk1.cast<double>(), exact.pk1.cast<double>(), scale), 1e-5);
    EXPECT_LT(relative_difference(single.hess, exact.hess, scale), 1e-5);
  }
}

TEST(Membrane, FloatAgreesWithDouble) {
  for_each_model([]<class M>(std::string_view name) {
    check_float(name, density<M, double, 3>(), density<M, float, 3>());
  });
}

}  // namespace
}  // namespace bb::test::membrane_test
