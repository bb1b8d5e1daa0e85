// Contacts in float and mixed precision: rows against a long double oracle, terms against those in double, and no
// pair rejected that is near when its distance is computed in float.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/contact/far_test.hpp"
#include "core/math/precision.hpp"
#include "tests/contact/contact_scenes.hpp"

namespace bb::test::float_contacts_test {
namespace {

constexpr double float_eps = std::numeric_limits<float>::epsilon();

bool is_float(double x) { return static_cast<double>(static_cast<float>(x)) == x; }

ContactOptions options_in(Precision precision) {
  ContactOptions options;
  options.precision = precision;
  return options;
}

/// Two soups of triangles away from the origin, all coordinates floats.
Scene float_soups(const Vec3d& where) {
  Scene scene;
  for (const unsigned seed : {1U, 2U}) {
    auto [vertices, triangles] = soup(120, 0.2, seed);
    for (Vec3d& p : vertices) p += where;
    add_body(scene, seed == 1 ? "a" : "b", vertices, triangles, 0.3);
  }
  for (const auto& t : scene.surface_triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      scene.surface_edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
    }
  }
  round_state(Precision::single, scene.x0);
  scene.rest = scene.x0;
  return scene;
}

/// Distance of the feature of a row, whose closest points are inside it, in long double.
double exact_distance(const ContactTable& rows, std::size_t r, const Positions& x) {
  using L = long double;
  const int* s = &rows.stencil[4 * r];
  const auto points = [&]<int N>() {
    Mat<L, 3, N> out;
    for (int k = 0; k < N; ++k) out.col(k) = x.col(s[k]).cast<L>();
    return out;
  };
  switch (rows.kind[r]) {
    case ContactKind::point_point:
      return static_cast<double>(closest_points<PairKind::point_point, L>(points.operator()<2>()).d);
    case ContactKind::point_edge:
      return static_cast<double>(closest_points<PairKind::point_edge, L>(points.operator()<3>()).d);
    case ContactKind::point_triangle:
      return static_cast<double>(closest_points<PairKind::point_triangle, L>(points.operator()<4>()).d);
    default:
      return static_cast<double>(closest_points<PairKind::edge_edge, L>(points.operator()<4>()).d);
  }
}

TEST(FloatContacts, rows_in_float_have_the_distance_of_long_double_to_the_rounding_of_the_pair) {
  for (const Vec3d& where : {Vec3d(0, 0, 0), Vec3d(100, -50, 3)}) {
    const Scene scene = float_soups(where);
    ContactSystem in_float(scene, options_in(Precision::single)), in_double(scene, {});
    const Rows rows = rows_at(in_float, scene.x0), full = rows_at(in_double, scene.x0);
    ASSERT_GT(rows.table.size(), 300U);
    EXPECT_NEAR(static_cast<double>(rows.table.size()), static_cast<double>(full.table.size()), 3);
    int rounded = 0;
    for (std::size_t r = 0; r < rows.table.size(); ++r) {
      EXPECT_TRUE(is_float(rows.table.d[r]));
      // differences of float coordinates are exact to an ulp of the pair, which is at most 1 m wide
      const double exact = exact_distance(rows.table, r, scene.x0);
      EXPECT_NEAR(rows.table.d[r], exact, 16 * float_eps) << r;
      rounded += rows.table.d[r] == exact ? 0 : 1;
    }
    EXPECT_GT(rounded, 200);  // computed in float indeed
  }
}

/// Edges whose distance is the contact distance to a few ulps of float.
TEST(FloatContacts, no_test_rejects_a_pair_that_is_near_in_float) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3d(unit(rng), unit(rng), unit(rng)); };
  int near = 0, lost_in_double = 0;
  for (int i = 0; i < 4000; ++i) {
    Scene scene;
    const Vec3d from = (i % 2 == 0 ? 1.0 : 30.0) * point(), shift = 0.05 * point();
    add_body(scene, "a", {from, Vec3d(from + point())}, {}, 1);
    add_body(scene, "b", {Vec3d(from + shift), Vec3d(from + shift + point())}, {}, 1);
    scene.surface_edges = {{0, 1}, {2, 3}};
    round_state(Precision::single, scene.x0);
    scene.rest = scene.x0;
    const float d = closest_points<PairKind::edge_edge, float>(scene.x0.cast<float>()).d;
    if (!(d > 0)) continue;
    // the next float above the distance: in float the pair is just inside
    scene.d_hat.assign(4, static_cast<double>(std::nextafter(d, 1.0F)));
    const auto finds = [&](Precision precision) {
      ContactSystem contacts(scene, options_in(precision));
      const Rows rows = rows_at(contacts, scene.x0);
      return rows.table.size() + rows.mollified.size() > 0;
    };
    ++near;
    EXPECT_TRUE(finds(Precision::single)) << i;
    lost_in_double += finds(Precision::full) ? 0 : 1;
  }
  EXPECT_GT(near, 3000);
  EXPECT_GT(lost_in_double, 300);  // so close to d_hat that double and float do not agree on which side
}

