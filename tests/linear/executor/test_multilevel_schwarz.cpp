// The Schwarz preconditioner of the device backend: its matrix against a dense one, iterations beside those of the host's, faults.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "core/linear/executor/multilevel_schwarz.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "tests/executor/tested_executor.hpp"
#include "tests/linear/executor/linear_cases.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::exec::multilevel_schwarz_test {
namespace {

using test::TestedExecutor;

struct Solved {
  LinearReport report;
  VecXd x;
  std::string fault;
  int n_levels;
};

Solved solve(const ReducedSystem& system, const std::vector<FixedMask>& fixed, Order order = Order::threads,
             bool split = true, int cluster = 8) {
  TestedExecutor executor(order);
  const OwnedSystem owned(executor, system, fixed, split);
  Buffer<double> rhs(executor, "b"), x(executor, "x", 3 * owned.n());
  rhs.upload(plain(random_vector(system.lower.rows(), 4)));
  auto schwarz = std::make_unique<MultilevelSchwarz>(executor, cluster);
  const MultilevelSchwarz& levels = *schwarz;
  ExecutorPcg pcg(executor, owned.n(), std::move(schwarz));
  Solved out;
  out.report = pcg.solve(owned.matrix(), owned.fixed.data(), rhs.data(), x.data(), 1e-6, 20000);
  const std::vector<double> numbers = x.download();
  out.x = Eigen::Map<const VecXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
  out.fault = out.report.detail;
  out.n_levels = levels.n_levels();
  return out;
}

int host_iterations(const ReducedSystem& system, const std::string& preconditioner) {
  LinearOptions options;
  options.name = "pcg";
  options.parameters = {
      {"preconditioner", preconditioner}, {"forcing", std::string("fixed")}, {"tol_rel", 1e-6}};
  VecXd x;
  return make_linear_solver(options)->solve(system, random_vector(system.lower.rows(), 4), x).iterations;
}

/// M^-1 column by column.
Eigen::MatrixXd inverse(exec::Executor& executor, MultilevelSchwarz& schwarz, const OwnedSystem& owned,
                        std::uint64_t pattern_id = 0) {
  const Index n = 3 * owned.n();
  Buffer<double> vectors(executor, "vectors", 5 * n), partial(executor, "sums", 3 * 1024);
  Buffer<PcgScalars> scalars(executor, "scalars", 1);
  Buffer<FactorFaults> faults(executor, "faults", 1);
  faults.set(0, {no_fault, no_fault, no_fault});
  double *at = vectors.data(), *sums = partial.data();
  const PcgVectors v{Partition::of(owned.n()),
                     owned.fixed.data(),
                     at,
                     at + n,
                     at + 2 * n,
                     at + 3 * n,
                     at + 4 * n,
                     sums,
                     sums + 1024,
                     sums + 2048,
                     scalars.data()};
  schwarz.setup(owned.matrix(), v, pattern_id, faults.data());
  EXPECT_EQ(faults.get(0).indefinite, no_fault);
  EXPECT_EQ(faults.get(0).singular, no_fault);
  Eigen::MatrixXd out(n, n);
  for (Index j = 0; j < n; ++j) {
    const bool free = !is_fixed(owned.mask[static_cast<std::size_t>(j / 3)], static_cast<int>(j % 3));
    vectors.fill_zero();
    vectors.set(n + j, free ? 1.0 : 0.0);
    schwarz.apply(v);
    executor.download(out.col(j).data(), v.z, static_cast<std::size_t>(n) * sizeof(double));
    if (!free) out(j, j) = 1;
  }
  return out;
}

TEST(MultilevelSchwarz, IsSymmetricPositiveDefinite) {
  const ReducedSystem system = folded_grid(12, 1e3);
  for (const auto& fixed : {no_fixed(144), some_fixed(144)}) {
    TestedExecutor executor(Order::shuffled);
    const OwnedSystem owned(executor, system, fixed, true);
    MultilevelSchwarz schwarz(executor, 4);
    const Eigen::MatrixXd m = inverse(executor, schwarz, owned);
    EXPECT_GE(schwarz.n_levels(), 3);
    const double scale = m.cwiseAbs().maxCoeff();
    EXPECT_GT(scale, 1e-3);
    EXPECT_LT((m - m.transpose()).cwiseAbs().maxCoeff(), 1e-12 * scale);
    EXPECT_GT(test::eigenvalues(Eigen::MatrixXd(0.5 * (m + m.transpose())))[0], 0);
  }
}

/// One level of one cluster is the inverse.
TEST(MultilevelSchwarz, IsExactWhereOneClusterHoldsAll) {
  for (const auto& fixed : {no_fixed(9), some_fixed(9)}) {
    const ReducedSystem system = grid_system(3, 0.1, 1);
    TestedExecutor executor(Order::reverse);
    const OwnedSystem owned(executor, system, fixed, true);
    MultilevelSchwarz schwarz(executor, 11);
    const Eigen::MatrixXd m = inverse(executor, schwarz, owned), a = restricted(system, fixed);
    EXPECT_EQ(schwarz.n_levels(), 1);
    EXPECT_LT((m * a - Eigen::MatrixXd::Identity(27, 27)).cwiseAbs().maxCoeff(), 1e-11);
    EXPECT_LE(solve(system, fixed, Order::threads, true, 11).report.iterations, 2);
  }
}

/// The sum over levels, dense. a: 0 in rows and columns that are fixed. stored: not 0 where the matrix has a block.
Eigen::MatrixXd dense_schwarz(const Eigen::MatrixXd& a, const Eigen::MatrixXd& stored, const VecXd& fixed,
                              int vertices) {
  const Eigen::Index n = a.rows() / 3;
  BlockGraph graph;
  graph.row_start.push_back(0);
  bool coupled = false;
  for (int r = 0; r < n; ++r) {
    for (int c = 0; c < n; ++c) {
      const double norm = a.block<3, 3>(3 * r, 3 * c).norm();
      if (stored(r, c) == 0) continue;
      coupled = coupled || (r != c && norm > 0);
      graph.column.push_back(c), graph.norm.push_back(norm);
    }
    graph.row_start.push_back(static_cast<std::int64_t>(graph.column.size()));
  }
  if (!coupled) return Eigen::MatrixXd::Zero(a.rows(), a.rows());
  const VertexClusters clusters = cluster_vertices(graph, vertices);
  const Eigen::MatrixXd whole = a + Eigen::MatrixXd(fixed.asDiagonal());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(a.rows(), a.rows()),
                  p = Eigen::MatrixXd::Zero(a.rows(), 3 * clusters.size()),
                  joined = Eigen::MatrixXd::Zero(n, clusters.size());
  for (int k = 0; k < clusters.size(); ++k) {
    std::vector<Eigen::Index> rows;
    for (int m = clusters.start[static_cast<std::size_t>(k)];
         m < clusters.start[static_cast<std::size_t>(k) + 1]; ++m) {
      joined(clusters.member[static_cast<std::size_t>(m)], k) = 1;
      for (int c = 0; c < 3; ++c) {
        rows.push_back(3 * clusters.member[static_cast<std::size_t>(m)] + c);
        p(rows.back(), 3 * k + c) = 1 - fixed[rows.back()];
      }
    }
    const auto size = static_cast<Eigen::Index>(rows.size());
    const auto row = [&rows](Eigen::Index i) { return rows[static_cast<std::size_t>(i)]; };
    Eigen::MatrixXd local(size, size);
    for (Eigen::Index i = 0; i < size; ++i)
      for (Eigen::Index j = 0; j < size; ++j) local(i, j) = whole(row(i), row(j));
    const Eigen::MatrixXd inverse_local = test::inverse(local);
    for (Eigen::Index i = 0; i < size; ++i)
      for (Eigen::Index j = 0; j < size; ++j) out(row(i), row(j)) = inverse_local(i, j);
  }
  if (clusters.size() == n) return out;
  VecXd coarse_fixed(p.cols());
  for (Eigen::Index j = 0; j < p.cols(); ++j) coarse_fixed[j] = p.col(j).isZero() ? 1 : 0;
  const Eigen::MatrixXd coarse = p.transpose() * a * p, coarse_stored = joined.transpose() * stored * joined;
  return out + p * dense_schwarz(coarse, coarse_stored, coarse_fixed, vertices) * p.transpose();
}

/// Also when values change and the pattern stays: twice the matrix has half the inverse.
TEST(MultilevelSchwarz, IsTheSumOverItsLevels) {
  for (const auto& mask : {no_fixed(49), some_fixed(49)}) {
    ReducedSystem system = grid_system(7, 0.3, 1);
    TestedExecutor executor;
    const OwnedSystem owned(executor, system, mask, false);
    MultilevelSchwarz schwarz(executor, 4);
    const Eigen::MatrixXd m = inverse(executor, schwarz, owned, 1);
    EXPECT_GE(schwarz.n_levels(), 2);
    Eigen::MatrixXd a = restricted(system, mask);
    VecXd fixed(a.rows());
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      fixed[i] = is_fixed(mask[static_cast<std::size_t>(i / 3)], static_cast<int>(i % 3)) ? 1 : 0;
      if (fixed[i] != 0) a(i, i) = 0;
    }
    Eigen::MatrixXd stored(49, 49);
    const Eigen::MatrixXd all = dense(system);
    for (int r = 0; r < 49; ++r) {
      for (int c = 0; c < 49; ++c) stored(r, c) = all.block<3, 3>(3 * r, 3 * c).isZero(0) ? 0 : 1;
    }
    const Eigen::MatrixXd truth = dense_schwarz(a, stored, fixed, 4);
    EXPECT_GT(truth.cwiseAbs().maxCoeff(), 0.1);
    EXPECT_LT((m - truth).cwiseAbs().maxCoeff(), 1e-11 * truth.cwiseAbs().maxCoeff());
    system.lower *= 2;
    const OwnedSystem twice(executor, system, mask, false);
    const Eigen::MatrixXd half = inverse(executor, schwarz, twice, 1);
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      if (fixed[i] != 0) continue;
      for (Eigen::Index j = 0; j < a.rows(); ++j) {
        if (fixed[j] != 0) continue;
        EXPECT_NEAR(half(i, j), 0.5 * m(i, j), 1e-14 * truth.cwiseAbs().maxCoeff());
      }
    }
  }
}

