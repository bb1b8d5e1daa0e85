// Kernels of conjugate gradients alone, where a thread takes several numbers and a block several chunks of vertices: as
// in systems of many hundred thousand vertices. Every number beside a plain loop.
#include <gtest/gtest.h>

#include <cmath>

#include "core/exec/buffer.hpp"
#include "core/exec/host_executor.hpp"
#include "core/linear/executor/block_jacobi_kernels.hpp"
#include "core/linear/executor/pcg_kernels.hpp"
#include "core/linear/executor/schwarz_kernels.hpp"
#include "tests/executor/tested_executor.hpp"
#include "tests/linear/executor/linear_cases.hpp"

namespace bb::exec::pcg_kernels_test {
namespace {

using test::TestedExecutor;
using Numbers = std::vector<double>;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Blocks of 384, 384 and 233 vertices: 4 or 5 numbers a thread, 1 or 2 chunks of 256 vertices, and parts of both.
constexpr Partition partition{1001, 384};
constexpr Index n = 3 * 1001;

Numbers random_numbers(unsigned seed, Index count = n) { return plain(random_vector(count, seed)); }

/// Sums over the blocks of threads of a_i b_i.
void expect_partial_sums(const Numbers& got, const Numbers& a, const Numbers& b) {
  ASSERT_EQ(got.size(), 3u);
  for (Index k = 0; k < partition.n_blocks(); ++k) {
    double sum = 0, magnitude = 0;
    for (Index i = 3 * partition.first(k); i < 3 * partition.last(k); ++i) {
      sum += a[at(i)] * b[at(i)], magnitude += std::abs(a[at(i)] * b[at(i)]);
    }
    EXPECT_GT(magnitude, 1);
    EXPECT_NEAR(got[at(k)], sum, 1e-14 * magnitude) << "block " << k;
  }
}

PcgScalars running_state() {
  PcgScalars out{};
  out.max_iterations = 100, out.curvature = 1;
  out.state[0] = {0.75, 0.5, 3, CgEnd::running};
  return out;
}

/// M^-1 r of each vertex by its factor w: one number of all vertices after the other.
Numbers preconditioned(const Numbers& inverse, const Numbers& r) {
  Numbers z(r.size());
  for (Index v = 0; v < partition.n_rows; ++v) {
    const auto w = [&](Index k) { return inverse[at(k * partition.n_rows + v)]; };
    Mat3d lower = Mat3d::Zero();
    lower << w(0), 0, 0, w(1), w(2), 0, w(3), w(4), w(5);
    Eigen::Map<Vec3d>(z.data() + 3 * v) =
        lower.transpose() * (lower * Eigen::Map<const Vec3d>(r.data() + 3 * v));
  }
  return z;
}

void expect_near(const Numbers& got, const Numbers& expected, double tolerance) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) ASSERT_NEAR(got[i], expected[i], tolerance) << i;
}

struct PcgKernels : testing::TestWithParam<Order> {
  TestedExecutor executor{GetParam(), 7};
  Buffer<double> p{executor, "p"}, q{executor, "q"}, x{executor, "x"}, r{executor, "r"}, z{executor, "z", n};
  Buffer<double> inverse{executor, "inverse"}, pq{executor, "pq"}, rz{executor, "rz", 3},
      rr{executor, "rr", 3};
  Buffer<PcgScalars> scalars{executor, "scalars", 1};

  void SetUp() override {
    p.upload(random_numbers(1)), q.upload(random_numbers(2)), x.upload(random_numbers(3));
    r.upload(random_numbers(4)), inverse.upload(random_numbers(5, 2 * n)), pq.upload(Numbers{1, 2.5, -1});
    scalars.set(0, running_state());
  }
  /// x and r after a step of length 0.75 / 2.5.
  void expect_step() {
    Numbers steps = random_numbers(3), residual = random_numbers(4);
    const Numbers direction = random_numbers(1), product = random_numbers(2);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      steps[i] = std::fma(0.75 / 2.5, direction[i], steps[i]);
      residual[i] = std::fma(-(0.75 / 2.5), product[i], residual[i]);
    }
    EXPECT_EQ(x.download(), steps);
    EXPECT_EQ(r.download(), residual);
    EXPECT_EQ(scalars.get(0).alpha[0], 0.75 / 2.5);
    EXPECT_EQ(scalars.get(0).curvature, 2.5);
  }
};

TEST_P(PcgKernels, SetResidual) {
  const std::vector<FixedMask> mask = some_fixed(1001);
  Buffer<FixedMask> fixed(executor, "fixed");
  fixed.upload(mask);
  for (const bool subtracts : {false, true}) {
    executor.blocks(3, SetResidual{partition, fixed.data(), p.data(), subtracts ? q.data() : nullptr,
                                   r.data(), rr.data()});
    Numbers expected = random_numbers(1);
    const Numbers minus = random_numbers(2);
    for (Index i = 0; i < n; ++i) {
      if (subtracts) expected[at(i)] -= minus[at(i)];
      if (is_fixed(mask[at(i / 3)], static_cast<int>(i % 3))) expected[at(i)] = 0;
    }
    EXPECT_EQ(r.download(), expected);
    expect_partial_sums(rr.download(), expected, expected);
  }
}