/// Far from the origin a state on a motion is rounded by more than the motion itself: candidates have to reach it.
TEST(FloatContacts, candidates_reach_the_states_that_a_motion_is_rounded_to) {
  const double ulp = 0x1p-13;  // m, of float at 1024
  Scene scene = point_over_grid(Vec3d(1.3, 1.4, 8 * ulp), 7.1 * ulp);
  scene.x0.row(2).array() += 1024;
  Positions x1 = scene.x0;
  x1(2, 25) -= 0.8 * ulp;
  Positions state = scene.x0 + 0.7 * (x1 - scene.x0);
  round_state(Precision::single, state);
  ASSERT_EQ(state(2, 25), 1024 + 7 * ulp);  // nearer than any point of the motion
  ContactSystem contacts(scene, options_in(Precision::single));
  contacts.update_candidates(scene.x0, x1);
  Rows rows;
  EXPECT_EQ(contacts.find_rows(state, rows.table, rows.mollified), 7 * ulp);
  EXPECT_EQ(rows.table.size(), 1U);
}

template <class Numbers>
double difference(const Numbers& a, const Numbers& b) {
  double largest = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
    size = std::max(size, std::abs(b[i]));
  }
  return largest / size;
}

TEST(FloatContacts, mixed_terms_have_the_gradients_of_double_and_the_hessians_of_float) {
  const Scene scene = float_soups(Vec3d::Zero());
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, scene.x0);
  evaluate(rows.table, 3, TestShape::cubic);
  evaluate(rows.mollified, 3, TestShape::cubic);
  ASSERT_GT(rows.table.size(), 300U);
  ASSERT_GT(rows.mollified.size(), 0U);
  struct Terms {
    std::vector<double> grad, hess, mollified_grad, mollified_hess, energy;
  };
  const auto in = [&](Precision precision) {
    Terms t;
    contact_terms(rows.table, scene.x0, HessianMode::projected_full, Projection::psd, t.grad, t.hess,
                  precision);
    mollified_terms(rows.mollified, scene.x0, Projection::psd, t.mollified_grad, t.mollified_hess, precision);
    contact_energies(rows.table, t.energy, precision);
    return t;
  };
  const Terms full = in(Precision::full), mixed = in(Precision::mixed), single = in(Precision::single);
  EXPECT_EQ(mixed.grad, full.grad);
  EXPECT_EQ(mixed.mollified_grad, full.mollified_grad);
  EXPECT_EQ(mixed.energy, full.energy);
  EXPECT_EQ(mixed.hess, single.hess);
  EXPECT_EQ(mixed.mollified_hess, single.mollified_hess);
  for (const double off :
       {difference(single.grad, full.grad), difference(single.hess, full.hess),
        difference(single.mollified_hess, full.mollified_hess), difference(single.energy, full.energy)}) {
    EXPECT_GT(off, 0);
    EXPECT_LT(off, 1e-4);
  }
  EXPECT_TRUE(std::all_of(single.hess.begin(), single.hess.end(), is_float));
}

TEST(FloatContacts, the_step_bound_stops_at_the_ulps_of_the_coordinates_in_float) {
  for (const double far : {0.0, 1e3}) {
    Scene scene = point_over_grid(Vec3d(1.3, 1.4, 0.5), 1e-3);
    scene.x0.colwise() += Vec3d(far, 0, 0);
    round_state(Precision::single, scene.x0);
    Positions x1 = scene.x0;
    x1(2, 25) -= 1;
    ContactSystem in_float(scene, options_in(Precision::single)), in_double(scene, {});
    const auto gap_at_bound = [&](ContactSystem& contacts) {
      contacts.update_candidates(scene.x0, x1);
      const StepBound bound = contacts.step_bound(scene.x0, x1);
      EXPECT_GT(bound.alpha, 0);
      EXPECT_LT(bound.alpha, 0.5);
      return 0.5 - bound.alpha;
    };
    const double largest = far + 2;  // m, of a coordinate of the pair
    EXPECT_GT(gap_at_bound(in_float), 15 * float_eps * largest);
    EXPECT_LT(gap_at_bound(in_float), 40 * float_eps * largest);
    EXPECT_LT(gap_at_bound(in_double), 1e-8);
  }
}

}  // namespace
}  // namespace bb::test::float_contacts_test
