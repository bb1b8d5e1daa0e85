// Membrane models as materials: their moduli at rest (the table of docs/theory/incremental-potential.md, Shells) from second derivatives of the element and
// from differences of its energy, and the Poisson's ratios for which the energy is smallest at rest and grows with the stretch.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "core/energy/membrane_model.hpp"
#include "tests/energy/energy_cases.hpp"

namespace bb::test::rest_moduli_test {
namespace {

constexpr double youngs = 5.0;  // N/m

double mu_of(double poisson) { return youngs / (2 * (1 + poisson)); }
double lambda_of(double poisson) { return youngs * poisson / (1 - poisson * poisson); }

template <class Model>
Long psi(const VecXl& f, double poisson) {
  return Model::template value<Long, 3>(unstacked<3, 2>(f).template cast<Long>(), Long(mu_of(poisson)),
                                        Long(lambda_of(poisson)));
}

/// F of small strains (warp, weft, engineering shear) without a rotation.
VecXl strained(const Vec3d& e) {
  Mat<Long, 3, 2> f = Mat<Long, 3, 2>::Zero();
  f << 1 + e[0], e[2] / 2, e[2] / 2, 1 + e[1], 0, 0;
  return stacked(f);
}

/// d2psi/de2 at rest by differences of the energy.
template <class Model>
Mat3d stiffness_by_differences(double poisson) {
  const double h = 1e-5;
  Mat3d c;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto at = [&](double a, double b) {
        return psi<Model>(strained(a * h * Vec3d::Unit(i) + b * h * Vec3d::Unit(j)), poisson);
      };
      c(i, j) = static_cast<double>((at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h * h));
    }
  }
  return c;
}

/// The same from the Hessian of the element.
template <class Model>
Mat3d stiffness_by_hessian(double poisson) {
  const Mat<double, 3, 2> rest = Mat<double, 3, 2>::Identity();
  const MatXd hess =
      Model::template terms<double, 3>(rest, mu_of(poisson), lambda_of(poisson), Projection::none).hess;
  MatXd strains(6, 3);  // dF/de
  for (int i = 0; i < 3; ++i) {
    strains.col(i) = (strained(Vec3d::Unit(i)) - strained(Vec3d::Zero())).cast<double>();
  }
  return strains.transpose() * hess * strains;
}

struct Moduli {
  double youngs, poisson, shear;
};

Moduli moduli_of(const Mat3d& c) {
  return {(c(0, 0) * c(1, 1) - c(0, 1) * c(0, 1)) / c(1, 1), c(0, 1) / c(1, 1), c(2, 2)};
}

/// The table of docs/theory/incremental-potential.md.
const std::map<std::string, Moduli (*)(double nu), std::less<>> table = {
    {"corotational",
     [](double nu) {
       return Moduli{youngs, nu, youngs / (2 * (1 + nu))};
     }},
    {"stvk",
     [](double nu) {
       return Moduli{youngs, nu, youngs / (2 * (1 + nu))};
     }},
    {"arap",
     [](double nu) {
       return Moduli{youngs / (1 + nu), 0, youngs / (2 * (1 + nu))};
     }},
    {"stable_neo_hookean",
     [](double nu) {
       return Moduli{4 * nu * youngs / ((1 + nu) * (1 + nu)), (3 * nu - 1) / (1 + nu),
                     youngs / (2 * (1 + nu))};
     }},
    {"baraff_witkin",
     [](double nu) {
       return Moduli{youngs / (2 * (1 + nu)), 0, nu * youngs / (1 - nu * nu)};
     }},
};

void expect_equal(const Moduli& found, const Moduli& expected, double tolerance) {
  EXPECT_NEAR(found.youngs, expected.youngs, tolerance * youngs);
  EXPECT_NEAR(found.poisson, expected.poisson, tolerance);
  EXPECT_NEAR(found.shear, expected.shear, tolerance * youngs);
}

const PoissonRange& range_of(std::string_view name) { return membrane_models<double>().find(name)->poisson; }

