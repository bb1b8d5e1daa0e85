// Pairs that share a closest feature count once: closed forms over fans, total force of flat sheets, derivatives.
#include <gtest/gtest.h>

#include <cmath>

#include "core/contact/contact_terms.hpp"
#include "core/geometry/closest_points.hpp"
#include "tests/contact/barrier_gradient.hpp"

namespace bb::test::pair_corrections_test {
namespace {

constexpr double d_hat = 0.3;

ContactOptions weighted(ContactWeighting weighting) {
  ContactOptions options;
  options.weighting = weighting;
  return options;
}

/// kappa = share, b = (d_hat - d)^3/d_hat.
template <class Table>
void evaluate_shares(Table& t) {
  evaluate(t, 1, TestShape::cubic);
  t.kappa = t.share;
}

struct Sum {
  double energy = 0;
  VecXd gradient;
  std::size_t rows = 0, below_zero = 0, mollified = 0;
};

Sum sum_at(ContactSystem& contacts, const Positions& x) {
  Rows rows = rows_at(contacts, x);
  evaluate_shares(rows.table);
  evaluate_shares(rows.mollified);
  Sum out{energy_of(rows, x), gradient_of(rows, x)};
  out.rows = rows.table.size();
  out.mollified = rows.mollified.size();
  for (const double share : rows.table.share) out.below_zero += share < 0 ? 1 : 0;
  return out;
}

/// Central differences of the sum, by the ladder of steps the best.
double gradient_error(ContactSystem& contacts, const Positions& x, const VecXd& gradient) {
  double best = 1e300;
  for (const double h : {1e-4, 1e-5, 1e-6}) {
    double worst = 0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Positions a = x, b = x;
      a.data()[i] += h, b.data()[i] -= h;
      const double slope = (sum_at(contacts, a).energy - sum_at(contacts, b).energy) / (2 * h);
      worst = std::max(worst, std::abs(slope - gradient[i]));
    }
    best = std::min(best, worst);
  }
  return best / gradient.cwiseAbs().maxCoeff();
}

/// A point over a fan of n triangles round vertex 0, whose middle is `height` above its rim; it belongs to a small triangle
/// that is far above otherwise, which gives it an area.
Scene point_over_fan(int n, double height, const Vec3d& p) {
  Scene scene;
  std::vector<Vec3d> vertices{Vec3d(0, 0, height)};
  Triangles triangles;
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * M_PI * (k + 0.1) / n;
    vertices.push_back(Vec3d(std::cos(angle), std::sin(angle), 0));
    triangles.push_back({0, k + 1, (k + 1) % n + 1});
  }
  add_body(scene, "fan", vertices, triangles, d_hat);
  add_body(scene, "point", {p, p + Vec3d(0.01, 0, 2), p + Vec3d(0, 0.01, 2)}, {{0, 1, 2}}, d_hat);
  return scene;
}

double b_of(double d) { return d < d_hat ? std::pow(d_hat - d, 3) / d_hat : 0; }

double distance_to_edge(const Positions& x, const Vec3d& p, int e0, int e1) {
  Mat<double, 3, 3> points;
  points << p, x.col(e0), x.col(e1);
  return closest_point_edge<double>(points).d;
}

/// What the sum is once nothing counts twice: a quarter of the area of the point times b of its distance from the fan, as
/// much of the hub and of each side of the fan, which meet the point alone, and of the two edges of the point b of the spokes less that
/// of the hub for all spokes but one.
double closed_form(const Scene& scene, const PairAreas& areas, int n) {
  const Positions& x = scene.x0;
  const int point = n + 1;
  const Vec3d p = x.col(point);
  double nearest = 10, of_sides = 0, of_spokes = 0;
  for (int k = 0; k < n; ++k) {
    Mat<double, 3, 4> points;
    points << p, x.col(0), x.col(k + 1), x.col((k + 1) % n + 1);
    nearest = std::min(nearest, closest_point_triangle<double>(points).d);
  }
  // edges are sorted by their vertices: the spokes, the rim, then those of the point
  for (int k = 0; k < n; ++k) {
    const double b = b_of(distance_to_edge(x, p, 0, k + 1));
    of_spokes += b;
    of_sides += areas.of_edge(k) * b;
  }
  of_spokes -= (n - 1) * b_of((p - x.col(0)).norm());
  const double of_hub =
      areas.of_point(0) * b_of((p - x.col(0)).norm());  // the triangle of the point meets it there
  return (areas.of_point(point) * b_of(nearest) + of_hub + of_sides +
          (areas.of_edge(2 * n) + areas.of_edge(2 * n + 1)) * of_spokes) /
         4;
}

