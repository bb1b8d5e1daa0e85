// The strain limit of a whole mesh, of triangles and tetrahedra, on host executors of every order: columns, terms, step bound.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "barriers/shapes/registry.hpp"
#include "core/energy/families/limit_kernels.hpp"
#include "core/math/error.hpp"
#include "tests/energy/energy_cases.hpp"
#include "tests/energy/limit_cases.hpp"
#include "tests/energy/strain_shapes.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::limit_family_test {
namespace {

BarrierFunction barrier_of(const char* shape) { return {require_shape(shape), Argument::gap}; }
/// The same by the shape's batch call, as a shape of a plugin is evaluated.
BarrierFunction without_kernels(BarrierFunction barrier) {
  barrier.shape.launches = nullptr;
  return barrier;
}

/// 5 N/m or Pa times area or volume.
void make_stiff(HostLimit& limit) {
  std::vector<double> kappa;
  for (std::size_t e = 0; e < limit.size(); ++e) kappa.push_back(5 * limit->measure_of(e));
  limit.set_kappa(kappa);
}

/// Slack elements too.
void expect_active(const HostLimit& limit) {
  EXPECT_GT(limit.n_active(), 5u);
  EXPECT_LT(limit.n_active(), limit.size());
  EXPECT_GT(limit.min_gap(), 0);
}

Long gap_of(Long stretch) { return 0.9L - ((stretch - 1) - 0.1L); }

TEST(LimitFamily, EnergiesAreThoseOfTheStretchesInLongDouble) {
  for (const LimitCase& of : limit_cases(0.1, 0.9)) {
    SCOPED_TRACE(of.name);
    HostLimit limit = of.make();
    make_stiff(limit);
    const std::vector<double> energy = limit.values(of.x, barrier_of("log"));
    expect_active(limit);
    EXPECT_NEAR(limit.min_gap(), 0.9 - (limit.report().max_stretch - 0.1), 1e-15);
    Long volume = 0;
    for (std::size_t e = 0; e < limit.size(); ++e) {
      const std::vector<Long> stretch = stretches_of(of, e);
      ASSERT_EQ(stretch.size(), limit->vertices().size() / limit.size() - 1);
      Long sum = 0;
      for (const Long each : stretch) sum += LogStandIn{}(gap_of(each), 0.9L).b;
      EXPECT_NEAR(limit.smallest_gap(e), static_cast<double>(gap_of(stretch[0])), 1e-13);
      const double expected = static_cast<double>(5 * static_cast<Long>(limit->measure_of(e)) * sum);
      EXPECT_NEAR(energy[e], expected, 1e-12 * expected);
      EXPECT_EQ(energy[e] > 0, stretch[0] > 1.1L) << e;
      volume += static_cast<Long>(limit->measure_of(e));
    }
    if (!of.of_solids()) continue;
    EXPECT_NEAR(static_cast<double>(volume), 0.096, 1e-15);
  }
}

/// All that a family reports of a state and a motion.
struct Said {
  std::vector<double> gaps, energy, alpha, columns;
  LocalTerms terms;
  std::vector<double> report;
  bool operator==(const Said& other) const {
    return gaps == other.gaps && energy == other.energy && alpha == other.alpha && columns == other.columns &&
           terms.energy == other.terms.energy && terms.grad == other.terms.grad &&
           terms.hess == other.terms.hess && report == other.report;
  }
};

Said said_by(HostLimit limit, const LimitCase& of, const BarrierFunction& barrier) {
  Said out;
  make_stiff(limit);
  out.terms = limit.derivatives(of.x, barrier);
  out.energy = limit.values(of.x, barrier);
  for (std::size_t e = 0; e < limit.size(); ++e) out.gaps.push_back(limit.smallest_gap(e));
  for (const double park : {0.0, 1e-3}) {
    out.alpha.push_back(limit.step_bound(of.rest, Positions(30 * (of.x - of.rest)), 1, park));
  }
  const auto n = static_cast<exec::Index>(limit.size());
  const auto size = static_cast<std::size_t>(3 * limit->width());
  out.columns.resize(size * limit.size());
  limit->gradients({0, n}, of.x.data(), out.energy.data(), out.columns.data());
  const LimitReport report = limit.report();
  out.report = {report.max_stretch, report.load_max, report.gap_min_rel};
  return out;
}

/// Threads, orders, a launch of a shape's kernels or of its batch call, and terms in columns or element by element.
TEST(LimitFamily, BitsDependOnNothingButTheState) {
  for (const LimitCase& of : limit_cases(0.1, 0.9)) {
    for (const char* shape : {"log", "cubic", "quadratic", "two_stage", "minimax"}) {
      SCOPED_TRACE(of.name + " " + shape);
      for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
        BarrierFunction barrier = barrier_of(shape);
        barrier.argument = argument;
        const Said all = said_by(of.make(), of, barrier);
        ASSERT_GT(*std::max_element(all.energy.begin(), all.energy.end()), 0);
        ASSERT_LT(all.alpha[0], 1);
        for (const exec::Order order : {exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
          EXPECT_EQ(said_by(of.make(order), of, barrier), all);
          EXPECT_EQ(said_by(of.make(order), of, without_kernels(barrier)), all);
        }
        const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
        EXPECT_EQ(said_by(of.make(), of, barrier), all);
        EXPECT_EQ(said_by(of.make(), of, without_kernels(barrier)), all);
        const std::size_t n = of.bands().width.size(), size = all.columns.size() / n;
        for (std::size_t i = 0; i < all.columns.size(); ++i)
          EXPECT_EQ(all.columns[i], all.terms.grad[size * (i % n) + i / n]);
      }
    }
  }
}

/// Triangles within some roundings of where their limit begins to act, which is another place in float than in double.
TEST(LimitFamily, WhatIsLeftOutAsSlackHasNoTermsInEitherScalar) {
  constexpr exec::Index n = 4000;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<int> vertices;
  std::vector<double> x, inverse(4 * n, 0), area(n, 0.5), onset(n, 0.1), width(n, 0.9), kappa(n, 3),
      state(10 * n);
  for (exec::Index e = 0; e < n; ++e) {
    inverse[static_cast<std::size_t>(e)] = inverse[static_cast<std::size_t>(3 * n + e)] = 1;
    const Mat3d turn = (1.1 + 3e-7 * any(random)) * random_rotation(random);
    for (const Vec3d& at : {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 0.8, 0)}) {
      const Vec3d to = turn * at;
      x.insert(x.end(), to.data(), to.data() + 3);
    }
  }
  for (int k = 0; k < 3; ++k) {
    for (int e = 0; e < n; ++e) vertices.push_back(3 * e + k);
  }
  SpaceLimit limit;
  limit.of = vertices.data(), limit.n = n;
  limit.rest = {inverse.data(), area.data()};
  limit.onset = onset.data(), limit.band_width = width.data(), limit.kappa = kappa.data();
  double* column = state.data();
  for (double** of : {&limit.sigma, &limit.gap, &limit.b, &limit.db, &limit.d2b})
    *of = column, column += 2 * n;
  std::fill(limit.b, limit.d2b + 2 * n, 0.7);
  exec::HostExecutor executor;
  executor.each(n, MeasureStretch<3, 2>{limit, x.data()});
  LocalTerms out;
  const auto count = [&]<class T>(T) {
    out.resize(n, 3);
    executor.each(n, ElementLocalTerms<SpaceLimit, T>{limit, Projection::psd, PassParts{true, true}, x.data(),
                                                      out.energy.data(), out.grad.data(), out.hess.data()});
    int acting = 0;
    for (exec::Index e = 0; e < n; ++e) {
      const auto terms = limit.terms<T>(x.data(), e, Projection::psd);
      const auto i = static_cast<std::size_t>(e);
      EXPECT_EQ(out.energy[i], terms.energy);
      for (std::size_t k = 0; k < 9; ++k) EXPECT_EQ(out.grad[9 * i + k], terms.grad[static_cast<int>(k)]);
      EXPECT_EQ(out.hess[n_lower_numbers(3) * i], terms.hess(0, 0));
      acting += terms.energy != 0;
    }
    return acting;
  };
  const int in_double = count(1.0), in_float = count(1.0F);
  EXPECT_GT(in_double, n / 4);
  EXPECT_LT(in_double, 3 * n / 4);
  EXPECT_GT(in_float, n / 4);
  EXPECT_LT(in_float, 3 * n / 4);
  EXPECT_NE(in_float, in_double);
}

