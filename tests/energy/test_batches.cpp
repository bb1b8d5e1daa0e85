// Membrane, spring and hinge batches: what they store is what the element functions give, for
// any thread count.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <memory>

#include "core/energy/hinge.hpp"
#include "core/energy/hinge_batch.hpp"
#include "core/energy/membrane_batch.hpp"
#include "core/energy/spring.hpp"
#include "core/energy/spring_batch.hpp"
#include "core/math/error.hpp"
#include "core/math/lower_blocks.hpp"
#include "tests/energy/energy_cases.hpp"
#include "tests/energy/strip.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::batches_test {
namespace {

Eigen::MatrixXd stored_hessian(const LocalTerms& out, std::size_t e, int width) {
  const std::size_t n = out.hess.size() / out.energy.size();
  return from_lower_blocks(&out.hess[n * e], width);
}

void expect_stored(const LocalTerms& out, std::size_t e, double energy, const auto& grad, const auto& hess) {
  EXPECT_EQ(out.energy[e], energy);
  const auto n = static_cast<std::size_t>(grad.size());
  ASSERT_GT(hess.cwiseAbs().maxCoeff(), 0);
  for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(out.grad[n * e + i], grad[static_cast<Eigen::Index>(i)]);
  EXPECT_EQ(stored_hessian(out, e, static_cast<int>(n / 3)), hess);
}

/// Values and derivatives agree, one thread and many agree bit for bit, and a second call moves no memory.
void expect_consistent(const EnergyBatch& batch, const Positions& x) {
  SCOPED_TRACE(batch.name());
  ASSERT_GT(batch.size(), 64u);  // more than one grain of the loop
  LocalTerms many, one;
  batch.derivatives(x, Projection::psd, many);
  std::vector<double> energy(batch.size());
  batch.values(x, energy.data());
  EXPECT_EQ(energy, many.energy);
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    batch.derivatives(x, Projection::psd, one);
  }
  EXPECT_EQ(one.grad, many.grad);
  EXPECT_EQ(one.hess, many.hess);
  EXPECT_GT(*std::max_element(one.energy.begin(), one.energy.end()), 0);
  const double* before = one.hess.data();
  batch.derivatives(x, Projection::psd, one);
  EXPECT_EQ(before, one.hess.data());
}

TEST(MembraneBatch, StoresTheElementTermsOfEveryModel) {
  const Strip strip(40);
  const std::size_t n = strip.triangles.size();
  std::vector<double> mu(n), lambda(n);
  for (std::size_t e = 0; e < n; ++e) {
    mu[e] = 1 + 0.1 * static_cast<double>(e);
    lambda[e] = 2 - 0.01 * static_cast<double>(e);
  }
  for (const auto& model : membrane_models<double>()) {
    for (const bool planar : {false, true}) {
      const MembraneBatch batch(model.name, strip.triangles, strip.rest, mu, lambda, planar);
      ASSERT_EQ(batch.size(), n);
      expect_consistent(batch, strip.deformed);
      LocalTerms out;
      batch.derivatives(strip.deformed, Projection::psd, out);
      const auto& t = strip.triangles[7];
      const Vec3d rest[3] = {strip.rest.col(t[0]), strip.rest.col(t[1]), strip.rest.col(t[2])};
      const Vec3d x[3] = {strip.deformed.col(t[0]), strip.deformed.col(t[1]), strip.deformed.col(t[2])};
      const Vec3d warp = rest[1] - rest[0];
      const auto data = planar ? planar_triangle_rest<double>(rest, warp) : triangle_rest<double>(rest, warp);
      const auto terms =
          (planar ? model.terms_planar : model.terms)(data, x, mu[7], lambda[7], Projection::psd);
      expect_stored(out, 7, terms.energy, terms.grad, terms.hess);
    }
  }
}