TEST_P(PcgKernels, ApplyBlockJacobi) {
  executor.blocks(3, ApplyBlockJacobi{partition, inverse.data(), r.data(), z.data(), rz.data(), rr.data()});
  const Numbers residual = random_numbers(4), expected = preconditioned(random_numbers(5, 2 * n), residual);
  expect_near(z.download(), expected, 1e-14);
  expect_partial_sums(rz.download(), residual, expected);
  expect_partial_sums(rr.download(), residual, residual);
}

TEST_P(PcgKernels, UpdateBlockJacobi) {
  executor.blocks(3, UpdateBlockJacobi{partition, inverse.data(), p.data(), q.data(), pq.data(), x.data(),
                                       r.data(), z.data(), rz.data(), rr.data(), scalars.data(), 0});
  expect_step();
  const Numbers residual = r.download(), expected = preconditioned(random_numbers(5, 2 * n), residual);
  expect_near(z.download(), expected, 1e-14);
  expect_partial_sums(rz.download(), residual, expected);
  expect_partial_sums(rr.download(), residual, residual);
}

TEST_P(PcgKernels, UpdateResidual) {
  executor.blocks(3, UpdateResidual{partition, p.data(), q.data(), pq.data(), x.data(), r.data(), rr.data(),
                                    scalars.data(), 0});
  expect_step();
  expect_partial_sums(rr.download(), r.download(), r.download());
}

TEST_P(PcgKernels, StepDirection) {
  rz.upload(Numbers{0.5, 0.25, 0.5}), rr.upload(Numbers{4, 2, 1});
  z.upload(random_numbers(6));
  executor.blocks(3, StepDirection{partition, rz.data(), rr.data(), z.data(), p.data(), scalars.data(), 0});
  Numbers expected = random_numbers(1);
  const Numbers added = random_numbers(6);
  for (std::size_t i = 0; i < expected.size(); ++i)
    expected[i] = std::fma(1.25 / 0.75, expected[i], added[i]);
  EXPECT_EQ(p.download(), expected);
  const PcgScalars after = scalars.get(0);
  EXPECT_EQ(after.beta[0], 1.25 / 0.75);
  EXPECT_EQ(after.state[1].rz, 1.25);
  EXPECT_EQ(after.state[1].rr, 7);
  EXPECT_EQ(after.state[1].iteration, 4);
  EXPECT_TRUE(after.state[1].running());
}

TEST_P(PcgKernels, StepDirectionEndsAtACurvatureThatIsNone) {
  rz.upload(Numbers{0.5, 0.25, 0.5}), rr.upload(Numbers{4, 2, 1});
  for (const double curvature : {0.0, -1.0, double{INFINITY}, std::nan("")}) {
    PcgScalars before = running_state();
    before.curvature = curvature;
    scalars.set(0, before);
    executor.blocks(3, StepDirection{partition, rz.data(), rr.data(), z.data(), p.data(), scalars.data(), 0});
    EXPECT_EQ(scalars.get(0).state[1].end, CgEnd::curvature) << curvature;
    EXPECT_EQ(p.download(), random_numbers(1)) << curvature;
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, PcgKernels,
                         testing::Values(Order::forward, Order::reverse, Order::shuffled));

/// Also a number above the diagonal, whose mirror image is finite.
TEST(FactorizeDiagonal, LooksAtEveryNumber) {
  for (int bad = 0; bad < 9; ++bad) {
    TestedExecutor executor(Order::forward);
    Mat3d block = Mat3d::Identity();
    block(bad / 3, bad % 3) = std::numeric_limits<double>::infinity();
    const OwnedPart part(executor, {0, 1, 2}, {0, 1}, {Mat3d::Identity(), block});
    Buffer<FixedMask> fixed(executor, "fixed");
    Buffer<double> inverse(executor, "inverse", 12);
    Buffer<FactorFaults> faults(executor, "faults", 1);
    fixed.upload(no_fixed(2)), faults.set(0, {no_fault, no_fault, no_fault});
    executor.each(
        2, FactorizeDiagonal{
               {{part.view(), {nullptr, nullptr, nullptr}}}, fixed.data(), 2, inverse.data(), faults.data()});
    EXPECT_EQ(faults.get(0).non_finite, 1u) << bad;
    EXPECT_EQ(faults.get(0).indefinite, no_fault) << bad;
    EXPECT_EQ(inverse.get(0), 1) << bad;
  }
}

}  // namespace
}  // namespace bb::exec::pcg_kernels_test