TEST(MultilevelSchwarz, GivesTheSameBitsInEveryOrder) {
  const ReducedSystem system = folded_grid(18, 1e3);
  const auto fixed = some_fixed(18 * 18);
  const Solved first = solve(system, fixed);
  ASSERT_EQ(first.report.status, LinearStatus::ok);
  EXPECT_GE(first.n_levels, 3);
  for (const Order order : {Order::forward, Order::reverse, Order::shuffled}) {
    const Solved again = solve(system, fixed, order);
    EXPECT_EQ(again.x, first.x);
    EXPECT_EQ(again.report.iterations, first.report.iterations);
  }
  const Eigen::MatrixXd a = restricted(system, fixed);
  const VecXd b = restricted(random_vector(a.rows(), 4), fixed), truth = test::solve(a, b);
  EXPECT_LT((b - a * first.x).norm(), 1.001e-6 * b.norm());
  EXPECT_LT((truth - first.x).norm(), 1e-3 * truth.norm());
}

TEST(MultilevelSchwarz, NeedsFewerIterationsThanBlockJacobiHoweverStiffContactsAre) {
  for (const int m : {24, 60}) {
    for (const double stiffness : {0.0, 1.0, 1e3, 1e6}) {
      const ReducedSystem system = folded_grid(m, stiffness);
      const int block_jacobi = host_iterations(system, "block_jacobi"),
                schwarz = host_iterations(system, "schwarz");
      const Solved got = solve(system, no_fixed(m * m), Order::threads, false);
      ASSERT_EQ(got.report.status, LinearStatus::ok) << got.report.detail;
      std::cout << "grid " << m << ", stiffness " << stiffness << ": block_jacobi " << block_jacobi
                << ", schwarz " << schwarz << ", device backend " << got.report.iterations << " on "
                << got.n_levels << " levels\n";
      EXPECT_GT(block_jacobi, 100);
      EXPECT_LT(3 * got.report.iterations, 2 * block_jacobi);
    }
  }
}

