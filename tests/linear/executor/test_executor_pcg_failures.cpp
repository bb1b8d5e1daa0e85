// Conjugate gradients on an executor: every cause of failure provoked and named.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/linear/executor/pcg_solves.hpp"

namespace bb::exec::executor_pcg_failures_test {
namespace {

using namespace pcg_solves;

TEST(ExecutorPcg, NamesWhatIsIndefinite) {
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

TEST(ExecutorPcg, NamesASingularBlock) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(9, 9);
  a.block<3, 3>(3, 3).setOnes();  // rank one
  Solved got = solve(from_dense(a), VecXd::Ones(9), no_fixed(3), {});
  EXPECT_EQ(got.report.status, LinearStatus::preconditioner_indefinite);
  EXPECT_EQ(got.fault, 1);
  EXPECT_NE(got.report.detail.find("vertex 1 is 0 or singular"), std::string::npos) << got.report.detail;
  a.block<3, 3>(3, 3).setZero();
  a.block<3, 3>(6, 6) = -Mat3d::Identity();  // worse, and reported first
  EXPECT_EQ(solve(from_dense(a), VecXd::Ones(9), no_fixed(3), {}).report.status,
            LinearStatus::matrix_indefinite);
  EXPECT_EQ(solve(from_dense(a), VecXd::Ones(9), {0, 0, 7}, {}).report.status,
            LinearStatus::preconditioner_indefinite);
  EXPECT_EQ(solve(from_dense(a), VecXd::Ones(9), {0, 7, 7}, {}).report.status, LinearStatus::ok);
}

/// Block Jacobi with the wrong sign, from the start or from the first iteration on. On the host: not within a graph.
class Negative final : public ExecutorPreconditioner {
 public:
  Negative(exec::Executor& executor, bool at_once)
      : executor_(executor), inner_(executor), at_once_(at_once) {}
  void setup(const ExecutorMatrix& matrix, const PcgVectors& v, std::uint64_t id, FactorFaults* f) override {
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

TEST(ExecutorPcg, NamesAnIndefinitePreconditioner) {
  const ReducedSystem system = grid_system(6, 0.1, 1);
  for (const bool at_once : {false, true}) {
    TestedExecutor executor;
    const OwnedSystem owned(executor, system, no_fixed(36), false);
    Buffer<double> b(executor, "b"), x(executor, "x", 108);
    b.upload(plain(random_vector(108, 2)));
    ExecutorPcg pcg(executor, 36, std::make_unique<Negative>(executor, at_once));
    pcg.launch_plainly(true);
    const LinearReport report =
        pcg.solve(owned.matrix(), owned.fixed.data(), b.data(), x.data(), 1e-10, 1000);
    EXPECT_EQ(report.status, LinearStatus::preconditioner_indefinite);
    EXPECT_EQ(report.iterations, at_once ? 0 : 1);
    EXPECT_NE(report.detail.find("r^T M^-1 r is not positive"), std::string::npos) << report.detail;
  }
}

TEST(ExecutorPcg, TellsRoundingFromIndefiniteMatrices) {
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

TEST(ExecutorPcg, StopsAtTheCap) {
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

TEST(ExecutorPcg, NamesWhatIsNotFinite) {
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

}  // namespace
}  // namespace bb::exec::executor_pcg_failures_test