TEST(MembraneBatch, WarpDirectionReachesBaraffWitkin) {
  const Strip strip(40);
  const std::vector<double> ones(strip.triangles.size(), 1.0);
  const std::vector<Vec3d> warp(strip.triangles.size(), Vec3d(1, 1, 0));
  const MembraneBatch along_edge("baraff_witkin", strip.triangles, strip.rest, ones, ones);
  const MembraneBatch along_warp("baraff_witkin", strip.triangles, strip.rest, ones, ones, false, warp);
  std::vector<double> a(along_edge.size()), b(along_warp.size());
  along_edge.values(strip.deformed, a.data());
  along_warp.values(strip.deformed, b.data());
  EXPECT_GT(std::abs(a[3] - b[3]), 0.01 * b[3]);
  EXPECT_GT(b[3], 0);
}

// Along the first edges, the diagonal of one half would be warp and a side of the other.
TEST(MembraneBatch, BothHalvesOfASquareHaveOneEnergyUnderOneStretch) {
  Positions rest(3, 4);
  rest << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  const std::vector<std::array<int, 3>> halves = {{0, 1, 2},
                                                  {2, 0, 3}};  // the second begins with the diagonal
  Positions x = rest;
  x.row(0) *= 1.2;
  x.row(1) *= 0.9;
  const std::vector<double> ones(2, 1.0);
  const std::vector<Vec3d> warp(2, Vec3d(1, 0, 0));
  double along_axis[2], along_edge[2];
  MembraneBatch("baraff_witkin", halves, rest, ones, ones, false, warp).values(x, along_axis);
  MembraneBatch("baraff_witkin", halves, rest, ones, ones).values(x, along_edge);
  EXPECT_NEAR(along_axis[0], along_axis[1], 1e-16);
  EXPECT_NEAR(along_axis[0], 0.5 * 0.5 * (0.2 * 0.2 + 0.1 * 0.1), 1e-15);
  EXPECT_GT(std::abs(along_edge[0] - along_edge[1]), 1e-3);
  EXPECT_THROW(MembraneBatch("baraff_witkin", halves, rest, ones, ones, false, {warp.data(), 1}),
               ConfigError);
}

TEST(SpringBatch, StoresTheElementTerms) {
  const Strip strip(100);
  std::vector<double> k(strip.edges.size(), 3.0);
  k[5] = 4.0;
  const SpringBatch batch(strip.edges, strip.rest, k);
  expect_consistent(batch, strip.deformed);
  LocalTerms out;
  batch.derivatives(strip.deformed, Projection::psd, out);
  const auto [a, b] = strip.edges[5];
  const Vec3d x[2] = {strip.deformed.col(a), strip.deformed.col(b)};
  const double rest_length = (strip.rest.col(b) - strip.rest.col(a)).norm();
  const auto terms = spring_terms<double>(x, 4.0, rest_length, Projection::psd);
  expect_stored(out, 5, terms.energy, terms.grad, terms.hess);
}

std::vector<double> hinge_angles(const std::vector<std::array<int, 4>>& hinges, const Positions& x) {
  std::vector<double> angles;
  for (const auto& [e0, e1, v0, v1] : hinges) {
    const Vec3d points[4] = {x.col(e0), x.col(e1), x.col(v0), x.col(v1)};
    angles.push_back(hinge_angle<double>(points));
  }
  return angles;
}

struct HingeStrip {
  Strip strip{80};
  std::vector<double> stiffness, rest_angle;
  HingeStrip() : stiffness(strip.hinges.size(), 0.5), rest_angle(hinge_angles(strip.hinges, strip.rest)) {
    for (std::size_t e = 0; e < stiffness.size(); ++e) stiffness[e] += 0.01 * static_cast<double>(e);
  }
  /// The first n hinges, beginning at `first`.
  HingeBatch batch(std::size_t first, std::size_t n) const {
    const auto cut = [&](const std::vector<double>& column) {
      return std::vector<double>(&column[first], &column[first] + n);
    };
    return {{&strip.hinges[first], n}, cut(stiffness), cut(rest_angle)};
  }
};