TEST(MultilevelSchwarz, NamesTheVertexWithoutAFactor) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(12, 12);
  a.block<3, 3>(6, 6).setZero();
  Solved got = solve(from_dense(a), no_fixed(4), Order::threads, false);
  EXPECT_EQ(got.report.status, LinearStatus::preconditioner_indefinite);
  EXPECT_NE(got.fault.find("vertex 2 is 0"), std::string::npos) << got.fault;
  a.block<3, 3>(6, 6) = -Mat3d::Identity();
  got = solve(from_dense(a), no_fixed(4), Order::threads, false);
  EXPECT_EQ(got.report.status, LinearStatus::matrix_indefinite);
  a(3, 3) = std::nan("");
  EXPECT_EQ(solve(from_dense(a), no_fixed(4), Order::threads, false).report.status, LinearStatus::non_finite);
  EXPECT_EQ(solve(from_dense(a), {0, 7, 7, 0}, Order::threads, false).report.status, LinearStatus::ok);
  a = dense(grid_system(3, 0.1, 1));
  a.block<3, 3>(12, 12) = -Mat3d::Identity();  // in the middle of the one cluster
  got = solve(from_dense(a), no_fixed(9), Order::threads, false, 11);
  EXPECT_EQ(got.report.status, LinearStatus::matrix_indefinite);
  EXPECT_NE(got.fault.find("vertex 4 is not positive definite"), std::string::npos) << got.fault;
}

