// The elasticity-inclusive formula against closed forms: point masses, a wall, given Hessian blocks.
#include "barriers/stiffness/elasticity_inclusive.hpp"

#include <gtest/gtest.h>

#include <random>

#include "barriers/stiffness/registry.hpp"
#include "core/barrier/scaled_policy.hpp"
#include "core/math/error.hpp"
#include "core/math/types.hpp"

namespace bb::elasticity_inclusive_test {
namespace {

using Mat12 = Eigen::Matrix<double, 12, 12>;

struct Rule {
  MassTerm mass_term;
  bool elastic_term;
  double dt, c;
  ElasticityInclusive policy() const { return {.mass_term = mass_term, .elastic_term = elastic_term}; }
  StiffnessTime time() const { return {dt, c}; }
};

template <class T>
ContactSums<T> sums_of(int n, const T* weight, const T* normal, const T* mass, const T* hessian,
                       const Rule& rule) {
  return contact_sums(n, weight, normal, mass, ColumnMajor<T>{hessian, 12}, rule.elastic_term);
}
template <class T>
T kappa_of(int n, const T* weight, const T* normal, T d, T d_hat, const T* mass, const T* hessian,
           const Rule& rule) {
  return rule.policy().contact_kappa(sums_of(n, weight, normal, mass, hessian, rule), d, d_hat, rule.time());
}

/// A random row of n free vertices with a symmetric positive semi-definite Hessian.
struct Row {
  int n_free;
  Eigen::Vector4d weight, mass;
  Eigen::Vector3d normal;
  double d = 3e-4, d_hat = 1e-3;
  Mat12 hessian = Mat12::Zero();

  Row(int n, unsigned seed) : n_free(n) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.1, 1);
    for (int i = 0; i < 4; ++i) {
      weight[i] = i < n ? (i % 2 ? -1 : 1) * uniform(random) : 0;
      mass[i] = i < n ? 1e-4 * uniform(random) : 0;
    }
    for (int k = 0; k < 3; ++k) normal[k] = uniform(random) - 0.5;
    normal.normalize();
    Eigen::MatrixXd root(3 * n, 3 * n);
    for (int i = 0; i < root.size(); ++i) root(i) = uniform(random) - 0.4;
    hessian.topLeftCorner(3 * n, 3 * n) = 40 * root * root.transpose();
  }

  double kappa(const Rule& rule) const {
    return kappa_of(n_free, weight.data(), normal.data(), d, d_hat, mass.data(), hessian.data(), rule);
  }
};

TEST(ElasticityInclusive, TwoFreePointMasses) {
  const double weight[] = {1, -1}, normal[] = {0, 1, 0}, mass[] = {2e-3, 6e-3}, d = 1e-3, h = 0.01,
               c = 4.0 / 9;
  const auto kappa = [&](const Rule& rule) {
    return kappa_of(2, weight, normal, d, 3 * d, mass, static_cast<const double*>(nullptr), rule);
  };
  // w^T M w/(w^T w) = (m1 + m2)/2 = 4e-3 kg
  EXPECT_NEAR(kappa({MassTerm::paper, false, h, c}), 4e-3 / 1e-6, 1e-9);
  EXPECT_NEAR(kappa({MassTerm::inertia, false, h, c}), 4e-3 / (c * 1e-4), 1e-9);
  EXPECT_NEAR(kappa({MassTerm::scaled, false, h, c}), 9 * 4e-3 / (c * 1e-4), 1e-9);  // at d_hat/3
  EXPECT_EQ(kappa({MassTerm::inertia, false, h, 0}), 0);  // quasi-static: no inertia
  EXPECT_EQ(kappa({MassTerm::scaled, false, h, 0}), 0);
}

TEST(ElasticityInclusive, OneVertexAtAWall) {
  Row row(1, 3);
  row.weight[0] = 1;
  const Mat3d block = row.hessian.topLeftCorner<3, 3>();
  const double normal_stiffness = row.normal.dot(block * row.normal);
  ASSERT_GT(normal_stiffness, 1);

  const double expected = row.mass[0] / (row.d * row.d) + normal_stiffness;
  EXPECT_NEAR(row.kappa({MassTerm::paper, true, 0, 1}), expected, 1e-12 * expected);
  EXPECT_NEAR(row.kappa({MassTerm::none, true, 0, 1}), normal_stiffness, 1e-12 * normal_stiffness);
}