/// Four hinges run side by side, with the bits of one alone.
TEST(HingeBatch, StoresTheElementTerms) {
  const HingeStrip hinges;
  const Positions& x = hinges.strip.deformed;
  const HingeBatch batch = hinges.batch(0, hinges.stiffness.size());
  expect_consistent(batch, x);
  LocalTerms out;
  batch.derivatives(x, Projection::psd, out);
  for (std::size_t e = 0; e < batch.size(); ++e) {
    const auto [e0, e1, v0, v1] = hinges.strip.hinges[e];
    const Vec3d points[4] = {x.col(e0), x.col(e1), x.col(v0), x.col(v1)};
    const auto terms =
        hinge_terms<double>(points, Projection::psd, hinges.stiffness[e], hinges.rest_angle[e]);
    EXPECT_EQ(out.energy[e], terms.energy);
    const Eigen::Map<const Vec<double, 12>> grad(&out.grad[12 * e]);
    const Eigen::MatrixXd hess = stored_hessian(out, e, 4);
    ASSERT_GT(terms.grad.norm(), 0);
    EXPECT_EQ(grad, terms.grad);
    EXPECT_EQ(hess, terms.hess);
  }
  std::vector<double> at_rest(batch.size());
  batch.values(hinges.strip.rest, at_rest.data());
  EXPECT_EQ(*std::max_element(at_rest.begin(), at_rest.end()), 0);
}

TEST(HingeBatch, AHingeDoesNotDependOnItsNeighboursInTheGroup) {
  HingeStrip hinges;
  const Positions& x = hinges.strip.deformed;
  const std::vector<double> angle = hinge_angles(hinges.strip.hinges, x);
  for (std::size_t e = 1; e < angle.size(); e += 3) hinges.rest_angle[e] = angle[e];  // exactly at rest
  LocalTerms all, part;
  hinges.batch(0, hinges.stiffness.size()).derivatives(x, Projection::psd, all);
  for (const std::size_t first : {1u, 2u, 3u}) {
    for (const std::size_t n : {1u, 2u, 3u, 5u, 8u}) {  // groups that are not full too
      hinges.batch(first, n).derivatives(x, Projection::psd, part);
      EXPECT_TRUE(std::equal(part.energy.begin(), part.energy.end(), &all.energy[first]));
      EXPECT_TRUE(std::equal(part.grad.begin(), part.grad.end(), &all.grad[12 * first]));
      EXPECT_TRUE(std::equal(part.hess.begin(), part.hess.end(), &all.hess[n_lower_numbers(4) * first]));
    }
  }
}

TEST(Batches, BadInputIsAConfigError) {
  const Strip strip(3);
  const std::vector<double> ones(strip.triangles.size(), 1.0), short_column(1, 1.0);
  EXPECT_THROW(MembraneBatch("corotationel", strip.triangles, strip.rest, ones, ones), ConfigError);
  EXPECT_THROW(MembraneBatch("arap", strip.triangles, strip.rest, short_column, ones), ConfigError);
  EXPECT_THROW(
      MembraneBatch("arap", strip.triangles, Positions(Positions::Zero(3, strip.rest.cols())), ones, ones),
      ConfigError);
  EXPECT_THROW(SpringBatch(strip.edges, strip.rest, short_column), ConfigError);
  EXPECT_THROW(HingeBatch(strip.hinges, short_column, short_column), ConfigError);
}

TEST(Batches, EmptyIsAllowed) {
  const SpringBatch batch({}, Positions(3, 0), {});
  LocalTerms out;
  batch.derivatives(Positions(3, 0), Projection::psd, out);
  EXPECT_EQ(batch.size(), 0u);
  EXPECT_TRUE(out.hess.empty());
}

}  // namespace
}  // namespace bb::test::batches_test