/// Elements that are slack have exact zeros; the others have the derivatives of the sum of energies.
TEST(LimitFamily, TermsAreTheDerivativesOfTheEnergies) {
  for (const LimitCase& of : limit_cases(0.1, 0.9)) {
    SCOPED_TRACE(of.name);
    const BarrierFunction barrier = barrier_of("log");
    HostLimit limit = of.make();
    make_stiff(limit);
    const LocalTerms terms = limit.derivatives(of.x, barrier, Projection::none);
    const auto size = static_cast<std::size_t>(3 * limit->width());
    std::size_t judged = 0;
    for (std::size_t e = 0; e < limit.size(); ++e) {
      limit.measure(of.x);
      const Eigen::Map<const VecXd> gradient(&terms.grad[size * e], static_cast<Eigen::Index>(size));
      const Eigen::MatrixXd hessian =
          from_lower_blocks(&terms.hess[terms.hess.size() / limit.size() * e], limit->width());
      if (!(limit.smallest_gap(e) < 0.9)) {
        EXPECT_EQ(gradient.cwiseAbs().maxCoeff() + hessian.cwiseAbs().maxCoeff(), 0);
        continue;
      }
      if (limit.smallest_gap(e) > 0.85) continue;  // too near to where it begins for differences
      const std::vector<int> corners = of.vertices(e);
      const auto moved = [&](std::size_t i, double h) {
        Positions x = of.x;
        x(static_cast<Eigen::Index>(i % 3), corners[i / 3]) += h;
        return x;
      };
      constexpr double h = 1e-6;
      for (std::size_t i = 0; i < size; ++i) {
        const LocalTerms up = limit.derivatives(moved(i, h), barrier),
                         down = limit.derivatives(moved(i, -h), barrier);
        EXPECT_NEAR((up.energy[e] - down.energy[e]) / (2 * h), gradient[static_cast<Eigen::Index>(i)],
                    1e-7 * gradient.norm());
        for (std::size_t j = 0; j < size; ++j) {
          EXPECT_NEAR((up.grad[size * e + j] - down.grad[size * e + j]) / (2 * h),
                      hessian(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)),
                      1e-6 * hessian.norm());
        }
      }
      if (++judged == 5) break;
    }
    EXPECT_EQ(judged, 5u);
  }
}