TEST(ElasticityInclusive, IsTheRayleighQuotientOfTheWholeSubMatrix) {
  for (const int n : {1, 2, 3, 4}) {
    const Row row(n, 10u + static_cast<unsigned>(n));
    Eigen::VectorXd w(3 * n), mass(3 * n);
    for (int i = 0; i < n; ++i) {
      w.segment<3>(3 * i) = row.weight[i] * row.normal;
      mass.segment<3>(3 * i).setConstant(row.mass[i]);
    }
    const Eigen::MatrixXd h_el = row.hessian.topLeftCorner(3 * n, 3 * n);
    const double h = 2e-3, c = 0.25;
    const Eigen::MatrixXd matrix = h_el + Eigen::MatrixXd(mass.asDiagonal()) / (c * h * h);
    const double expected = w.dot(matrix * w) / w.squaredNorm();

    EXPECT_NEAR(row.kappa({MassTerm::inertia, true, h, c}), expected, 1e-12 * expected) << n;
    Eigen::MatrixXd diagonal = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (int i = 0; i < n; ++i) diagonal.block<3, 3>(3 * i, 3 * i) = h_el.block<3, 3>(3 * i, 3 * i);
    const double without_coupling = w.dot(diagonal * w) / w.squaredNorm();
    const double coupling = row.kappa({MassTerm::none, true, h, c}) - without_coupling;
    EXPECT_EQ(std::abs(coupling) > 1e-3, n > 1) << n;
  }
}

TEST(ElasticityInclusive, DoesNotDependOnTheScaleOrSignOfTheWeights) {
  const Rule rule{MassTerm::paper, true, 0, 1};
  for (const int n : {1, 2, 3, 4}) {
    Row row(n, 30u + static_cast<unsigned>(n));
    const double before = row.kappa(rule);
    ASSERT_GT(before, 0);
    row.weight *= -0.25;
    EXPECT_DOUBLE_EQ(row.kappa(rule), before);
  }
}

TEST(ElasticityInclusive, FloatAgreesWithDouble) {
  const Row row(4, 51);
  const Rule rule{MassTerm::paper, true, 0, 1};
  const Eigen::Matrix<float, 12, 12> hessian = row.hessian.cast<float>();
  const Eigen::Vector4f weight = row.weight.cast<float>(), mass = row.mass.cast<float>();
  const Eigen::Vector3f normal = row.normal.cast<float>();
  const float single = kappa_of(4, weight.data(), normal.data(), static_cast<float>(row.d),
                                static_cast<float>(row.d_hat), mass.data(), hessian.data(), rule);
  EXPECT_NEAR(static_cast<double>(single), row.kappa(rule), 1e-5 * row.kappa(rule));
}

TEST(ElasticityInclusive, AsAFunctionOfTheGapItIsTheSameKappa) {
  int falls = 0;
  for (const MassTerm term : {MassTerm::paper, MassTerm::inertia, MassTerm::scaled, MassTerm::none}) {
    Row row(3, 41);
    const Rule rule{term, true, 0.01, 0.25};
    const KappaParts parts = rule.policy().contact_parts(
        sums_of(row.n_free, row.weight.data(), row.normal.data(), row.mass.data(), row.hessian.data(), rule),
        row.d_hat, rule.time());
    EXPECT_GT(parts.fixed, 0);
    EXPECT_EQ(parts.per_gap_sq > 0, rule.policy().depends_on_gap());
    falls += parts.per_gap_sq > 0;
    for (const double d : {1e-6, 3e-4, 9.9e-4}) {
      row.d = d;
      EXPECT_NEAR(parts.at(d), row.kappa(rule), 1e-12 * row.kappa(rule));
    }
  }
  EXPECT_EQ(falls, 2);
}

/// The same ladder of mass terms serves a limited triangle: closed forms, and contact and limit side by side.
TEST(ElasticityInclusive, KappaOfALimitedTriangleHasTheSameMassTerms) {
  const ElementSums<double> sums{26, 7, 6, 0.5};
  const double width = 0.4, y = 0.1;  // a quarter of the width
  const StiffnessTime time{0.1, 0.25};
  const long double inertia = 26 / (0.25L * 0.1L * 0.1L);
  const auto kappa = [&](MassTerm term, bool elastic, const StiffnessTime& t) {
    return ElasticityInclusive{.mass_term = term, .elastic_term = elastic}
        .element_parts(sums, width, t)
        .at(y);
  };
  const auto expect = [](double found, long double expected) {
    EXPECT_NEAR(found, static_cast<double>(expected), 1e-14 * static_cast<double>(expected));
  };
  expect(kappa(MassTerm::paper, true, time), 7 + 6 / (0.1L * 0.1L));
  expect(kappa(MassTerm::inertia, true, time), 7 + inertia);
  expect(kappa(MassTerm::scaled, true, time), 7 + 16 * inertia);
  EXPECT_EQ(kappa(MassTerm::none, true, time), 7);
  EXPECT_EQ(kappa(MassTerm::scaled, true, {0.1, 0}), 7);  // quasi-static: no inertia
  for (const MassTerm term : {MassTerm::inertia, MassTerm::scaled, MassTerm::none}) {
    const ContactSums<double> contact{26, 7, 1};
    const ElasticityInclusive policy{.mass_term = term};
    EXPECT_NEAR(policy.contact_kappa(contact, y, width, time), kappa(term, true, time), 1e-9);
  }
}

