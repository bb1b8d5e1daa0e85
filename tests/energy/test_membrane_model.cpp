// Membrane triangles by name: gradient and Hessian in the nine coordinates, rest frames, invariances.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/energy/membrane_model.hpp"
#include "tests/energy/energy_cases.hpp"

namespace bb::test::membrane_model_test {
namespace {

constexpr double lame_mu = 3.0, lame_lambda = 2.0;

// Rest triangle (obtuse at point 0) and a deformed state; planar scenes read x and y only.
const Vec<double, 9> rest_state{{0, 0, 0.3, 1.1, 0.2, 0.1, -0.3, 0.7, 0.2}};
const Vec<double, 9> deformed_state{{0.1, 0.2, 0.3, 1.2, -0.1, 0.6, -0.2, 0.5, 0.1}};

template <class T>
TriangleRest<T> rest_of(const Vec<double, 9>& stacked, bool planar) {
  const Points<T, 3> p(stacked);
  const Vec<T, 3> warp = p.x[1] - p.x[0];
  return planar ? planar_triangle_rest<T>(p.x, warp) : triangle_rest<T>(p.x, warp);
}

template <class T>
ElementTerms<T, 9> terms_of(const MembraneModel<T>& model, bool planar, const Vec<T, 9>& x,
                            Projection projection) {
  const TriangleRest<T> rest = rest_of<T>(rest_state, planar);
  const Points<T, 3> p(x);
  return (planar ? model.terms_planar : model.terms)(rest, p.x, T(lame_mu), T(lame_lambda), projection);
}

void check_derivatives(std::string_view name, bool planar, MembraneModel<Long>::Value value_at,
                       MembraneModel<Long>::Terms terms_at) {
  SCOPED_TRACE(std::string(name) + (planar ? " in the plane" : " in space"));
  const TriangleRest<Long> rest = rest_of<Long>(rest_state, planar);
  const VecXl x = deformed_state.cast<Long>();
  const auto value = [&](const VecXl& at) {
    return value_at(rest, Points<Long, 3>(at).x, lame_mu, lame_lambda);
  };
  const auto gradient = [&](const VecXl& at) {
    return terms_at(rest, Points<Long, 3>(at).x, lame_mu, lame_lambda, Projection::none).grad;
  };
  const auto* model = membrane_models<double>().find(name);
  ASSERT_NE(model, nullptr);
  const auto terms = terms_of<double>(*model, planar, deformed_state, Projection::none);
  EXPECT_LT(gradient_error(value, x, terms.grad), 1e-10);
  EXPECT_LT(jacobian_error(gradient, x, terms.hess), 1e-10);
  EXPECT_EQ(terms.hess, terms.hess.transpose());
  EXPECT_NEAR(terms.energy, static_cast<double>(value(x)), 1e-14);
}

TEST(MembraneModel, DerivativesInTheNineCoordinates) {
  for_each_model([]<class Model>(std::string_view name) {
    check_derivatives(name, false, &membrane_value<Model, 3, Long>, &membrane_terms<Model, 3, Long>);
    check_derivatives(name, true, &membrane_value<Model, 2, Long>, &membrane_terms<Model, 2, Long>);
  });
}

TEST(MembraneModel, NoForceOnTheWholeAndNoTorque) {
  for (const auto& model : membrane_models<double>()) {
    SCOPED_TRACE(model.name);
    for (const bool planar : {false, true}) {
      const auto terms = terms_of<double>(model, planar, deformed_state, Projection::psd);
      Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
      for (int i = 0; i < 3; ++i) {
        const Vec3d f = terms.grad.segment<3>(3 * i), x = deformed_state.segment<3>(3 * i);
        force += f;
        torque += x.cross(f);
        if (planar) {
          EXPECT_EQ(f[2], 0);
          EXPECT_TRUE(terms.hess.row(3 * i + 2).isZero(0));
        }
      }
      EXPECT_GT(terms.grad.norm(), 0.01);
      EXPECT_LT(force.norm(), 1e-14);
      EXPECT_LT(planar ? std::abs(torque[2]) : torque.norm(), 1e-14);
    }
  }
}

TEST(MembraneModel, EnergyDoesNotSeeRigidMotion) {
  std::mt19937 random(1);
  const Mat3d rotation = random_rotation(random);
  Vec<double, 9> moved;
  for (int i = 0; i < 3; ++i) {
    moved.segment<3>(3 * i) = rotation * deformed_state.segment<3>(3 * i) + Vec3d(3, -2, 1);
  }
  for (const auto& model : membrane_models<double>()) {
    SCOPED_TRACE(model.name);
    const auto before = terms_of<double>(model, false, deformed_state, Projection::psd);
    const auto after = terms_of<double>(model, false, moved, Projection::psd);
    EXPECT_GT(before.energy, 0.01);
    EXPECT_NEAR(after.energy, before.energy, 1e-14);
    EXPECT_NEAR(after.hess.norm(), before.hess.norm(), 1e-12);
    EXPECT_NEAR(after.grad.norm(), before.grad.norm(), 1e-13);
  }
}

TEST(MembraneModel, RestEnergyIsZeroAndClockwisePlanarTrianglesAreNotInverted) {
  Vec<double, 9> clockwise = rest_state;
  clockwise.segment<3>(3) = rest_state.segment<3>(6);
  clockwise.segment<3>(6) = rest_state.segment<3>(3);
  const Points<double, 3> p(clockwise);
  const auto rest = rest_of<double>(clockwise, true);
  EXPECT_NEAR(deformation_gradient<2>(rest, p.x).determinant(), 1, 1e-14);
  EXPECT_NEAR(rest.area, 0.5 * std::abs(1.1 * 0.7 + 0.2 * 0.3), 1e-15);
  for (const auto& model : membrane_models<double>()) {
    SCOPED_TRACE(model.name);
    EXPECT_LT(model.value_planar(rest, p.x, lame_mu, lame_lambda), 1e-28);
    EXPECT_LT(model.value(rest_of<double>(clockwise, false), p.x, lame_mu, lame_lambda), 1e-28);
  }
}

TEST(MembraneModel, WarpIsTheFirstAxis) {
  const Points<double, 3> p(rest_state);
  const Vec3d warp(0.2, 1, 5);  // its part in the triangle's plane counts
  const auto rest = triangle_rest<double>(p.x, warp);
  const Mat<double, 3, 2> f = deformation_gradient<3>(rest, p.x);
  const Vec3d n = (p.x[1] - p.x[0]).cross(p.x[2] - p.x[0]).normalized();
  EXPECT_LT((f.col(0) - (warp - n.dot(warp) * n).normalized()).norm(), 1e-14);
  EXPECT_LT((f.transpose() * f - Mat<double, 2, 2>::Identity()).norm(), 1e-14);
  const auto default_axis = rest_of<double>(rest_state, false);
  EXPECT_LT((deformation_gradient<3>(default_axis, p.x).col(0) - (p.x[1] - p.x[0]).normalized()).norm(),
            1e-14);
}

TEST(MembraneModel, FloatRunsTheSameFunction) {
  for (const auto& model : membrane_models<float>()) {
    SCOPED_TRACE(model.name);
    const auto* reference = membrane_models<double>().find(model.name);
    ASSERT_NE(reference, nullptr);
    for (const bool planar : {false, true}) {
      const auto exact = terms_of<double>(*reference, planar, deformed_state, Projection::psd);
      const auto single = terms_of<float>(model, planar, deformed_state.cast<float>(), Projection::psd);
      const double scale = exact.hess.cwiseAbs().maxCoeff();
      EXPECT_NEAR(static_cast<double>(single.energy), exact.energy, 1e-5 * exact.energy);
      EXPECT_LT(relative_difference(single.grad.cast<double>(), exact.grad, scale), 1e-5);
      EXPECT_LT(relative_difference(single.hess.cast<double>(), exact.hess, scale), 1e-5);
    }
  }
}

TEST(MembraneModel, UnknownNameIsNull) { EXPECT_EQ(membrane_models<double>().find("corotationel"), nullptr); }

}  // namespace
}  // namespace bb::test::membrane_model_test