TEST(MembraneAtRest, has_the_moduli_of_the_table) {
  int models = 0;
  for_each_model([&]<class Model>(std::string_view name) {
    ASSERT_TRUE(table.contains(name)) << name << " has no line in the table";
    ++models;
    for (const double nu : {-0.5, 0.0, 0.1, 1.0 / 3, 0.45, 0.8}) {
      if (!range_of(name).contains(nu)) continue;
      SCOPED_TRACE(std::string(name) + " " + std::to_string(nu));
      const Moduli expected = table.find(name)->second(nu);
      const Mat3d c = stiffness_by_hessian<Model>(nu);
      expect_equal(moduli_of(c), expected, 1e-13);
      expect_equal(moduli_of(stiffness_by_differences<Model>(nu)), expected, 1e-6);
      EXPECT_NEAR(c(0, 2), 0, 1e-13);
      EXPECT_NEAR(c(0, 0), c(1, 1), 1e-13);
    }
  });
  EXPECT_EQ(models, 5);
}

/// Gradients of all shapes and sizes up to 1e3.
std::vector<VecXl> many_gradients() {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> decade(-2, 3);
  std::vector<VecXl> out;
  for (int k = 0; k < 2000; ++k) {
    VecXl f(6);
    const double size = std::pow(10, decade(random));
    for (int i = 0; i < 6; ++i) f[i] = size * normal(random);
    out.push_back(f);
  }
  for (const double s : {0.5, 0.99, 1.01, 2.0, 1e3}) out.push_back(Long(s) * strained(Vec3d::Zero()));
  return out;
}

TEST(MembraneAtRest, an_allowed_material_has_its_smallest_energy_at_rest_and_grows_with_the_stretch) {
  const std::vector<VecXl> gradients = many_gradients();
  for_each_model([&]<class Model>(std::string_view name) {
    const PoissonRange& range = range_of(name);
    for (const double nu : {range.from + (range.closed ? 0 : 0.01), 0.3, 0.9}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(nu));
      EXPECT_TRUE(range.contains(nu));
      for (const VecXl& f : gradients) {
        const Long found = psi<Model>(f, nu);
        ASSERT_GE(found, 0);
        const Long size = f.norm();
        if (size > 50) {  // no dead load lowers it without bound
          ASSERT_GT(found, 1e-3L * size * size);
        }
      }
    }
  });
}

TEST(MembraneAtRest, a_refused_material_falls_without_bound_or_does_not_grow) {
  const auto neo = [](double stretch, double nu) {
    return static_cast<double>(
        psi<membrane::stable_neo_hookean>(Long(stretch) * strained(Vec3d::Zero()), nu));
  };
  const auto sheared = [](double shear, double nu) {
    Mat<Long, 3, 2> f;
    f << 1, shear, 0, 1, 0, 0;
    return static_cast<double>(psi<membrane::baraff_witkin>(stacked(f), nu));
  };
  EXPECT_FALSE(range_of("stable_neo_hookean").contains(0));
  EXPECT_EQ(neo(7, 0), 0);
  EXPECT_FALSE(range_of("stable_neo_hookean").contains(-0.2));
  EXPECT_LT(neo(10, -0.2), -1e3);
  EXPECT_FALSE(range_of("baraff_witkin").contains(-0.2));
  EXPECT_LT(neo(100, -0.2), 1e3 * neo(10, -0.2));
  EXPECT_TRUE(range_of("baraff_witkin").contains(0));
  EXPECT_GT(sheared(10, 0), 0);
  EXPECT_LT(sheared(0.1, -0.2), 0);
  const auto both = [](double stretch,
                       double nu) {  // sheared and stretched: the product of the columns grows with both
    Mat<Long, 3, 2> f;
    f << stretch, stretch, 0, 1, 0, 0;
    return static_cast<double>(psi<membrane::baraff_witkin>(stacked(f), nu));
  };
  EXPECT_LT(both(10, -0.2), -1e3);
  EXPECT_LT(both(100, -0.2), 1e3 * both(10, -0.2));
}

}  // namespace
}  // namespace bb::test::rest_moduli_test
