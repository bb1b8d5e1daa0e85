// Element functions of the device against those of the host: nvcc's PTX, run on the CPU, gives the bits of g++.
// Shapes: test_device_check_shapes.cpp.
#include <gtest/gtest.h>

#include "tests/device_check/accd_checks.hpp"
#include "tests/device_check/agreement.hpp"
#include "tests/device_check/bending_checks.hpp"
#include "tests/device_check/distance_checks.hpp"
#include "tests/device_check/math_checks.hpp"
#include "tests/device_check/membrane_checks.hpp"

namespace {

using namespace bb::device_check;

TEST(DeviceCheck, ElementaryFunctions) {
  expect_same_bits<Elementary>(40), expect_same_bits<Elementary, float>(40);
}
TEST(DeviceCheck, Svds) { expect_same_bits<Svds>(43); }
TEST(DeviceCheck, SvdsInFloat) { expect_same_bits<Svds, float>(43); }
template <class T>
using Eigen2 = SymmetricEigen<T, 2>;
template <class T>
using Eigen3 = SymmetricEigen<T, 3>;
template <class T>
using Eigen9 = SymmetricEigen<T, 9>;
template <class T>
using Eigen12 = SymmetricEigen<T, 12>;
TEST(DeviceCheck, EigenvaluesAndProjection) {
  expect_same_bits<Eigen2>(11), expect_same_bits<Eigen3>(22);
  expect_same_bits<Eigen9>(172), expect_same_bits<Eigen12>(301);
}
TEST(DeviceCheck, Distances) { expect_same_bits<Distances>(477); }
TEST(DeviceCheck, Mollifier) { expect_same_bits<Mollifier>(158); }
TEST(DeviceCheck, Accd) { expect_same_bits<Sweeps>(12); }
TEST(DeviceCheck, Spring) { expect_same_bits<Spring>(43); }
TEST(DeviceCheck, SpringInFloat) { expect_same_bits<Spring, float>(43); }
TEST(DeviceCheck, Hinge) { expect_same_bits<Hinge>(157); }
TEST(DeviceCheck, Membranes) { expect_same_bits<Membranes>(915); }
TEST(DeviceCheck, StrainLimit) { expect_same_bits<StrainLimit>(92); }

}  // namespace