/// The floor of the gap and the factor act alike on contacts and on limited triangles.
TEST(ElasticityInclusive, IsAskedAtTheFloorAndMultiplied) {
  const ScaledPolicy<ElasticityInclusive> policy{{.gap_floor = 0.5}, 3};
  const ContactSums<double> contact{2, 0, 1};
  const ElementSums<double> element{9, 0, 2, 0};
  for (const double gap : {1e-9, 0.2, 0.5, 0.8}) {
    const double asked = std::max(gap, 0.5), expected = 3 * 2 / (asked * asked);
    EXPECT_DOUBLE_EQ(policy.contact_kappa(contact, gap, 1, {}), expected) << gap;
    EXPECT_DOUBLE_EQ(policy.element_kappa(element, gap, 1, {}), expected) << gap;
  }
}

TEST(ElasticityInclusive, PolicyFillsEveryRowWithTheFormulaTimesTheMultiplier) {
  PolicyConfig config;
  config.name = "elasticity_inclusive";
  config.parameters.emplace("mass_term", "inertia");
  config.parameters.emplace("refresh", "per_step");
  config.scale = 3;
  const std::unique_ptr<StiffnessPolicy> policy = make_policy(config);
  EXPECT_EQ(policy->name(), "elasticity_inclusive");
  EXPECT_EQ(policy->refresh(), Refresh::per_step);
  EXPECT_TRUE(policy->needs_hessian());
  EXPECT_FALSE(policy->needs_globals());

  std::vector<int> n_free;
  std::vector<double> weight, normal, d, d_hat, mass, hessian;
  std::vector<Row> rows;
  for (int n = 1; n <= 4; ++n) {
    rows.emplace_back(n, 70u + static_cast<unsigned>(n));
    const Row& row = rows.back();
    n_free.push_back(n);
    weight.insert(weight.end(), row.weight.begin(), row.weight.end());
    mass.insert(mass.end(), row.mass.begin(), row.mass.end());
    normal.insert(normal.end(), row.normal.begin(), row.normal.end());
    hessian.insert(hessian.end(), row.hessian.data(), row.hessian.data() + 144);
    d.push_back(row.d);
    d_hat.push_back(row.d_hat);
  }
  StiffnessBatch batch{4,           n_free.data(),  weight.data(), normal.data(), d.data(), d_hat.data(),
                       mass.data(), hessian.data(), 0.01,          0.25};
  std::vector<double> kappa(4, -1);
  policy->fill(batch, kappa.data());
  for (std::size_t r = 0; r < 4; ++r) {
    const double one = rows[r].kappa({MassTerm::inertia, true, 0.01, 0.25});
    ASSERT_GT(one, 0);
    EXPECT_EQ(kappa[r], 3 * one);
  }

  // evaluated at the floor where the gap is below it
  config.parameters["mass_term"] = "paper";
  config.parameters["gap_floor"] = 0.5;
  for (std::size_t r = 0; r < 4; ++r) d[r] = (r % 2 == 0 ? 1e-12 : 0.7) * d_hat[r];
  make_policy(config)->fill(batch, kappa.data());
  for (std::size_t r = 0; r < 4; ++r) {
    Row row = rows[r];
    row.d = (r % 2 == 0 ? 0.5 : 0.7) * d_hat[r];
    EXPECT_EQ(kappa[r], 3 * row.kappa({MassTerm::paper, true, 0.01, 0.25}));
    d[r] = rows[r].d;
  }
  config.parameters["mass_term"] = "inertia";
  config.parameters["gap_floor"] = 0.0;

  config.parameters["elastic_term"] = false;
  const std::unique_ptr<StiffnessPolicy> massive = make_policy(config);
  EXPECT_FALSE(massive->needs_hessian());
  batch.hessian = nullptr;
  massive->fill(batch, kappa.data());
  EXPECT_EQ(kappa[0], 3 * rows[0].kappa({MassTerm::inertia, false, 0.01, 0.25}));

  EXPECT_FALSE(massive->has_potential());
  config.parameters.insert_or_assign("mass_term", "scaled");
  config.parameters.insert_or_assign("derivative", "included");
  const std::unique_ptr<StiffnessPolicy> folded = make_policy(config);
  EXPECT_TRUE(folded->has_potential());
  std::vector<KappaParts> parts(4);
  batch.d = nullptr;  // not read
  folded->fill_parts(batch, parts.data());
  for (std::size_t r = 0; r < 4; ++r) {
    const double one = 3 * rows[r].kappa({MassTerm::scaled, false, 0.01, 0.25});
    EXPECT_NEAR(parts[r].at(rows[r].d), one, 1e-12 * one);
  }

  config.parameters.insert_or_assign("derivative", "dropped");
  config.parameters.insert_or_assign("mass_term", "none");
  EXPECT_THROW(make_policy(config), ConfigError);
}

}  // namespace
}  // namespace bb::elasticity_inclusive_test
