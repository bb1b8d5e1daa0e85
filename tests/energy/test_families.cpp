// Families of membranes, springs and hinges: what they store is what the element functions give, for any thread count and any
// order of elements, several abreast or one by one.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <memory>

#include "core/energy/families/element_kernels.hpp"
#include "core/energy/hinge.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/energy/spring.hpp"
#include "core/math/error.hpp"
#include "core/math/lower_blocks.hpp"
#include "tests/energy/energy_cases.hpp"
#include "tests/energy/host_family.hpp"
#include "tests/energy/strip.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::families_test {
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

/// Values and derivatives agree; one thread, many, and other orders, which take elements one by one, agree bit for bit; a second call
/// moves no memory.
void expect_consistent(const HostFamily::Make& make, const Positions& x) {
  const HostFamily family(make);
  ASSERT_GT(family.size(), static_cast<std::size_t>(elements_of_a_thread));
  LocalTerms many, one;
  family.derivatives(x, Projection::psd, many);
  EXPECT_EQ(family.values(x), many.energy);
  const auto expect_same = [&] {
    EXPECT_EQ(one.energy, many.energy);
    EXPECT_EQ(one.grad, many.grad);
    EXPECT_EQ(one.hess, many.hess);
  };
  {
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    family.derivatives(x, Projection::psd, one);
    expect_same();
  }
  for (const exec::Order order : {exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
    HostFamily(make, Precision::full, order).derivatives(x, Projection::psd, one);
    expect_same();
  }
  EXPECT_GT(*std::max_element(many.energy.begin(), many.energy.end()), 0);
  const double* before = many.hess.data();
  family.derivatives(x, Projection::psd, many);
  EXPECT_EQ(before, many.hess.data());
}

MembranePart membrane_part(const std::string& model, const std::vector<std::array<int, 3>>& triangles) {
  MembranePart part;
  part.model = model, part.triangles = triangles;
  part.lame_mu = part.lame_lambda = std::vector<double>(triangles.size(), 1.0);
  return part;
}

TEST(Membranes, StoresTheElementTermsOfEveryModel) {
  const Strip strip(40);
  const std::size_t n = strip.triangles.size();
  MembranePart part = membrane_part("", strip.triangles);
  std::vector<double>&mu = part.lame_mu, &lambda = part.lame_lambda;
  for (std::size_t e = 0; e < n; ++e) {
    mu[e] = 1 + 0.1 * static_cast<double>(e);
    lambda[e] = 2 - 0.01 * static_cast<double>(e);
  }
  for (const auto& model : membrane_models<double>()) {
    part.model = model.name;
    for (const bool planar : {false, true}) {
      SCOPED_TRACE(part.model);
      const HostFamily family(membranes_of(part, strip.rest, planar));
      ASSERT_EQ(family.size(), n);
      expect_consistent(membranes_of(part, strip.rest, planar), strip.deformed);
      LocalTerms out;
      family.derivatives(strip.deformed, Projection::psd, out);
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

TEST(Membranes, WarpDirectionReachesBaraffWitkin) {
  const Strip strip(40);
  const MembranePart along_edge = membrane_part("baraff_witkin", strip.triangles);
  MembranePart along_warp = along_edge;
  along_warp.warp.assign(strip.triangles.size(), Vec3d(1, 1, 0));
  const std::vector<double> a = HostFamily(membranes_of(along_edge, strip.rest)).values(strip.deformed),
                            b = HostFamily(membranes_of(along_warp, strip.rest)).values(strip.deformed);
  EXPECT_GT(std::abs(a[3] - b[3]), 0.01 * b[3]);
  EXPECT_GT(b[3], 0);
}

// Along the first edges, the diagonal of one half would be warp and a side of the other.
TEST(Membranes, BothHalvesOfASquareHaveOneEnergyUnderOneStretch) {
  Positions rest(3, 4);
  rest << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  const std::vector<std::array<int, 3>> halves = {{0, 1, 2},
                                                  {2, 0, 3}};  // the second begins with the diagonal
  Positions x = rest;
  x.row(0) *= 1.2;
  x.row(1) *= 0.9;
  MembranePart part = membrane_part("baraff_witkin", halves);
  const std::vector<double> along_edge = HostFamily(membranes_of(part, rest)).values(x);
  part.warp.assign(2, Vec3d(1, 0, 0));
  const std::vector<double> along_axis = HostFamily(membranes_of(part, rest)).values(x);
  EXPECT_NEAR(along_axis[0], along_axis[1], 1e-16);
  EXPECT_NEAR(along_axis[0], 0.5 * 0.5 * (0.2 * 0.2 + 0.1 * 0.1), 1e-15);
  EXPECT_GT(std::abs(along_edge[0] - along_edge[1]), 1e-3);
  part.warp.pop_back();
  EXPECT_THROW(HostFamily(membranes_of(part, rest)), ConfigError);
}

TEST(Springs, StoresTheElementTerms) {
  const Strip strip(100);
  std::vector<double> k(strip.edges.size(), 3.0);
  k[5] = 4.0;
  expect_consistent(springs_of(strip.edges, strip.rest, k), strip.deformed);
  LocalTerms out;
  HostFamily(springs_of(strip.edges, strip.rest, k)).derivatives(strip.deformed, Projection::psd, out);
  const auto [a, b] = strip.edges[5];
  const Vec3d x[2] = {strip.deformed.col(a), strip.deformed.col(b)};
  const double rest_length = (strip.rest.col(b) - strip.rest.col(a)).norm();
  const auto terms = spring_terms<double>(x, 4.0, rest_length, Projection::psd);
  expect_stored(out, 5, terms.energy, terms.grad, terms.hess);
}

/// Angles [n] (rad) of hinges e0 e1 v0 v1 at x.
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
  HingePart part;
  HingeStrip() {
    part.hinges = strip.hinges;
    part.rest_angle = hinge_angles(strip.hinges, strip.rest);
    for (std::size_t e = 0; e < part.hinges.size(); ++e)
      part.stiffness.push_back(0.5 + 0.01 * static_cast<double>(e));
  }
  /// The first n hinges, beginning at `first`.
  HingePart cut(std::size_t first, std::size_t n) const {
    const auto of = [&](const auto& column) {
      return std::remove_cvref_t<decltype(column)>(&column[first], &column[first] + n);
    };
    HingePart out;
    out.hinges = of(part.hinges), out.stiffness = of(part.stiffness), out.rest_angle = of(part.rest_angle);
    return out;
  }
};

/// Four hinges run side by side, with the bits of one alone.
TEST(Hinges, StoresTheElementTerms) {
  const HingeStrip hinges;
  const Positions& x = hinges.strip.deformed;
  expect_consistent(hinges_of(hinges.part), x);
  const HostFamily family(hinges_of(hinges.part));
  LocalTerms out;
  family.derivatives(x, Projection::psd, out);
  for (std::size_t e = 0; e < family.size(); ++e) {
    const auto [e0, e1, v0, v1] = hinges.strip.hinges[e];
    const Vec3d points[4] = {x.col(e0), x.col(e1), x.col(v0), x.col(v1)};
    const auto terms =
        hinge_terms<double>(points, Projection::psd, hinges.part.stiffness[e], hinges.part.rest_angle[e]);
    EXPECT_EQ(out.energy[e], terms.energy);
    const Eigen::Map<const Vec<double, 12>> grad(&out.grad[12 * e]);
    const Eigen::MatrixXd hess = stored_hessian(out, e, 4);
    ASSERT_GT(terms.grad.norm(), 0);
    EXPECT_EQ(grad, terms.grad);
    EXPECT_EQ(hess, terms.hess);
  }
  const std::vector<double> at_rest = family.values(hinges.strip.rest);
  EXPECT_EQ(*std::max_element(at_rest.begin(), at_rest.end()), 0);
}

TEST(Hinges, AHingeDoesNotDependOnItsNeighboursInTheGroup) {
  HingeStrip hinges;
  const Positions& x = hinges.strip.deformed;
  const std::vector<double> angle = hinge_angles(hinges.strip.hinges, x);
  for (std::size_t e = 1; e < angle.size(); e += 3) hinges.part.rest_angle[e] = angle[e];  // exactly at rest
  LocalTerms all, part;
  HostFamily(hinges_of(hinges.part)).derivatives(x, Projection::psd, all);
  for (const std::size_t first : {1u, 2u, 3u}) {
    for (const std::size_t n : {1u, 2u, 3u, 5u, 8u}) {  // groups that are not full too
      const HingePart cut = hinges.cut(first, n);
      HostFamily(hinges_of(cut)).derivatives(x, Projection::psd, part);
      EXPECT_TRUE(std::equal(part.energy.begin(), part.energy.end(), &all.energy[first]));
      EXPECT_TRUE(std::equal(part.grad.begin(), part.grad.end(), &all.grad[12 * first]));
      EXPECT_TRUE(std::equal(part.hess.begin(), part.hess.end(), &all.hess[n_lower_numbers(4) * first]));
    }
  }
}

TEST(Families, BadInputIsAConfigError) {
  const Strip strip(3);
  const auto refused = [&](const auto& change) {
    MembranePart part = membrane_part("arap", strip.triangles);
    Positions rest = strip.rest;
    change(part, rest);
    EXPECT_THROW(HostFamily(membranes_of(part, rest)), ConfigError);
  };
  refused([](MembranePart& part, Positions&) { part.model = "corotationel"; });
  refused([](MembranePart& part, Positions&) { part.lame_mu.pop_back(); });
  refused([](MembranePart& part, Positions&) { part.shrink.resize(1, Vec2d(1, 1)); });
  refused([](MembranePart& part, Positions&) { part.creep.assign(part.triangles.size(), 1); });
  refused([](MembranePart&, Positions& rest) { rest.setZero(); });
  const MembranePart right = membrane_part("arap", strip.triangles);
  EXPECT_NO_THROW(HostFamily(membranes_of(right, strip.rest)));
  EXPECT_THROW(HostFamily(springs_of(strip.edges, strip.rest, {1})), ConfigError);
  HingePart hinges;
  hinges.hinges = strip.hinges, hinges.stiffness = hinges.rest_angle = {1};
  EXPECT_THROW((HostFamily(hinges_of(hinges))), ConfigError);
}

TEST(Families, EmptyIsAllowed) {
  const std::vector<std::array<int, 2>> none;
  const HostFamily family(springs_of(none, Positions(3, 0), {}));
  LocalTerms out;
  family.derivatives(Positions(3, 0), Projection::psd, out);
  EXPECT_EQ(family.size(), 0u);
  EXPECT_TRUE(out.hess.empty());
}

}  // namespace
}  // namespace bb::test::families_test