TEST(PairCorrections, APointOverAFanCountsOnce) {
  for (const int n : {3, 5, 6, 9}) {
    for (const double height : {0.0, 0.4}) {
      for (const Vec3d& aside : {Vec3d(0.2, 0.15, 0), Vec3d(0.02, 0.01, 0), Vec3d(1e-4, -2e-4, 0),
                                 Vec3d(-0.2, 0.1, 0), Vec3d(0.05, -0.2, 0)}) {
        const Scene scene = point_over_fan(n, height, aside + Vec3d(0, 0, height + 0.13));
        ContactSystem corrected(scene, weighted(ContactWeighting::area_corrected)),
            area(scene, weighted(ContactWeighting::area));
        const Sum sum = sum_at(corrected, scene.x0);
        ASSERT_GT(sum.rows, 0u);
        const double known = closed_form(scene, *corrected.areas(), n);
        EXPECT_GT(known, 0);
        EXPECT_NEAR(sum.energy, known, 1e-12 * known) << n << " " << height << " " << aside.transpose();
        EXPECT_GT(sum_at(area, scene.x0).energy, 1.2 * known) << "without corrections features count often";
      }
    }
  }
}

/// Two flat sheets, the upper one turned so that no vertices and edges lie over each other: each of its vertices has one row
/// over the lower sheet, with a quarter of its area, wherever it is over the mesh there.
TEST(PairCorrections, VerticesOverAFlatMeshHaveTheirAreaOnce) {
  for (const int n : {3, 6}) {
    Scene scene;
    const auto [low, triangles] = grid(8, 8, 0.5, Vec3d(-2, -2, 0));
    add_body(scene, "low", low, triangles, d_hat);
    auto [high, upper] = grid(n, n, 2.0 / n);
    const double c = std::cos(0.3), s = std::sin(0.3);
    for (Vec3d& v : high) v = Vec3d(c * v[0] - s * v[1] - 0.61, s * v[0] + c * v[1] - 0.93, 0.17);
    add_body(scene, "high", high, upper, d_hat);
    ContactSystem contacts(scene, weighted(ContactWeighting::area_corrected));
    Rows rows = rows_at(contacts, scene.x0);
    double vertices = 0, area = 0;
    int n_low = static_cast<int>(low.size());
    for (std::size_t r = 0; r < rows.table.size(); ++r) {
      if (rows.table.kind[r] != ContactKind::point_triangle || rows.table.stencil[4 * r] < n_low) continue;
      EXPECT_NEAR(rows.table.d[r], 0.17, 1e-12);
      vertices += rows.table.share[r];
    }
    for (int i = 0; i < scene.n_vertices() - n_low; ++i) area += contacts.areas()->of_point(n_low + i);
    EXPECT_NEAR(area, 4, 1e-12);
    EXPECT_NEAR(vertices, area / 4, 1e-12);
    // the rest are the crossings of edges: rows at shared features have gone
    for (std::size_t r = 0; r < rows.table.size(); ++r) {
      if (rows.table.kind[r] == ContactKind::point_triangle || rows.table.kind[r] == ContactKind::edge_edge)
        continue;
      EXPECT_GT(rows.table.d[r], 0.17 + 1e-9);
    }
  }
}

/// The force of two flat sheets, the upper one turned, over b' and the area of the upper one: half of it by vertices, as much
/// or a little more by edges, whatever the mesh is. Without corrections it grows with the number of features within reach.
TEST(PairCorrections, TotalForceOfFlatSheetsSettlesWithTheMesh) {
  constexpr double reach = 0.1, gap = 0.05;
  std::vector<double> corrected, uncorrected;
  for (const int n : {8, 16, 32}) {
    Scene scene;
    const double h = 4.0 / n;
    const auto [low, triangles] = grid(n, n, h, Vec3d(-2, -2, 0));
    add_body(scene, "low", low, triangles, reach);
    auto [high, upper] = grid(n / 2, n / 2, h);
    const double c = std::cos(0.3), s = std::sin(0.3);
    for (Vec3d& v : high) v = Vec3d(c * v[0] - s * v[1] - 0.61, s * v[0] + c * v[1] - 0.93, gap);
    add_body(scene, "high", high, upper, reach);
    for (const auto weighting : {ContactWeighting::area_corrected, ContactWeighting::area}) {
      ContactSystem contacts(scene, weighted(weighting));
      const Sum sum = sum_at(contacts, scene.x0);
      ASSERT_GT(sum.rows, 20u);
      double force = 0;
      for (int v = static_cast<int>(low.size()); v < scene.n_vertices(); ++v)
        force -= sum.gradient[3 * v + 2];
      const double alone = 3 * (reach - gap) * (reach - gap) / reach * 4;  // b' on the four square metres
      (weighting == ContactWeighting::area ? uncorrected : corrected).push_back(force / alone);
    }
  }
  for (std::size_t k = 1; k < corrected.size(); ++k) {
    EXPECT_NEAR(corrected[k], corrected[k - 1], 0.06 * corrected[k]) << k;
    EXPECT_GT(uncorrected[k], 1.05 * uncorrected[k - 1]) << k;
  }
  EXPECT_GT(corrected[0], 1);
  EXPECT_LT(corrected[2], 2);
}

