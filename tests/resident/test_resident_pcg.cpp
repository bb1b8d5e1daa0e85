// Conjugate gradients on an executor: against dense solutions and pcg of the host, the same bits in every order, every
// cause of failure provoked.
#include <gtest/gtest.h>

#include <cmath>

#include "core/exec/counting_executor.hpp"
#include "core/resident/linear/block_jacobi.hpp"
#include "core/resident/linear/pcg_kernels.hpp"
#include "core/solvers/linear_solvers.hpp"
#include "tests/oracle/dense.hpp"
#include "tests/resident/linear_cases.hpp"
#include "tests/resident/tested_executor.hpp"

namespace bb::resident::resident_pcg_test {
namespace {

using exec::Buffer;
using exec::Order;
using test::TestedExecutor;

struct Solved {
  LinearReport report;
  VecXd x;
  Index fault;
};

struct How {
  Order order = Order::threads;
  bool split = false, plainly = false;
  double tolerance = 1e-11;
  int cap = 10000;
};

Solved solve(const ReducedSystem& system, const VecXd& b, const std::vector<FixedMask>& fixed, How how) {
  TestedExecutor executor(how.order);
  const OwnedSystem owned(executor, system, fixed, how.split);
  Buffer<double> rhs(executor, "b"), x(executor, "x", 3 * owned.n());
  rhs.upload(plain(b));
  ResidentPcg pcg(executor, owned.n(), std::make_unique<BlockJacobi>(executor));
  pcg.launch_plainly(how.plainly);
  Solved out;
  out.report = pcg.solve(owned.matrix(), owned.fixed.data(), rhs.data(), x.data(), how.tolerance, how.cap);
  out.fault = pcg.fault();
  const std::vector<double> numbers = x.download();
  out.x = Eigen::Map<const VecXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
  return out;
}

LinearReport host_pcg(const ReducedSystem& system, const VecXd& b, double tolerance, VecXd& x,
                      int cap = 10000) {
  LinearOptions options;
  options.name = "pcg";
  options.parameters = {{"preconditioner", std::string("block_jacobi")},
                        {"forcing", std::string("fixed")},
                        {"tol_rel", tolerance},
                        {"max_iterations", std::int64_t{cap}}};
  return make_linear_solver(options)->solve(system, b, x);
}

TEST(ResidentPcg, MeetsTheDenseSolution) {
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

TEST(ResidentPcg, TakesTheIterationsOfTheHost) {
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

TEST(ResidentPcg, GivesTheSameBitsInEveryOrderAndWithGraphsOrWithout) {
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
TEST(ResidentPcg, TakesManyRowsABlock) {
  const int m = 184;
  ASSERT_GT(Partition::of(m * m).rows_a_block, 32);
  const ReducedSystem system = grid_system(m, 1, 1);
  const VecXd b = random_vector(system.lower.rows(), 3);
  VecXd x;
  const LinearReport host = host_pcg(system, b, 1e-6, x);
  const Solved got = solve(system, b, no_fixed(m * m), {.tolerance = 1e-6});
  ASSERT_EQ(got.report.status, LinearStatus::ok);
  EXPECT_EQ(got.report.iterations, host.iterations);
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

TEST(ResidentPcg, NamesWhatIsIndefinite) {
  VecXd s = spectrum("geometric", 60, 1e2);
  s[0] = -0.02;
  const ReducedSystem system = from_dense(with_spectrum(s, 3));
  VecXd x;
  ASSERT_EQ(host_pcg(system, random_vector(60, 1), 1e-10, x).status, LinearStatus::matrix_indefinite);
  Solved got = solve(system, random_vector(60, 1), no_fixed(20), {});
  EXPECT_EQ(got.report.status, LinearStatus::matrix_indefinite);
  EXPECT_NE(got.report.detail.find("p^T A p is negative"), std::string::npos) << got.report.detail;

  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(12, 12);
  a(7, 7) = -1;
  got = solve(from_dense(a), VecXd::Ones(12), no_fixed(4), {});
  EXPECT_EQ(got.report.status, LinearStatus::matrix_indefinite);
  EXPECT_EQ(got.fault, 2);
  // no fault where nobody looks
  got = solve(from_dense(a), VecXd::Ones(12), {0, 0, 2, 0}, {});
  EXPECT_EQ(got.report.status, LinearStatus::ok);
  EXPECT_EQ(got.fault, -1);
}

TEST(ResidentPcg, NamesASingularBlock) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(9, 9);
  a.block<3, 3>(3, 3).setOnes();  // rank one
  Solved got = solve(from_dense(a), VecXd::Ones(9), no_fixed(3), {});
  EXPECT_EQ(got.report.status, LinearStatus::preconditioner_indefinite);
  EXPECT_EQ(got.fault, 1);
  EXPECT_NE(got.report.detail.find("vertex 1 is 0 or singular"), std::string::npos) << got.report.detail;
  a.block<3, 3>(3, 3).setZero();
  a.block<3, 3>(6, 6) = -Mat3d::Identity();  // worse, and told first
  EXPECT_EQ(solve(from_dense(a), VecXd::Ones(9), no_fixed(3), {}).report.status,
            LinearStatus::matrix_indefinite);
  EXPECT_EQ(solve(from_dense(a), VecXd::Ones(9), {0, 0, 7}, {}).report.status,
            LinearStatus::preconditioner_indefinite);
  EXPECT_EQ(solve(from_dense(a), VecXd::Ones(9), {0, 7, 7}, {}).report.status, LinearStatus::ok);
}

/// Block Jacobi with the wrong sign, from the start or from the first iteration on. On the host: not within a graph.
class Negative final : public ResidentPreconditioner {
 public:
  Negative(exec::Executor& executor, bool at_once)
      : executor_(executor), inner_(executor), at_once_(at_once) {}
  void setup(const ResidentMatrix& matrix, const PcgVectors& v, std::uint64_t id, FactorFaults* f) override {
    inner_.setup(matrix, v, id, f);
  }
  void apply(const PcgVectors& v) override {
    inner_.apply(v);
    if (at_once_) negate(v);
  }
  void update(const PcgVectors& v, int k) override {
    inner_.update(v, k);
    negate(v);
  }
  int version() const override { return inner_.version(); }
  std::string fault_text(Index number) const override { return inner_.fault_text(number); }

 private:
  void negate(const PcgVectors& v) {
    negate(v.z, 3 * v.partition.n_rows);
    negate(v.partial_rz, v.partition.n_blocks());
  }
  void negate(double* column, Index n) {
    std::vector<double> values(static_cast<std::size_t>(n));
    executor_.download(values.data(), column, values.size() * sizeof(double));
    for (double& x : values) x = -x;
    executor_.upload(column, values.data(), values.size() * sizeof(double));
  }
  exec::Executor& executor_;
  BlockJacobi inner_;
  bool at_once_;
};

TEST(ResidentPcg, NamesAnIndefinitePreconditioner) {
  const ReducedSystem system = grid_system(6, 0.1, 1);
  for (const bool at_once : {false, true}) {
    TestedExecutor executor;
    const OwnedSystem owned(executor, system, no_fixed(36), false);
    Buffer<double> b(executor, "b"), x(executor, "x", 108);
    b.upload(plain(random_vector(108, 2)));
    ResidentPcg pcg(executor, 36, std::make_unique<Negative>(executor, at_once));
    pcg.launch_plainly(true);
    const LinearReport report =
        pcg.solve(owned.matrix(), owned.fixed.data(), b.data(), x.data(), 1e-10, 1000);
    EXPECT_EQ(report.status, LinearStatus::preconditioner_indefinite);
    EXPECT_EQ(report.iterations, at_once ? 0 : 1);
    EXPECT_NE(report.detail.find("r^T M^-1 r is not positive"), std::string::npos) << report.detail;
  }
}

TEST(ResidentPcg, TellsRoundingFromIndefiniteMatrices) {
  const ReducedSystem system = from_dense(with_spectrum(spectrum("geometric", 81, 1e8), 3));
  const Solved got = solve(system, random_vector(81, 1), no_fixed(27), {.tolerance = 1e-17});
  EXPECT_EQ(got.report.status, LinearStatus::tolerance_below_rounding);
  EXPECT_GT(got.report.residual_true, 1e-17);
  EXPECT_LT(got.report.residual_true, 1e-6);
  EXPECT_GT(got.report.restarts, 0);
  VecXd s = spectrum("geometric", 60, 1e2);
  s.head(3).setZero();
  const LinearReport semi = solve(from_dense(with_spectrum(s, 3)), random_vector(60, 1), no_fixed(20),
                                  {.tolerance = 1e-14, .cap = 500})
                                .report;
  EXPECT_TRUE(semi.status == LinearStatus::tolerance_below_rounding ||
              semi.status == LinearStatus::iteration_cap)
      << to_string(semi.status);
  EXPECT_GT(semi.residual_true, 1e-3);
}

TEST(ResidentPcg, StopsAtTheCap) {
  const ReducedSystem system = grid_system(12, 1e-2, 1);
  const VecXd b = random_vector(system.lower.rows(), 2);
  for (const int cap : {1, 5, 16, 17, 33}) {
    VecXd x;
    const LinearReport host = host_pcg(system, b, 1e-12, x, cap);
    ASSERT_EQ(host.status, LinearStatus::iteration_cap);
    const Solved got = solve(system, b, no_fixed(144), {.tolerance = 1e-12, .cap = cap});
    EXPECT_EQ(got.report.status, LinearStatus::iteration_cap);
    EXPECT_EQ(got.report.iterations, cap);
    EXPECT_LT((got.x - x).norm(), 1e-11 * x.norm());
    EXPECT_NEAR(got.report.residual_true / host.residual_true, 1, 1e-9);
    EXPECT_NEAR(got.report.residual_true, got.report.residual_recurrence, 1e-12);
  }
}

TEST(ResidentPcg, NamesWhatIsNotFinite) {
  const ReducedSystem system = grid_system(6, 1e-2, 1);
  VecXd b = random_vector(system.lower.rows(), 2);
  b[7] = std::nan("");
  EXPECT_EQ(solve(system, b, no_fixed(36), {}).report.status, LinearStatus::non_finite);
  EXPECT_EQ(solve(system, b, {[] {
                    auto fixed = no_fixed(36);
                    fixed[2] = 2;
                    return fixed;
                  }()},
                  {})
                .report.status,
            LinearStatus::ok);  // fixed: not read
  b[7] = 1;
  for (const int entry : {0, 4}) {  // a diagonal block, another
    ReducedSystem bad = system;
    bad.lower.valuePtr()[entry] = std::numeric_limits<double>::infinity();
    const Solved got = solve(bad, b, no_fixed(36), {});
    EXPECT_EQ(got.report.status, LinearStatus::non_finite) << entry;
  }
}

TEST(ResidentPcg, HasNothingToDoForZero) {
  const Solved got = solve(grid_system(6, 1e-2, 1), VecXd::Zero(108), no_fixed(36), {});
  EXPECT_EQ(got.report.status, LinearStatus::ok);
  EXPECT_EQ(got.report.iterations, 0);
  EXPECT_EQ(got.x, VecXd::Zero(108));
}

/// One solver, several solves: values change in place, then the right-hand side, then the tolerance.
TEST(ResidentPcg, KeepsItsGraph) {
  TestedExecutor executor;
  const ReducedSystem system = grid_system(9, 0.1, 1);
  const OwnedSystem owned(executor, system, no_fixed(81), false);
  Buffer<double> b(executor, "b"), x(executor, "x", 243);
  ResidentPcg pcg(executor, 81, std::make_unique<BlockJacobi>(executor));
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
TEST(ResidentPcg, CountsItsMemory) {
  exec::CountingExecutor counting;
  const Index n = 8200000;
  ResidentPcg pcg(counting, n, std::make_unique<BlockJacobi>(counting));
  pcg.solve(ResidentMatrix{}, nullptr, nullptr, nullptr, 1e-3, 10);
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
}  // namespace bb::resident::resident_pcg_test
