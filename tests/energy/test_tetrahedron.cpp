// Solid models in F and on one tetrahedron: derivatives against differences and closed forms, exact projection, inverted and
// collapsed states, invariances; the batch.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/energy/solid_model.hpp"
#include "core/math/error.hpp"
#include "tests/energy/energy_cases.hpp"
#include "tests/energy/host_family.hpp"
#include "tests/oracle/dense.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::tetrahedron_test {
namespace {

constexpr double lame_mu = 3.0, lame_lambda = 2.0;

template <class F>
void for_each_solid(const F& f) {
#define ENTRY(name, ...) f.template operator()<solid::name>(std::string(#name));
#include "core/energy/solids.inc"
#undef ENTRY
}

// near rest, stretched, compressed, equal values, two equal, nearly equal, thin; inverted from s2 < 0 on, up to s1 + s2 -> 0
const Vec3d upright[] = {{1.01, 1, 0.99},  {1.8, 1.3, 1.1}, {0.7, 0.6, 0.4}, {1, 1, 1},
                         {1.4, 1.4, 1.4},  {0.6, 0.6, 0.6}, {1.5, 0.7, 0.7}, {1.5, 1.5, 0.4},
                         {1 + 1e-9, 1, 1}, {1.4, 1.1, 0.02}};
const Vec3d inverted[] = {{1.2, 0.9, -0.5}, {1.3, 0.8, -0.79}, {0.7, 0.7, -0.2}, {1.1, 0.5, -0.499999}};

std::vector<Vec3d> all_states() {
  std::vector<Vec3d> out(std::begin(upright), std::end(upright));
  out.insert(out.end(), std::begin(inverted), std::end(inverted));
  return out;
}

Mat3d gradient_of(const Vec3d& sigma, std::mt19937& random) {
  return random_rotation(random) * sigma.asDiagonal() * random_rotation(random);
}

template <class Model, class T>
DensityTerms<T, 3, 3> terms_at(const VecXl& f, Projection projection) {
  return Model::template terms<T, 3, 3>(unstacked<3, 3>(f).template cast<T>(), T(lame_mu), T(lame_lambda),
                                        projection);
}

/// psi written in F, its signed singular values from the eigenvalues of F^T F.
Long closed_form(const std::string& name, const VecXl& columns) {
  const Mat<Long, 3, 3> f = unstacked<3, 3>(columns), c = f.transpose() * f;
  const Long mu = lame_mu, lambda = lame_lambda, j = f.determinant();
  const Vec<Long, 3> squares = eigenvalues(MatXl(c));
  const Long largest = std::sqrt(squares[2]), middle = std::sqrt(squares[1]);
  const Long trace = largest + middle + j / (largest * middle) - 3;
  const Long arap = mu * (c.trace() - 2 * (trace + 3) + 3);
  const Mat<Long, 3, 3> e = (c - Mat<Long, 3, 3>::Identity()) / 2;
  if (name == "arap") return arap;
  if (name == "corotational") return arap + lambda / 2 * trace * trace;
  if (name == "stvk") return mu * e.squaredNorm() + lambda / 2 * e.trace() * e.trace();
  if (name == "stable_neo_hookean")
    return mu / 2 * (c.trace() - 3) - mu * (j - 1) + lambda / 2 * (j - 1) * (j - 1);
  return std::numeric_limits<Long>::quiet_NaN();
}

template <class Model>
void check_derivatives(const std::string& name, const VecXl& f, double tolerance) {
  const auto terms = terms_at<Model, double>(f, Projection::none);
  const auto value = [&](const VecXl& x) { return closed_form(name, x); };
  EXPECT_NEAR(terms.psi, static_cast<double>(value(f)), 1e-13 * std::max(1.0, terms.psi));
  if (terms.pk1.cwiseAbs().maxCoeff() > 1e-7) {
    EXPECT_LT(gradient_error(value, f, stacked(terms.pk1)), tolerance);
  }
  const auto gradient = [&](const VecXl& x) -> VecXl {
    return stacked(terms_at<Model, Long>(x, Projection::none).pk1);
  };
  EXPECT_LT(jacobian_error(gradient, f, terms.hess), tolerance);
  EXPECT_EQ(terms.hess, terms.hess.transpose());
}

TEST(Solid, derivatives_in_F_are_those_of_the_closed_form_inverted_states_included) {
  for_each_solid([]<class Model>(const std::string& name) {
    std::mt19937 random(1);
    for (const Vec3d& sigma : all_states()) {
      SCOPED_TRACE(name + " " + std::to_string(sigma[0]) + " " + std::to_string(sigma[2]));
      check_derivatives<Model>(name, stacked(gradient_of(sigma, random)).cast<Long>(), 1e-8);
    }
  });
}

TEST(Solid, projections_are_those_of_the_dense_matrix) {
  for_each_solid([]<class Model>(const std::string& name) {
    std::mt19937 random(2);
    int indefinite = 0;
    for (const Vec3d& sigma : all_states()) {
      SCOPED_TRACE(name + " " + std::to_string(sigma[0]) + " " + std::to_string(sigma[2]));
      const VecXl f = stacked(gradient_of(sigma, random)).cast<Long>();
      const auto exact = terms_at<Model, double>(f, Projection::none);
      const auto psd = terms_at<Model, double>(f, Projection::psd);
      const auto absolute = terms_at<Model, double>(f, Projection::absolute);
      const double scale = exact.hess.cwiseAbs().maxCoeff();
      const MatXd expected = clamped(exact.hess);
      EXPECT_LT(relative_difference(psd.hess, expected, scale), 1e-10);
      EXPECT_LT(relative_difference(absolute.hess, 2 * expected - exact.hess, scale), 1e-10);
      EXPECT_EQ(psd.pk1, exact.pk1);
      EXPECT_GE(eigenvalues(MatXd(psd.hess))[0], -1e-13 * scale);
      indefinite += eigenvalues(MatXd(exact.hess))[0] < -1e-3 * scale ? 1 : 0;
    }
    EXPECT_GT(indefinite, 2) << name;
  });
}

TEST(Solid, rest_is_a_stress_free_state_with_the_moduli_that_are_documented) {
  for_each_solid([]<class Model>(const std::string& name) {
    const VecXl identity = stacked(Mat<Long, 3, 3>::Identity());
    const auto terms = terms_at<Model, double>(identity, Projection::none);
    EXPECT_EQ(terms.psi, 0);
    EXPECT_TRUE(terms.pk1.isZero(0));
    const double lambda = name == "arap"                 ? 0
                          : name == "stable_neo_hookean" ? lame_lambda - lame_mu
                                                         : lame_lambda;
    EXPECT_NEAR(terms.hess(0, 0), 2 * lame_mu + lambda, 1e-12) << name;
    EXPECT_NEAR(terms.hess(0, 4), lambda, 1e-12) << name;
    EXPECT_NEAR(terms.hess(1, 1) + terms.hess(1, 3), 2 * lame_mu, 1e-12) << name;
  });
}

TEST(Solid, collapsed_states_are_finite_and_positive_semidefinite) {
  for_each_solid([]<class Model>(const std::string& name) {
    for (const Vec3d& sigma : {Vec3d(0, 0, 0), Vec3d(1.5, 0, 0), Vec3d(1.5, 0.7, 0), Vec3d(1.2, 0.7, -0.7)}) {
      SCOPED_TRACE(name);
      const Mat3d f = sigma.asDiagonal();
      const auto terms = terms_at<Model, double>(stacked(f).cast<Long>(), Projection::psd);
      ASSERT_TRUE(std::isfinite(terms.psi) && terms.pk1.allFinite() && terms.hess.allFinite());
      const VecXd values = eigenvalues(MatXd(terms.hess));
      EXPECT_GE(values[0], -1e-12 * std::max(1.0, values[8]));
    }
  });
}

const Vec<double, 12> rest_state{{0, 0, 0.1, 1.1, 0.2, 0.1, -0.2, 0.9, 0.2, 0.3, 0.1, 0.8}};
const Vec<double, 12> deformed_state{{0.1, 0.2, 0.3, 1.2, -0.1, 0.6, -0.2, 0.5, 0.1, 0.5, 0.4, 0.9}};

template <class Model, class T>
ElementTerms<T, 12> element_at(const VecXl& x, Projection projection = Projection::none) {
  const auto rest = tetrahedron_rest<T>(Points<T, 4>(rest_state).x);
  return tetrahedron_terms<Model, T>(rest, Points<T, 4>(x).x, T(lame_mu), T(lame_lambda), projection);
}

TEST(Tetrahedron, derivatives_in_the_twelve_coordinates) {
  for_each_solid([]<class Model>(const std::string& name) {
    SCOPED_TRACE(name);
    const VecXl x = deformed_state.cast<Long>();
    const auto rest = tetrahedron_rest<Long>(Points<Long, 4>(rest_state).x);
    const auto value = [&](const VecXl& at) {
      return tetrahedron_value<Model, Long>(rest, Points<Long, 4>(at).x, lame_mu, lame_lambda);
    };
    const auto gradient = [&](const VecXl& at) -> VecXl { return element_at<Model, Long>(at).grad; };
    const auto terms = element_at<Model, double>(x);
    EXPECT_LT(gradient_error(value, x, terms.grad), 1e-9);
    EXPECT_LT(jacobian_error(gradient, x, terms.hess), 1e-9);
    EXPECT_EQ(terms.hess, terms.hess.transpose());
    EXPECT_NEAR(terms.energy, static_cast<double>(value(x)), 1e-14);
    EXPECT_NEAR(static_cast<double>(rest.volume), 0.716 / 6, 1e-15);
    const auto single = element_at<Model, float>(x);
    EXPECT_NEAR(static_cast<double>(single.energy), terms.energy, 1e-5 * terms.energy);
    EXPECT_LT(relative_difference(single.hess.template cast<double>(), terms.hess,
                                  terms.hess.cwiseAbs().maxCoeff()),
              1e-5);
  });
}

TEST(Tetrahedron, no_force_on_the_whole_no_torque_and_no_energy_of_a_rigid_motion) {
  std::mt19937 random(3);
  const Mat3d rotation = random_rotation(random);
  VecXl moved(12);
  for (int i = 0; i < 4; ++i) {
    moved.segment<3>(3 * i) = (rotation * deformed_state.segment<3>(3 * i) + Vec3d(3, -2, 1)).cast<Long>();
  }
  for_each_solid([&]<class Model>(const std::string& name) {
    SCOPED_TRACE(name);
    const auto before = element_at<Model, double>(deformed_state.cast<Long>());
    const auto after = element_at<Model, double>(moved);
    Vec3d force = Vec3d::Zero(), torque = Vec3d::Zero();
    for (int i = 0; i < 4; ++i) {
      const Vec3d f = before.grad.template segment<3>(3 * i), x = deformed_state.segment<3>(3 * i);
      force += f;
      torque += x.cross(f);
      EXPECT_LT((rotation * f - after.grad.template segment<3>(3 * i)).norm(), 1e-13);
    }
    EXPECT_GT(before.grad.norm(), 0.1);
    EXPECT_LT(force.norm(), 1e-14);
    EXPECT_LT(torque.norm(), 1e-14);
    EXPECT_NEAR(after.energy, before.energy, 1e-14);
  });
}

/// A row of tetrahedra that share nothing, each deformed in its own way.
struct Row {
  std::vector<std::array<int, 4>> tetrahedra;
  Positions rest, deformed;
  std::vector<double> mu, lambda;
  SolidPart part(const std::string& model) const { return {model, tetrahedra, mu, lambda}; }
  explicit Row(int n) : rest(3, 4 * n), deformed(3, 4 * n) {
    for (int e = 0; e < n; ++e) {
      tetrahedra.push_back({4 * e, 4 * e + 1, 4 * e + 2, 4 * e + 3});
      mu.push_back(1 + 0.1 * e);
      lambda.push_back(2 - 0.01 * e);
      for (int i = 0; i < 4; ++i) {
        rest.col(4 * e + i) = rest_state.segment<3>(3 * i) + Vec3d(2.0 * e, 0, 0);
        deformed.col(4 * e + i) =
            rest.col(4 * e + i) + 0.1 * Vec3d(std::sin(e + i), std::cos(2 * e - i), std::sin(3 * e + 2 * i));
      }
    }
  }
};

TEST(TetrahedronFamily, stores_the_element_terms_whatever_the_threads) {
  const Row row(80);
  for (const auto& model : solid_models<double>()) {
    SCOPED_TRACE(model.name);
    const SolidPart part = row.part(std::string(model.name));
    const HostFamily family(
        [&](const FamilyPlace& place) { return tetrahedron_family(place, part, row.rest); });
    ASSERT_EQ(family.size(), 80u);
    ASSERT_GT(family.size(), static_cast<std::size_t>(elements_of_a_thread));
    LocalTerms many, one;
    family.derivatives(row.deformed, Projection::psd, many);
    {
      const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
      family.derivatives(row.deformed, Projection::psd, one);
    }
    EXPECT_EQ(one.grad, many.grad);
    EXPECT_EQ(one.hess, many.hess);
    EXPECT_EQ(family.values(row.deformed), many.energy);
    Vec3d rest[4], x[4];
    for (int i = 0; i < 4; ++i) rest[i] = row.rest.col(28 + i), x[i] = row.deformed.col(28 + i);
    const auto terms =
        model.terms(tetrahedron_rest<double>(rest), x, row.mu[7], row.lambda[7], Projection::psd);
    EXPECT_EQ(many.energy[7], terms.energy);
    for (int i = 0; i < 12; ++i) EXPECT_EQ(many.grad[84 + static_cast<std::size_t>(i)], terms.grad[i]);
    EXPECT_EQ(from_lower_blocks(&many.hess[7 * 90], 4), terms.hess);
    EXPECT_GT(terms.hess.cwiseAbs().maxCoeff(), 0);
  }
}

TEST(TetrahedronFamily, names_the_rest_tetrahedron_that_is_inverted_or_flat) {
  Row row(3);
  std::swap(row.tetrahedra[1][0], row.tetrahedra[1][1]);
  const auto make = [&] {
    const SolidPart part = row.part("arap");
    const HostFamily family(
        [&](const FamilyPlace& place) { return tetrahedron_family(place, part, row.rest); });
  };
  try {
    make();
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.violations().front().where, "tetrahedron 1");
  }
  row.tetrahedra[1] = {4, 5, 6, 6};
  EXPECT_THROW(make(), ConfigError);
  row = Row(3);
  EXPECT_NO_THROW(make());
  row.mu.pop_back();
  EXPECT_THROW(make(), ConfigError);
}

// What the term -mu/2 log(|F|^2 + 1) of the paper is for: docs/theory/incremental-potential.md, Solids.
TEST(Solids, StableNeoHookeanWithoutItsLogarithmHoldsAPoint) {
  const VecXl point = VecXl::Zero(9);
  const auto terms = terms_at<solid::stable_neo_hookean, double>(point, Projection::none);
  EXPECT_NEAR(terms.psi, (lame_lambda - lame_mu) / 2, 1e-15);
  EXPECT_EQ(terms.pk1.norm(), 0);
  const VecXd curvature = eigenvalues(MatXd(terms.hess));
  EXPECT_NEAR(curvature.minCoeff(), lame_mu, 1e-13) << "a local minimum";
  EXPECT_NEAR(curvature.maxCoeff(), lame_mu, 1e-13);
}

}  // namespace
}  // namespace bb::test::tetrahedron_test
