// The eigenvectors at both ends against dense ones.
#include <gtest/gtest.h>

#include "core/linear/block_scaling.hpp"
#include "core/linear/end_vectors.hpp"
#include "tests/linear/systems.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::end_vectors_test {
namespace {

/// |sin| of the angle between two directions.
double turned(const VecXd& a, const VecXd& b) {
  const VecXd u = a.normalized(), v = b.normalized();
  return (u - u.dot(v) * v).norm();
}

TEST(EndVectors, are_those_of_the_dense_matrix_for_every_scaling) {
  VecXd spectrum(60);
  for (int i = 0; i < 60; ++i) spectrum[i] = std::pow(10.0, -4.0 * i / 59);
  const Eigen::MatrixXd a = with_spectrum(spectrum, 3);
  const ReducedSystem system = from_dense(a);
  for (const Scaling scaling : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
    BlockScaling blocks;
    ASSERT_EQ(blocks.setup(system, scaling), LinearStatus::ok);
    Eigen::MatrixXd d = Eigen::MatrixXd::Identity(60, 60);  // L L^T
    for (int k = 0; k < 60; ++k) {
      VecXd column = d.col(k);
      blocks.multiply_upper(column);
      blocks.multiply_lower(column);
      d.col(k) = column;
    }
    const test::Spectrum dense = test::spectrum(a.cast<long double>(), d.cast<long double>());
    const auto ends = end_vectors(system, scaling, 7);
    ASSERT_TRUE(ends) << to_string(scaling);
    for (const auto& [end, i] : {std::pair{&ends->smallest, 0}, std::pair{&ends->largest, 59}}) {
      EXPECT_NEAR(end->lambda / static_cast<double>(dense.values[i]), 1, 1e-9) << to_string(scaling);
      EXPECT_NEAR(end->vector.norm(), 1, 1e-14);
      EXPECT_LT(turned(end->unscaled, dense.vectors.col(i).cast<double>()), 1e-5) << to_string(scaling);
      EXPECT_NEAR(end->unscaled.dot(a * end->unscaled) / end->lambda, 1, 1e-9) << to_string(scaling);
    }
  }
}

TEST(EndVectors, of_a_matrix_that_is_not_positive_definite_there_are_none) {
  VecXd spectrum = VecXd::LinSpaced(30, 1, 2);
  spectrum[4] = -1;
  EXPECT_FALSE(end_vectors(from_dense(with_spectrum(spectrum, 3)), Scaling::none, 7));
  spectrum[4] = 1;
  EXPECT_TRUE(end_vectors(from_dense(with_spectrum(spectrum, 3)), Scaling::none, 7));
}

}  // namespace
}  // namespace bb::end_vectors_test