TEST(LimitFamily, IsInfiniteBeyondTheLimitAndNamesTheFirst) {
  for (const LimitCase& of : limit_cases(0.0, 0.05)) {
    for (const auto& [kernels, order] : {std::pair{true, exec::Order::threads},  // several abreast
                                         {true, exec::Order::reverse},
                                         {false, exec::Order::reverse}}) {
      SCOPED_TRACE(of.name);
      HostLimit limit = of.make(order);
      make_stiff(limit);
      BarrierFunction barrier = barrier_of("log");
      if (!kernels) barrier = without_kernels(barrier);
      const std::vector<double> energy = limit.values(of.x, barrier);
      EXPECT_LT(limit.min_gap(), 0);
      std::size_t first = 0;
      while (limit.smallest_gap(first) > 0) ++first;
      EXPECT_EQ(limit.beyond(), first);
      for (std::size_t e = 0; e < energy.size(); ++e)
        EXPECT_EQ(energy[e] == std::numeric_limits<double>::infinity(), !(limit.smallest_gap(e) > 0)) << e;
      barrier.literal = true;  // the article's own code goes on by its clamp
      const std::vector<double> literal = limit.values(of.x, barrier);
      EXPECT_TRUE(std::isfinite(literal[first]));
      EXPECT_GT(literal[first], 0);
    }
  }
}

