// Conjugate gradients on an executor: against dense solutions and pcg of the host, the same bits in every order.
#include <gtest/gtest.h>

#include <cmath>

#include "core/exec/counting_executor.hpp"
#include "core/linear/executor/pcg_kernels.hpp"
#include "tests/linear/executor/pcg_solves.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::exec::executor_pcg_test {
namespace {

using namespace pcg_solves;

TEST(ExecutorPcg, MeetsTheDenseSolution) {
  for (const bool masked : {false, true}) {
    for (const bool split : {false, true}) {
      for (const int m : {1, 2, 6, 12}) {
        const ReducedSystem system = grid_system(m, 0.3, 1);
        const auto fixed = masked ? some_fixed(m * m) : no_fixed(m * m);
        const VecXd b = random_vector(system.lower.rows(), 2);
        const Eigen::MatrixXd a = restricted(system, fixed);
        const VecXd truth = test::solve(a, restricted(b, fixed));
        const Solved got = solve(system, b, fixed, {.split = split, .tolerance = 1e-12});
        ASSERT_EQ(got.report.status, LinearStatus::ok) << got.report.detail;
        EXPECT_GT(got.report.iterations, m > 2 ? 10 : 0);
        EXPECT_LT((got.x - truth).norm(), 1e-10 * truth.norm());
        const VecXd free = restricted(b, fixed);
        const double residual = (free - a * got.x).norm() / free.norm();
        EXPECT_NEAR(got.report.residual_true, residual, 1e-14);
        EXPECT_LE(got.report.residual_recurrence, 1e-12);
        EXPECT_EQ(restricted(got.x, fixed), got.x);  // 0 where fixed
      }
    }
  }
}

TEST(ExecutorPcg, TakesTheIterationsOfTheHost) {
  for (const int m : {8, 30, 45}) {
    for (const double tolerance : {1e-2, 1e-6, 1e-10}) {
      const ReducedSystem system = grid_system(m, 1e-2, 1);
      const VecXd b = random_vector(system.lower.rows(), 7);
      VecXd x;
      const LinearReport host = host_pcg(system, b, tolerance, x);
      const Solved got = solve(system, b, no_fixed(m * m), {.tolerance = tolerance});
      ASSERT_EQ(got.report.status, LinearStatus::ok);
      EXPECT_LE(std::abs(got.report.iterations - host.iterations), 1) << m << " " << tolerance;
      EXPECT_LT((got.x - x).norm(), 200 * tolerance * x.norm());
      EXPECT_NEAR(got.report.ritz_max / host.ritz_max, 1, 1e-6);
      EXPECT_NEAR(got.report.ritz_min / host.ritz_min, 1, 1e-2);
      RecordProperty("iterations_" + std::to_string(m), got.report.iterations);
    }
  }
}

TEST(ExecutorPcg, GivesTheSameBitsInEveryOrderAndWithGraphsOrWithout) {
  for (const int m : {5, 20}) {  // one block and 13; as PTX every iteration more costs
    const ReducedSystem system = grid_system(m, 1e-2, 1);
    const VecXd b = random_vector(system.lower.rows(), 3);
    const auto fixed = some_fixed(m * m);
    const Solved first = solve(system, b, fixed, {.split = true, .tolerance = 1e-8});
    ASSERT_EQ(first.report.status, LinearStatus::ok);
    ASSERT_GT(first.report.iterations, graph_iterations + 1);
    for (const Order order : {Order::forward, Order::reverse, Order::shuffled}) {
      const Solved again = solve(system, b, fixed, {.order = order, .split = true, .tolerance = 1e-8});
      EXPECT_EQ(again.x, first.x);
      EXPECT_EQ(again.report.iterations, first.report.iterations);
      EXPECT_EQ(again.report.ritz_min, first.report.ritz_min);
    }
    const Solved plainly = solve(system, b, fixed, {.split = true, .plainly = true, .tolerance = 1e-8});
    EXPECT_EQ(plainly.x, first.x);
    EXPECT_EQ(plainly.report.ritz_max, first.report.ritz_max);
  }
}

/// More rows than 1024 blocks of 32: a block of threads walks several chunks.
TEST(ExecutorPcg, TakesManyRowsABlock) {
  const int m = 184;
  ASSERT_GT(Partition::of(m * m).rows_a_block, 32);
  const ReducedSystem system = grid_system(m, 1, 1);
  const VecXd b = random_vector(system.lower.rows(), 3);
  VecXd x;
  const double tolerance = 1e-2;  // as PTX every iteration costs a second
  const LinearReport host = host_pcg(system, b, tolerance, x);
  const Solved got = solve(system, b, no_fixed(m * m), {.tolerance = tolerance});
  ASSERT_EQ(got.report.status, LinearStatus::ok);
  EXPECT_EQ(got.report.iterations, host.iterations);
  EXPECT_GT(got.report.iterations, 2);
  EXPECT_LT((got.x - x).norm(), 1e-9 * x.norm());
}

TEST(Partition, CoversAllRowsOnce) {
  for (const Index n : {0, 1, 31, 32, 33, 1024 * 32, 1024 * 32 + 1, 1000000, 8200000}) {
    const Partition p = Partition::of(n);
    EXPECT_LE(p.n_blocks(), 1024);
    EXPECT_EQ(p.rows_a_block % 32, 0);
    Index covered = 0;
    for (Index b = 0; b < p.n_blocks(); ++b) {
      EXPECT_EQ(p.first(b), covered);
      EXPECT_GT(p.last(b), covered);
      covered = p.last(b);
    }
    EXPECT_EQ(covered, n);
  }
}

TEST(MultiplyDot, MeetsTheDenseProduct) {
  const ReducedSystem system = grid_system(13, 0.5, 1);
  const auto fixed = some_fixed(169);
  const VecXd p = restricted(random_vector(system.lower.rows(), 5), fixed);
  Eigen::MatrixXd a = restricted(system, fixed);
  const VecXd truth = a * p;
  for (const bool split : {false, true}) {
    TestedExecutor executor(Order::shuffled);
    const OwnedSystem owned(executor, system, fixed, split);
    const Partition partition = Partition::of(owned.n());
    Buffer<double> in(executor, "p"), q(executor, "q", p.size()),
        partial(executor, "s", partition.n_blocks());
    in.upload(plain(p));
    executor.blocks(partition.n_blocks(), MultiplyDot{partition, owned.matrix(), owned.fixed.data(),
                                                      in.data(), q.data(), partial.data(), nullptr});
    const std::vector<double> got = q.download();
    double dot = 0, magnitude = 0;
    for (const double s : partial.download()) dot += s;
    executor.blocks(partition.n_blocks(), MagnitudeDot{partition, owned.matrix(), in.data(), partial.data()});
    for (const double s : partial.download()) magnitude += s;
    for (Eigen::Index i = 0; i < p.size(); ++i) {
      EXPECT_NEAR(got[static_cast<std::size_t>(i)], truth[i], 1e-14 * truth.cwiseAbs().maxCoeff());
    }
    EXPECT_NEAR(dot, p.dot(truth), 1e-13 * std::abs(dot));
    EXPECT_NEAR(magnitude, p.cwiseAbs().dot(a.cwiseAbs() * p.cwiseAbs()), 1e-13 * magnitude);
    EXPECT_GT(dot, 1);
  }
}

TEST(ExecutorPcg, HasNothingToDoForZero) {
  const Solved got = solve(grid_system(6, 1e-2, 1), VecXd::Zero(108), no_fixed(36), {});
  EXPECT_EQ(got.report.status, LinearStatus::ok);
  EXPECT_EQ(got.report.iterations, 0);
  EXPECT_EQ(got.x, VecXd::Zero(108));
}

/// One solver, several solves: values change in place, then the right-hand side, then the tolerance.
TEST(ExecutorPcg, KeepsItsGraph) {
  TestedExecutor executor;
  const ReducedSystem system = grid_system(9, 0.1, 1);
  const OwnedSystem owned(executor, system, no_fixed(81), false);
  Buffer<double> b(executor, "b"), x(executor, "x", 243);
  ExecutorPcg pcg(executor, 81, std::make_unique<BlockJacobi>(executor));
  int n = 0;
  for (const double tolerance : {1e-3, 1e-10}) {
    for (const unsigned seed : {1u, 2u}) {
      const VecXd rhs = random_vector(243, seed);
      b.upload(plain(rhs));
      const LinearReport report =
          pcg.solve(owned.matrix(), owned.fixed.data(), b.data(), x.data(), tolerance, 1000);
      const Solved alone = solve(system, rhs, no_fixed(81), {.tolerance = tolerance});
      EXPECT_EQ(x.download(), plain(alone.x));
      EXPECT_EQ(report.iterations, alone.report.iterations);
      EXPECT_NEAR(pcg.norm(owned.fixed.data(), b.data()), rhs.norm(), 1e-13 * rhs.norm());
      ++n;
    }
  }
  EXPECT_EQ(n, 4);
}

/// What a scene needs is known before it runs.
TEST(ExecutorPcg, CountsItsMemory) {
  exec::CountingExecutor counting;
  const Index n = 8200000;
  ExecutorPcg pcg(counting, n, std::make_unique<BlockJacobi>(counting));
  pcg.solve(ExecutorMatrix{}, nullptr, nullptr, nullptr, 1e-3, 10);
  const auto& bytes = counting.memory().by_name();
  EXPECT_EQ(bytes.at("pcg residual"), 24u * static_cast<std::size_t>(n));
  EXPECT_EQ(bytes.at("diagonal factors"), 48u * static_cast<std::size_t>(n));
  EXPECT_LT(counting.memory().bytes(), 144u * static_cast<std::size_t>(n) + 100000);
}

/// Two degrees of freedom a vertex, by the registry.
TEST(PcgResident, TakesPlanarScenes) {
  ReducedSystem system = grid_system(8, 1e-2, 1);
  system.block_start.clear();
  for (int i = 0; i <= 192; i += 2) system.block_start.push_back(i);
  const VecXd b = random_vector(192, 4);
  LinearOptions options;
  options.name = "pcg_resident";
  options.parameters = {{"forcing", std::string("fixed")}, {"tol_rel", 1e-11}};
  VecXd x, y;
  const LinearReport report = make_linear_solver(options)->solve(system, b, x);
  EXPECT_EQ(report.status, LinearStatus::ok);
  const LinearReport host = host_pcg(system, b, 1e-11, y);
  EXPECT_LE(std::abs(report.iterations - host.iterations), 1);
  const VecXd truth = test::solve(dense(system), b);
  EXPECT_LT((x - truth).norm(), 1e-9 * truth.norm());
  system.lower.coeffRef(100, 100) = 0;
  system.lower.coeffRef(101, 101) = 0;
  system.lower.coeffRef(101, 100) = 0;
  system.block_vertex.assign(96, 0);
  system.block_vertex[50] = 17;
  system.pattern_id = 0;
  const LinearReport bad = make_linear_solver(options)->solve(system, b, x);
  EXPECT_EQ(bad.status, LinearStatus::preconditioner_indefinite);
  EXPECT_NE(bad.detail.find("vertex 17 is 0"), std::string::npos) << bad.detail;
  EXPECT_NE(bad.detail.find("block_jacobi needs"), std::string::npos) << bad.detail;
}

}  // namespace
}  // namespace bb::exec::executor_pcg_test
