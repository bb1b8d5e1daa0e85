// What the examination by conjugate gradients counts and how it decides, against a plain recurrence in long double.
#include <gtest/gtest.h>

#include <cmath>

#include "core/linear/definiteness.hpp"
#include "core/linear/preconditioner.hpp"
#include "tests/linear/systems.hpp"

namespace bb::definiteness_counts_test {
namespace {

using Verdict = Definiteness::Verdict;

/// M = the identity, or a diagonal.
class Diagonal final : public Preconditioner {
 public:
  explicit Diagonal(VecXd d) : d_(std::move(d)) {}
  LinearStatus setup(const ReducedSystem&, const SymmetricProduct&) override { return LinearStatus::ok; }
  void apply(const VecXd& r, VecXd& z) const override { z = r.cwiseQuotient(d_); }

 private:
  VecXd d_;
};

struct Expected {
  Verdict verdict = Verdict::unknown;
  int iterations = 0;
};

/// Products with A until the residual is small enough or a direction has negative curvature.
Expected by_recurrence(const Eigen::MatrixXd& a, const VecXd& d, int cap) {
  using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
  const Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic> m = a.cast<long double>();
  const Vector diagonal = d.cast<long double>();
  Vector r = definiteness_right_hand_side(a.rows()).cast<long double>(), z = r.cwiseQuotient(diagonal), p = z;
  const long double target = definiteness_tolerance * r.norm();
  Expected out;
  while (out.iterations < cap) {
    ++out.iterations;
    const Vector ap = m * p;
    const long double curvature = p.dot(ap), rz = r.dot(z);
    if (curvature < 0) {
      out.verdict = Verdict::negative;
      break;
    }
    r -= rz / curvature * ap;
    if (r.norm() <= target) {
      out.verdict = Verdict::positive;
      break;
    }
    z = r.cwiseQuotient(diagonal);
    p = z + r.dot(z) / rz * p;
  }
  return out;
}

struct Tally {
  int positive = 0, negative = 0, unknown = 0, at_once = 0, late = 0;
};

void expect_recurrence(const Eigen::MatrixXd& a, const VecXd& d, int cap, Tally& tally) {
  const Expected expected = by_recurrence(a, d, cap);
  const Definiteness found = examine_by_gradients(from_dense(a), Diagonal(d), cap);
  ASSERT_EQ(found.verdict, expected.verdict) << "cap " << cap;
  EXPECT_EQ(found.iterations, expected.iterations) << "cap " << cap;
  EXPECT_EQ(found.factorizations, 0);
  EXPECT_FALSE(found.by_factor);
  EXPECT_EQ(found.direction.size(), expected.verdict == Verdict::negative ? a.rows() : 0);
  tally.positive += expected.verdict == Verdict::positive;
  tally.unknown += expected.verdict == Verdict::unknown;
  if (expected.verdict != Verdict::negative) return;
  ++tally.negative;
  ++(expected.iterations == 1 ? tally.at_once : tally.late);
  const double curvature = found.direction.dot(a * found.direction) / found.direction.squaredNorm();
  EXPECT_LT(curvature, 0);
  EXPECT_NEAR(found.curvature, curvature, 1e-9 * std::abs(curvature));
}

TEST(DefinitenessCounts, EveryIterationUpToTheOneThatDecides) {
  Tally tally;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const int n = 30;
    VecXd s = spectrum("log_uniform", n, 4, seed);
    for (unsigned k = 0; k < seed % 4; ++k) s[static_cast<int>(k)] *= -1;
    const Eigen::MatrixXd a = with_spectrum(s, seed);
    const VecXd d =
        seed % 3 == 0 ? VecXd(2 * VecXd::Ones(n) + random_vector(n, seed)) : VecXd(VecXd::Ones(n));
    for (const int cap : {1, 3, 100}) expect_recurrence(a, d, cap, tally);
    expect_recurrence(-with_spectrum(s.cwiseAbs(), seed), d, 5, tally);  // the first direction shows it
  }
  EXPECT_GE(tally.positive, 5);
  EXPECT_GE(tally.unknown, 20);
  EXPECT_GE(tally.at_once, 30);
  EXPECT_GE(tally.late, 20);
}

/// The examination has as many iterations as its cap and no more: one below what the matrix needs decides nothing.
TEST(DefinitenessCounts, TheCapItselfIsEnough) {
  int judged = 0;
  for (const int kinds : {1, 3, 6}) {
    VecXd s(12);
    for (int i = 0; i < 12; ++i) s[i] = 1 + i % kinds;
    const ReducedSystem a = from_dense(with_spectrum(s, 4));
    const Diagonal one(VecXd::Ones(12));
    EXPECT_EQ(examine_by_gradients(a, one, kinds).verdict, Verdict::positive) << kinds;
    EXPECT_EQ(examine_by_gradients(a, one, kinds).iterations, kinds);
    EXPECT_EQ(examine_by_gradients(a, one, kinds - 1).verdict, Verdict::unknown) << kinds;
    ++judged;
  }
  EXPECT_EQ(judged, 3);
}

}  // namespace
}  // namespace bb::definiteness_counts_test