/// By the registry: patterns that change and stay, planar vertices.
TEST(PcgResident, KeepsLevelsWhileThePatternStays) {
  LinearOptions options;
  options.name = "pcg_resident";
  options.parameters = {{"forcing", std::string("fixed")},
                        {"tol_rel", 1e-9},
                        {"resident_preconditioner", std::string("multilevel_schwarz")}};
  const auto solver = make_linear_solver(options);
  int n = 0;
  for (const double stiffness : {1.0, 50.0, 0.0}) {
    ReducedSystem system = stiffness > 0 ? folded_grid(14, stiffness) : grid_system(14, 1e-2, 9);
    if (stiffness > 0) system.pattern_id = 5;
    const VecXd b = random_vector(system.lower.rows(), 6), truth = test::solve(dense(system), b);
    VecXd x;
    EXPECT_EQ(solver->solve(system, b, x).status, LinearStatus::ok);
    EXPECT_LT((x - truth).norm(), 1e-5 * truth.norm());
    ++n;
  }
  EXPECT_EQ(n, 3);
  ReducedSystem planar = grid_system(8, 1e-2, 1);
  planar.block_start.clear();
  for (int i = 0; i <= 192; i += 2) planar.block_start.push_back(i);
  const VecXd b = random_vector(192, 4), truth = test::solve(dense(planar), b);
  VecXd x;
  EXPECT_EQ(solver->solve(planar, b, x).status, LinearStatus::ok);
  EXPECT_LT((x - truth).norm(), 1e-6 * truth.norm());
}

}  // namespace
}  // namespace bb::exec::multilevel_schwarz_test