TEST(LimitFamily, StepBoundIsTheLastFeasibleNumberOfTheWholeMesh) {
  for (const LimitCase& of : limit_cases(0.02, 0.1)) {
    SCOPED_TRACE(of.name);
    HostLimit limit = of.make();
    const Positions dx = (of.of_solids() ? 20 : 3) * (of.x - of.rest);
    const double alpha = limit.step_bound(of.rest, dx);
    ASSERT_GT(alpha, 0);
    ASSERT_LT(alpha, 1);
    limit.measure(Positions(of.rest + alpha * dx));
    EXPECT_GT(limit.min_gap(), 0);
    limit.measure(Positions(of.rest + std::nextafter(alpha, 1.0) * dx));
    EXPECT_LE(limit.min_gap(), 0);
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(limit.step_bound(of.rest, dx), alpha);
    EXPECT_EQ(limit.step_bound(of.rest, dx, alpha / 2), alpha / 2);
    EXPECT_EQ(limit.step_bound(of.rest, Positions(1e-4 * dx)), 1);
  }
}

/// Triangles of one shape, each turned and moved its own way, that one motion stretches alike: their bounds are one number but
/// for roundings, and at that of one another may be beyond its limit by a rounding.
TEST(LimitFamily, StepBoundIsWithinTheLimitOfEveryElementOfEqualStretch) {
  constexpr int n = 24;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<std::array<int, 3>> triangles;
    Positions rest(3, 3 * n), dx(3, 3 * n);
    for (int e = 0; e < n; ++e) {
      const Mat3d turn = random_rotation(random);
      const Vec3d place(any(random), any(random), any(random));
      const Vec3d corner[] = {Vec3d(0, 0, 0), Vec3d(0.1, 0, 0), Vec3d(0.02, 0.09, 0)};
      for (int k = 0; k < 3; ++k) {
        rest.col(3 * e + k) = place + turn * corner[k];
        dx.col(3 * e + k) = turn * Vec3d(0.3 * corner[k].x(), -0.1 * corner[k].y(), 0);
      }
      triangles.push_back({3 * e, 3 * e + 1, 3 * e + 2});
    }
    const StrainLimitPart part = limited(triangles, 0.02, 0.1);
    HostLimit limit(part, rest);
    const double alpha = limit.step_bound(rest, dx);
    ASSERT_NEAR(alpha, 0.12 / 0.3, 1e-12);
    limit.measure(Positions(rest + alpha * dx));
    EXPECT_GT(limit.min_gap(), 0) << trial;
    EXPECT_EQ(limit.step_bound(rest, dx, alpha), alpha) << trial;
  }
}

TEST(LimitFamily, BadColumnsAreConfigErrors) {
  for (LimitCase of : limit_cases(0.1, 0.9)) {
    StrainBands& bands = of.of_solids() ? static_cast<StrainBands&>(of.tetrahedra) : of.triangles;
    EXPECT_NO_THROW(of.make());
    bands.width[3] = 0;
    EXPECT_THROW(of.make(), ConfigError);
    bands.width[3] = 0.1;
    bands.onset.pop_back();
    EXPECT_THROW(of.make(), ConfigError);
    bands.onset.push_back(0.1);
    of.rest.row(of.of_solids() ? 2 : 1).setZero();
    EXPECT_THROW(of.make(), ConfigError) << "elements without area or volume";
  }
}

TEST(LimitFamily, EmptyIsAllowed) {
  const StrainLimitPart none;
  HostLimit limit(none, Positions(3, 0));
  EXPECT_TRUE(limit.values(Positions(3, 0), barrier_of("log")).empty());
  EXPECT_EQ(limit.step_bound(Positions(3, 0), Positions(3, 0)), 1);
}

}  // namespace
}  // namespace bb::test::limit_family_test