TEST(PairCorrections, GradientIsThatOfTheEnergy) {
  Scene scene;
  const auto [low, triangles] = grid(3, 3, 0.7);
  add_body(scene, "low", low, triangles, d_hat);
  const auto [high, upper] = grid(3, 3, 0.6, Vec3d(0.05, 0.1, 0.12));
  add_body(scene, "high", high, upper, d_hat);
  ContactSystem contacts(scene, weighted(ContactWeighting::area_corrected));
  for (const double size : {0.02, 0.08}) {
    const Positions x = random_motion(scene.x0, size, 5);
    const Sum sum = sum_at(contacts, x);
    ASSERT_GT(sum.rows, 20u);
    ASSERT_GT(sum.below_zero, 0u);
    ASSERT_GT(sum.mollified, 3u);
    EXPECT_LT(gradient_error(contacts, x, sum.gradient), 2e-7) << size;
  }
}

/// Two equal sheets, one exactly over the other: all of their edges that lie over each other are mollified away, and their
/// ends are not taken back more often than what is left of them.
TEST(PairCorrections, AlignedSheetsPushEachOtherApart) {
  for (const double turn : {0.0, 1e-4, 0.01, 0.03, 0.06, 0.3}) {
    Scene scene;
    const auto [low, triangles] = grid(4, 4, 1.0);
    add_body(scene, "low", low, triangles, d_hat);
    auto [high, upper] = grid(4, 4, 1.0, Vec3d(0, 0, 0.1));
    const double c = std::cos(turn), s = std::sin(turn);
    for (Vec3d& v : high)
      v = Vec3d(c * (v[0] - 2) - s * (v[1] - 2) + 2, s * (v[0] - 2) + c * (v[1] - 2) + 2, v[2]);
    add_body(scene, "high", high, upper, d_hat);
    ContactSystem contacts(scene, weighted(ContactWeighting::area_corrected));
    const Sum sum = sum_at(contacts, scene.x0);
    double force = 0;
    for (int v = 25; v < 50; ++v) force -= sum.gradient[3 * v + 2];
    const double alone = 3 * 0.2 * 0.2 / d_hat * 16;  // of b' on all of the area
    EXPECT_GT(force, 0.5 * alone);
    EXPECT_LT(force, 2 * alone);
  }
}

/// Rows of what rests close to itself have a d_hat of their own and are not corrected.
TEST(PairCorrections, PairsOfTheRestRuleStayAsTheyAre) {
  Scene scene;
  const auto [vertices, triangles] = grid(6, 2, 0.25);
  add_body(scene, "sheet", vertices, triangles, 0.8);
  Positions x = scene.x0;
  x.row(0) *= 0.45;
  ContactSystem plain(scene, weighted(ContactWeighting::area)),
      corrected(scene, weighted(ContactWeighting::area_corrected));
  const Rows before = rows_at(plain, x), after = rows_at(corrected, x);
  ASSERT_GT(before.table.size(), 10u);
  double sum_before = 0, sum_after = 0;
  for (std::size_t r = 0; r < before.table.size(); ++r)
    sum_before += before.table.d_hat[r] < 0.8 ? before.table.share[r] : 0;
  for (std::size_t r = 0; r < after.table.size(); ++r)
    sum_after += after.table.d_hat[r] < 0.8 ? after.table.share[r] : 0;
  EXPECT_GT(sum_before, 0);
  EXPECT_NEAR(sum_before, sum_after, 1e-12 * sum_before);
}

TEST(PairCorrections, OtherWeightsAreAsTheyWere) {
  Scene scene = point_over_fan(6, 0, Vec3d(0.02, 0.01, 0.1));
  ContactSystem none(scene, {}), area(scene, weighted(ContactWeighting::area));
  const Rows a = rows_at(none, scene.x0), b = rows_at(area, scene.x0);
  ASSERT_GT(a.table.size(), 6u);
  EXPECT_TRUE(a.table.share.empty() && a.mollified.share.empty());
  EXPECT_EQ(a.table.pair, b.table.pair);
  for (std::size_t r = 0; r < b.table.size(); ++r)
    EXPECT_EQ(b.table.share[r], area.areas()->of(b.table.pair[r]));
}

}  // namespace
}  // namespace bb::test::pair_corrections_test
