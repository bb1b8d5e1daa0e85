// Vector operations of a Newton iteration on an executor, against loops.
#include "core/exec/sums/vectors.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/model/scene/pinned_vertices.hpp"
#include "tests/executor/on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec::vectors_test {
namespace {

using namespace bb::test;

struct Vectors {
  Scene scene = cloth_scene("arap", false, 6);
  std::vector<std::uint8_t> fixed = std::vector<std::uint8_t>(3 * scene.mass.size(), 0);
  test::TestedExecutor executor{exec::Order::shuffled};
  exec::Buffer<double> x{executor, "x"}, dx{executor, "dx"}, out{executor, "out"};
  Positions x_host = strained(scene), dx_host = wave(scene, 0.2), target = scene.x0;

  Vectors() {
    for (const Pin& pin : scene.pins) {
      for (std::size_t k = 0; k < 3; ++k) fixed[3 * static_cast<std::size_t>(pin.vertex) + k] = 1;
      dx_host(0, pin.vertex) = 100;  // must not be seen
    }
    for (std::size_t i = 2; i < fixed.size(); i += 6) fixed[i] = 1;  // locked in one direction
    for (const Pin& pin : scene.pins) target.col(pin.vertex) += Vec3d(0.1, 0.2, 0.3);
    x.upload(numbers_of(x_host));
    dx.upload(numbers_of(dx_host));
  }
  Positions down(const exec::Buffer<double>& column) const {
    Positions host(3, column.size() / 3);
    column.download({host.data(), static_cast<std::size_t>(host.size())});
    return host;
  }
};

TEST(Vectors, MovePutsPinsOnTargetAtTheEndOfAStepOnly) {
  Vectors v;
  VectorTools tools(v.executor, v.fixed, pinned_vertices(v.scene));
  tools.set_targets(v.target);
  ASSERT_EQ(v.scene.pins.size(), 3u);
  const auto short_pin = [&] {
    tools.look_at_pins(v.out);
    return tools.first_short_pin();
  };
  tools.move(v.x, v.dx, 0.3, v.out);
  EXPECT_EQ(v.down(v.out), Positions(v.x_host + 0.3 * v.dx_host));
  EXPECT_EQ(short_pin(), 0);
  tools.move_to_targets(v.x, v.dx, v.out);
  Positions expected = v.x_host + v.dx_host;
  for (const Pin& pin : v.scene.pins) expected.col(pin.vertex) = v.target.col(pin.vertex);
  EXPECT_EQ(v.down(v.out), expected);
  EXPECT_EQ(short_pin(), -1);
  v.out.set(3 * v.scene.pins[1].vertex, 0.0);
  EXPECT_EQ(short_pin(), 1);
  tools.set_pin_motion(v.x, v.dx);
  for (const Pin& pin : v.scene.pins) {
    EXPECT_EQ(v.down(v.dx).col(pin.vertex), Vec3d(v.target.col(pin.vertex) - v.x_host.col(pin.vertex)));
  }
  EXPECT_EQ(v.down(v.dx).col(7), v.dx_host.col(7));
}

TEST(Vectors, NormsAndProductsLeaveFixedDegreesOfFreedomOut) {
  Vectors v;
  VectorTools tools(v.executor, v.fixed, pinned_vertices(v.scene));
  double largest = 0, largest_free = 0;
  long double dot = 0, magnitude = 0;
  for (std::size_t i = 0; i < v.fixed.size(); ++i) {
    const double a = v.dx_host.data()[i], b = v.x_host.data()[i];
    largest = std::max(largest, std::abs(a));
    if (v.fixed[i]) continue;
    largest_free = std::max(largest_free, std::abs(a));
    dot += a * b, magnitude += std::abs(a * b);
  }
  EXPECT_EQ(largest, 100);
  EXPECT_EQ(tools.max(v.dx), largest);
  EXPECT_EQ(tools.free_max(v.dx), largest_free);
  EXPECT_GT(largest_free, 0.1);
  const Compensated found = tools.free_dot(v.dx, v.x);
  EXPECT_NEAR(found.value(), static_cast<double>(dot), 1e-15 * static_cast<double>(magnitude));
  EXPECT_NE(found.value(), 0);
  tools.force_norms(v.dx, v.out);
  ASSERT_EQ(v.out.size(), v.scene.n_vertices());
  for (Index i = 0; i < v.out.size(); ++i) {
    Vec3d g = v.dx_host.col(i);
    for (Index k = 0; k < 3; ++k) {
      if (v.fixed[static_cast<std::size_t>(3 * i + k)]) g[k] = 0;
    }
    EXPECT_EQ(v.out.get(i), g.norm());
  }
}

TEST(Vectors, FindWhatIsNoNumber) {
  Vectors v;
  VectorTools tools(v.executor, v.fixed, pinned_vertices(v.scene));
  EXPECT_EQ(tools.first_not_finite(v.x), -1);
  v.x.set(40, INFINITY);
  v.x.set(17, std::nan(""));
  EXPECT_EQ(tools.first_not_finite(v.x), 17);
}

TEST(Vectors, FixedBitsAreThreeAVertex) {
  EXPECT_EQ(fixed_bits(std::vector<std::uint8_t>{1, 0, 1, 0, 0, 0, 0, 7, 0}),
            (std::vector<FixedMask>{5, 0, 2}));
}

TEST(Vectors, DirectionsAreSplitAtTheRoundingOfTheirVertex) {
  Vectors v;
  VectorTools tools(v.executor, v.fixed, pinned_vertices(v.scene));
  std::vector<double> sizes(v.scene.mass.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = 1e-3 * static_cast<double>(i % 5);
  exec::Buffer<double> body_size{v.executor, "sizes"};
  body_size.upload(sizes);
  int split = 0;
  for (const double scale : {1.0, 1e-13, 1e-14, 1e-15, 1e-17}) {
    const Positions dx = scale * v.dx_host;
    v.dx.upload(numbers_of(dx));
    double largest[2] = {0, 0};
    for (std::size_t i = 0; i < v.fixed.size(); ++i) {
      if (v.fixed[i]) continue;
      const double* x = v.x_host.data() + 3 * (i / 3);
      const bool within = within_coordinate_rounding(dx.data()[i], x, sizes[i / 3], 0x1p-52);
      largest[within] = std::max(largest[within], std::abs(dx.data()[i]));
    }
    tools.look_at_direction(v.dx, v.x, body_size, 0x1p-52);
    const exec::DirectionSizes found = tools.direction_sizes();
    EXPECT_EQ(found.within, largest[1]) << scale;
    EXPECT_EQ(found.beyond, largest[0]) << scale;
    EXPECT_EQ(found.largest, std::max(largest[0], largest[1])) << scale;
    EXPECT_DOUBLE_EQ(found.vertex, dx.colwise().norm().maxCoeff()) << scale;
    split += largest[0] > 0 && largest[1] > 0 ? 1 : 0;
  }
  EXPECT_GT(split, 0);
}

// Several items a thread.
TEST(Vectors, LongestOfMany) {
  constexpr std::size_t n = 1'310'721;
  std::vector<double> values(3 * n);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::sin(static_cast<double>(i));
  values[3 * (n - 2)] = 3, values[3 * (n - 2) + 1] = 4, values[3 * (n - 2) + 2] = 0;
  test::TestedExecutor executor;
  exec::Buffer<double> column(executor, "many vectors"), zero(executor, "zeros", static_cast<Index>(3 * n));
  exec::Buffer<FixedMask> fixed(executor, "fixed", static_cast<Index>(n));
  column.upload(values), zero.fill_zero(), fixed.fill_zero();
  ExecutorSums<DirectionKeys> sizes(executor);
  sizes.add(static_cast<Index>(n), DirectionParts{column.data(), zero.data(), zero.data(), fixed.data(), 0});
  EXPECT_EQ(largest_of(sizes.get().vertex), 5);
  EXPECT_EQ(largest_of(sizes.get().largest), 4);
}

TEST(Vectors, ASolutionIsAddedWithItsProducts) {
  Vectors v;
  VectorTools tools(v.executor, v.fixed, pinned_vertices(v.scene));
  const Positions step_host = wave(v.scene, 0.7), expected = v.dx_host + step_host;
  exec::Buffer<double> step(v.executor, "step");
  step.upload(numbers_of(step_host));
  tools.take_solution(step, v.x, v.x, v.dx);
  const TwoSums found = tools.solution_products();
  EXPECT_EQ(v.down(v.dx), expected);
  for (const auto& [sum, other] : {std::pair(found.first, &step), std::pair(found.second, &v.dx)}) {
    const Compensated product = tools.free_dot(v.x, *other);
    ASSERT_NE(product.value(), 0);
    EXPECT_EQ(sum.sum, product.sum);
    EXPECT_EQ(sum.carry, product.carry);
  }
}

}  // namespace
}  // namespace bb::exec::vectors_test
