// Stiffness of limited elements and what is reported of it, against closed forms: triangles in space and in the plane, tetrahedra.
#include <gtest/gtest.h>

#include "barriers/shapes/registry.hpp"
#include "core/barrier/folded_barrier.hpp"
#include "tests/barriers/limit_policies.hpp"
#include "tests/energy/limit_cases.hpp"

namespace bb::test::limit_stiffness_test {
namespace {

constexpr double dt = 0.05, c = 0.7, vertex_mass = 0.01;

BarrierFunction barrier_of(const char* shape) { return {require_shape(shape), Argument::gap}; }

/// A full symmetric elastic matrix, as an executor has it and element by element: every block and every number of one differs.
struct ElasticCase {
  std::vector<exec::Index> row_begin;
  std::vector<int> column;
  std::vector<double> value, gathered;

  /// Of degrees of freedom i and j, N/m. Diagonally dominant within an element.
  static double entry(int i, int j) {
    return (i == j ? 5 + 0.01 * i : 0) + 0.3 * std::sin(1.3 * std::min(i, j) + 0.7 * std::max(i, j));
  }
  ElasticCase(const LimitCase& of, std::size_t n_elements) {
    const auto n = static_cast<int>(of.rest.cols());
    value.assign(static_cast<std::size_t>(exec::value_count(n * n)), 0);
    for (int v = 0; v < n; ++v) {
      row_begin.push_back(n * v);
      for (int u = 0; u < n; ++u) {
        column.push_back(u);
        for (int k = 0; k < 9; ++k) {
          value[static_cast<std::size_t>(exec::value_index(n * v + u, k))] =
              entry(3 * v + k % 3, 3 * u + k / 3);
        }
      }
    }
    row_begin.push_back(n * n);
    for (std::size_t e = 0; e < n_elements; ++e) {
      const std::vector<int> dof = freedoms(of, e);
      for (const int j : dof) {
        for (const int i : dof) gathered.push_back(entry(i, j));
      }
    }
  }
  static std::vector<int> freedoms(const LimitCase& of, std::size_t e) {
    std::vector<int> out;
    for (const int v : of.vertices(e)) out.insert(out.end(), {3 * v, 3 * v + 1, 3 * v + 2});
    return out;
  }
  ElasticMatrix of_executor() const { return {{row_begin.data(), column.data(), value.data()}}; }
  ElasticMatrix of_elements() const { return {{}, gathered.data()}; }
};

/// w^T M w and w^T H w of an element, w its points from their centroid.
std::pair<double, double> sums_of(const LimitCase& of, std::size_t e) {
  const std::vector<int> corners = of.vertices(e), dof = ElasticCase::freedoms(of, e);
  Vec3d centroid = Vec3d::Zero();
  for (const int v : corners) centroid += of.x.col(v) / static_cast<double>(corners.size());
  std::vector<double> w;
  for (const int v : corners) {
    for (Eigen::Index k = 0; k < 3; ++k) w.push_back(of.x(k, v) - centroid[k]);
  }
  double mass = 0, elastic = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    mass += vertex_mass * w[i] * w[i];
    for (std::size_t j = 0; j < w.size(); ++j) elastic += w[i] * ElasticCase::entry(dof[i], dof[j]) * w[j];
  }
  return {mass, elastic};
}

/// Of the stretches of an element.
std::vector<double> gaps_of(const LimitCase& of, std::size_t e) {
  std::vector<double> out;
  for (const Long stretch : stretches_of(of, e))
    out.push_back(static_cast<double>(0.9L - ((stretch - 1) - 0.1L)));
  return out;
}

struct Made {
  HostLimit limit;
  std::vector<double> mass;
  Made(const LimitCase& of, const StiffnessPolicy& policy, const ElasticMatrix& elastic,
       exec::Order order = exec::Order::threads)
      : limit(of.make(order)), mass(static_cast<std::size_t>(of.rest.cols()), vertex_mass) {
    make(of, policy, elastic);
  }
  /// At x, which is the start of the step too.
  void make(const LimitCase& of, const StiffnessPolicy& policy, const ElasticMatrix& elastic) {
    limit.measure(of.x);
    limit->make_kappa(policy, {{dt, c}, of.x.data(), mass.data(), elastic});
  }
};

TEST(LimitStiffness, IsThatOfTheClosedForm) {
  for (const LimitCase& of : limit_cases(0.1, 0.9)) {
    SCOPED_TRACE(of.name);
    const std::size_t n = of.bands().width.size();
    const ElasticCase matrix(of, n);
    Made fixed(of, *fixed_limit(5), {});
    EXPECT_GT(fixed.limit.n_active(), 5u);
    for (std::size_t e = 0; e < n; ++e) EXPECT_EQ(fixed.limit.kappa()[e], 5 * fixed.limit->measure_of(e));
    for (const MassTerm term : {MassTerm::paper, MassTerm::inertia, MassTerm::scaled, MassTerm::none}) {
      const auto policy = elastic_limit({.mass_term = term}, 1.5);
      Made made(of, *policy, matrix.of_executor()), gathered(of, *policy, matrix.of_elements()),
          reverse(of, *policy, matrix.of_executor(), exec::Order::reverse);
      const std::vector<double> kappa = made.limit.kappa();
      EXPECT_EQ(gathered.limit.kappa(), kappa);
      EXPECT_EQ(reverse.limit.kappa(), kappa);
      for (std::size_t e = 0; e < n; ++e) {
        const auto [mass, elastic] = sums_of(of, e);
        const double y = made.limit.smallest_gap(e), inertia = mass / (c * dt * dt);
        double expected = elastic;
        if (term == MassTerm::paper) expected += of.bands().mass[e] / (y * y);
        if (term == MassTerm::inertia) expected += inertia;
        if (term == MassTerm::scaled) expected += inertia * 0.81 / (y * y);
        ASSERT_GT(elastic, 0);
        EXPECT_NEAR(kappa[e], 1.5 * expected, 1e-12 * expected);
      }
    }
  }
}

/// Evaluated at given pseudo-gaps, kappa is a number also where the policy has a potential, and uses none of the measured gaps.
TEST(LimitStiffness, IsToldAtGivenGaps) {
  for (const LimitCase& of : limit_cases(0.1, 0.9)) {
    SCOPED_TRACE(of.name);
    const std::size_t n = of.bands().width.size();
    const ElasticCase matrix(of, n);
    std::vector<double> gaps;
    for (std::size_t e = 0; e < n; ++e) gaps.push_back(0.2 + 0.01 * static_cast<double>(e));
    for (const KappaDerivative derivative : {KappaDerivative::dropped, KappaDerivative::included}) {
      const auto policy = elastic_limit({.refresh = Refresh::per_step, .derivative = derivative}, 1.5);
      Made made(of, *policy, matrix.of_elements());
      const std::vector<double> kappa =
          made.limit->kappa_at(gaps, *policy, {{dt, c}, of.x.data(), made.mass.data(), matrix.of_elements()});
      ASSERT_EQ(kappa.size(), n);
      for (std::size_t e = 0; e < n; ++e) {
        const double expected = sums_of(of, e).second + of.bands().mass[e] / (gaps[e] * gaps[e]);
        EXPECT_NEAR(kappa[e], 1.5 * expected, 1e-12 * expected);
      }
    }
  }
}

/// Of elements whose limit acts alone.
TEST(LimitStiffness, ChangeIsTheLargestOfAnActiveElement) {
  for (LimitCase of : limit_cases(0.1, 0.9)) {
    SCOPED_TRACE(of.name);
    const auto policy = elastic_limit({.elastic_term = false});
    Made made(of, *policy, {});
    std::vector<double> before = made.limit.kappa();
    for (std::size_t e = 0; e < before.size(); ++e) {
      if (!(made.limit.smallest_gap(e) < 0.95)) before[e] *= 10;
    }
    made.limit.set_kappa(before);
    of.x *= 1.02;
    made.make(of, *policy, {});
    const std::vector<double> kappa = made.limit.kappa();
    double expected = 0, of_all = 0;
    for (std::size_t e = 0; e < kappa.size(); ++e) {
      const double change = std::max(kappa[e], before[e]) / std::min(kappa[e], before[e]) - 1;
      of_all = std::max(of_all, change);
      if (made.limit.smallest_gap(e) < 0.9) expected = std::max(expected, change);
    }
    ASSERT_GT(expected, 1e-3);
    EXPECT_EQ(made.limit->kappa_change(), expected);
    EXPECT_GT(of_all, 2 * expected) << "a slack element changes more";
  }
}

/// kappa(y) b'(y), the force, is the derivative of the energy, and its derivative the curvature.
TEST(LimitStiffness, FoldedTermsAreThoseOfAKappaThatFollowsTheGap) {
  int judged = 0;
  for (const LimitCase& of : limit_cases(0.1, 0.9)) {
    for (const char* shape : {"cubic", "quadratic"}) {
      SCOPED_TRACE(of.name + " " + shape);
      const std::size_t n = of.bands().width.size();
      const ElasticCase matrix(of, n);
      const auto policy =
          elastic_limit({.refresh = Refresh::per_step, .derivative = KappaDerivative::included}, 1.7);
      Made made(of, *policy, matrix.of_executor()), by_batch(of, *policy, matrix.of_executor());
      BarrierFunction barrier = barrier_of(shape);
      const std::vector<double> energy = made.limit.values(of.x, barrier);
      barrier.shape.launches = nullptr;
      EXPECT_EQ(by_batch.limit.values(of.x, barrier), energy);
      EXPECT_EQ(made.limit.kappa(), std::vector<double>(n, 1));
      for (std::size_t e = 0; e < n; ++e) {
        const auto [mass, elastic] = sums_of(of, e);
        const auto b = [&](Long y) {  // b and the potential of b'/y^2 by the rule of Simpson, in long double
          const auto slope = [&](Long at) -> Long {
            const double near = static_cast<double>(at);
            return near >= 0.9 ? 0 : static_cast<Long>(barrier.eval(near, 0.9).db) / (at * at);
          };
          constexpr int parts = 2000;
          const Long h = (0.9L - y) / parts;
          Long sum = slope(y) + slope(0.9L);
          for (int i = 1; i < parts; ++i) sum += (i % 2 == 1 ? 4 : 2) * slope(y + h * i);
          return -sum * h / 3;
        };
        Long expected = 0;
        for (const double y : gaps_of(of, e)) {
          if (y >= 0.9) continue;
          expected += 1.7L * (static_cast<Long>(elastic) * static_cast<Long>(barrier.eval(y, 0.9).b) +
                              static_cast<Long>(of.bands().mass[e]) * b(y));
        }
        if (expected > 0) ++judged;
        EXPECT_NEAR(energy[e], static_cast<double>(expected), 1e-9 * static_cast<double>(expected));
      }
    }
  }
  EXPECT_GT(judged, 50);
}

TEST(LimitReports, AreOfTheLargestStretchAndLoadAndTheSmallestGap) {
  for (const LimitCase& of : limit_cases(0.1, 0.9)) {
    SCOPED_TRACE(of.name);
    const BarrierFunction barrier = barrier_of("cubic");
    HostLimit limit = of.make(exec::Order::shuffled);
    std::vector<double> kappa;
    for (std::size_t e = 0; e < limit.size(); ++e) kappa.push_back(1 + 0.1 * static_cast<double>(e));
    limit.set_kappa(kappa);
    limit.values(of.x, barrier);
    double stretch = 0, load = 0, gap = 1;
    for (std::size_t e = 0; e < limit.size(); ++e) {
      stretch = std::max(stretch, static_cast<double>(stretches_of(of, e)[0]));
      gap = std::min(gap, limit.smallest_gap(e) / 0.9);
      for (const double y : gaps_of(of, e)) {
        if (!(y < 0.9)) continue;
        load = std::max(load, -kappa[e] * barrier.eval(y, 0.9).db / limit->measure_of(e));
      }
    }
    ASSERT_GT(load, 0);
    const LimitReport report = limit.report();
    EXPECT_NEAR(report.max_stretch, stretch - 1, 1e-13);
    EXPECT_NEAR(report.load_max, load, 1e-11 * load);
    EXPECT_EQ(report.gap_min_rel, gap);
  }
}

}  // namespace
}  // namespace bb::test::limit_stiffness_test
