// Families of elements in float and mixed precision against those in double: one source, two scalars.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "barriers/shapes/registry.hpp"
#include "core/energy/membrane_model.hpp"
#include "tests/energy/host_family.hpp"
#include "tests/energy/host_limit.hpp"
#include "tests/energy/strip.hpp"

namespace bb::test::float_families_test {
namespace {

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
    size = std::max(size, std::abs(b[i]));
  }
  return largest / size;
}

/// Of a column in float against the same in double: not equal, and apart by no more than its rounding.
void expect_rounded(const std::vector<double>& in_float, const std::vector<double>& in_double) {
  EXPECT_GT(difference(in_float, in_double), 0);
  EXPECT_LT(difference(in_float, in_double), 1e-4);
  for (const double number : in_float) EXPECT_EQ(static_cast<double>(static_cast<float>(number)), number);
}

void compare(const HostFamily::Make& make, const Positions& x) {
  LocalTerms full, mixed, single;
  const HostFamily in_double(make), in_both(make, Precision::mixed), in_float(make, Precision::single);
  ASSERT_GT(in_double.size(), 30U);
  in_double.derivatives(x, Projection::psd, full);
  in_both.derivatives(x, Projection::psd, mixed);
  in_float.derivatives(x, Projection::psd, single);
  EXPECT_EQ(mixed.energy, full.energy);
  EXPECT_EQ(mixed.grad, full.grad);
  EXPECT_EQ(mixed.hess, single.hess);
  expect_rounded(single.energy, full.energy);
  expect_rounded(single.grad, full.grad);
  expect_rounded(single.hess, full.hess);
  EXPECT_EQ(in_float.values(x), single.energy);
  EXPECT_EQ(in_both.values(x), full.energy);
}

TEST(FloatFamilies, every_element_in_float_has_the_terms_of_double_to_the_rounding_of_float) {
  const Strip strip(40);
  MembranePart part;
  part.triangles = strip.triangles;
  part.lame_mu = part.lame_lambda = std::vector<double>(strip.triangles.size(), 1.0);
  for (const auto& model : membrane_models<double>()) {
    part.model = model.name;
    SCOPED_TRACE(part.model);
    for (const bool planar : {false, true}) compare(membranes_of(part, strip.rest, planar), strip.deformed);
  }
  compare(springs_of(strip.edges, strip.rest, std::vector<double>(strip.edges.size(), 2.0)), strip.deformed);
  HingePart hinges;
  hinges.hinges = strip.hinges;
  hinges.stiffness.assign(strip.hinges.size(), 0.3), hinges.rest_angle.assign(strip.hinges.size(), 0.1);
  compare(hinges_of(hinges), strip.deformed);
}

TEST(FloatFamilies, the_strain_limit_measures_and_bounds_in_float) {
  const Strip strip(40);
  const StrainLimitPart part = limited(strip.triangles, 0, 0.5);
  const auto make = [&](Precision p) {
    HostLimit out(part, strip.rest, false, p);
    out.set_kappa(std::vector<double>(part.width.size(), 2));
    return out;
  };
  HostLimit full = make(Precision::full), mixed = make(Precision::mixed), single = make(Precision::single);
  const BarrierFunction barrier{require_shape("quadratic"), Argument::gap};
  BarrierFunction in_float = barrier;
  in_float.in_float = true;
  const LocalTerms of_full = full.derivatives(strip.deformed, barrier),
                   of_mixed = mixed.derivatives(strip.deformed, barrier),
                   of_single = single.derivatives(strip.deformed, in_float);
  ASSERT_GT(full.n_active(), 10U);
  EXPECT_EQ(of_mixed.grad, of_full.grad);
  expect_rounded(of_single.grad, of_full.grad);
  EXPECT_LT(difference(of_single.hess, of_full.hess), 1e-3);
  EXPECT_LT(difference(of_mixed.hess, of_full.hess), 1e-3);
  EXPECT_NE(of_mixed.hess, of_full.hess);

  Positions stretch = strip.deformed;
  stretch.row(2).setZero();
  const double alpha = full.step_bound(strip.deformed, stretch),
               alpha_in_float = single.step_bound(strip.deformed, stretch);
  ASSERT_LT(alpha, 1);
  EXPECT_NEAR(alpha_in_float, alpha, 1e-5);
  EXPECT_EQ(static_cast<double>(static_cast<float>(alpha_in_float)), alpha_in_float);
  EXPECT_NE(alpha_in_float, alpha);
}

}  // namespace
}  // namespace bb::test::float_families_test
