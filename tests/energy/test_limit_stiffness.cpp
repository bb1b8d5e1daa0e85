// Stiffness of limited elements and what is said of it, against closed forms: triangles in space and in the plane, tetrahedra.
#include <gtest/gtest.h>

#include "barriers/shapes/registry.hpp"
#include "core/barrier/folded_barrier.hpp"
#include "tests/barriers/limit_policies.hpp"
#include "tests/energy/limit_cases.hpp"

namespace bb::test::limit_stiffness_test {
namespace {

constexpr double dt = 0.05, c = 0.7, vertex_mass = 0.01;

BarrierFunction barrier_of(const char* shape) { return {require_shape(shape), Argument::gap}; }

/// An elastic matrix with a multiple of the identity at each vertex and nothing else, as an executor has it and element by element.
struct DiagonalMatrix {
  std::vector<exec::Index> row_begin;
  std::vector<int> column;
  std::vector<double> value, gathered;

  static double entry(int vertex) { return 1 + 0.1 * vertex; }
  DiagonalMatrix(const LimitCase& of, std::size_t n_elements) {
    const auto n = static_cast<int>(of.rest.cols());
    value.assign(static_cast<std::size_t>(resident::value_count(n)), 0);
    for (int v = 0; v < n; ++v) {
      row_begin.push_back(v), column.push_back(v);
      for (int k = 0; k < 3; ++k) value[static_cast<std::size_t>(resident::value_index(v, 4 * k))] = entry(v);
    }
    row_begin.push_back(n);
    for (std::size_t e = 0; e < n_elements; ++e) {
      const std::vector<int> corners = of.vertices(e);
      const std::size_t size = 3 * corners.size();
      for (std::size_t i = 0; i < size * size; ++i)
        gathered.push_back(i % (size + 1) == 0 ? entry(corners[i / (size + 1) / 3]) : 0);
    }
  }
  ElasticMatrix of_executor() const { return {{row_begin.data(), column.data(), value.data()}}; }
  ElasticMatrix of_elements() const { return {{}, gathered.data()}; }
};

/// w^T M w and w^T H w of an element, w its points from their centroid.
std::pair<double, double> sums_of(const LimitCase& of, std::size_t e) {
  const std::vector<int> corners = of.vertices(e);
  Vec3d centroid = Vec3d::Zero();
  for (const int v : corners) centroid += of.x.col(v) / static_cast<double>(corners.size());
  double mass = 0, elastic = 0;
  for (const int v : corners) {
    const double w_sq = (of.x.col(v) - centroid).squaredNorm();
    mass += vertex_mass * w_sq;
    elastic += DiagonalMatrix::entry(v) * w_sq;
  }
  return {mass, elastic};
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
    const DiagonalMatrix matrix(of, n);
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
        EXPECT_NEAR(kappa[e], 1.5 * expected, 1e-13 * expected);
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
      const DiagonalMatrix matrix(of, n);
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
        for (std::size_t k = 0; k < made.limit.stretches(); ++k) {
          const double y = made.limit.gap(e, k);
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
      stretch = std::max(stretch, limit.sigma(e));
      gap = std::min(gap, limit.smallest_gap(e) / 0.9);
      for (std::size_t k = 0; k < limit.stretches(); ++k) {
        if (!(limit.gap(e, k) < 0.9)) continue;
        load = std::max(load, -kappa[e] * barrier.eval(limit.gap(e, k), 0.9).db / limit->measure_of(e));
      }
    }
    ASSERT_GT(load, 0);
    limit->announce();
    const LimitReport report = limit->report();
    EXPECT_EQ(report.max_stretch, stretch - 1);
    EXPECT_EQ(report.load_max, load);
    EXPECT_EQ(report.gap_min_rel, gap);
  }
}

}  // namespace
}  // namespace bb::test::limit_stiffness_test
