// Boxes of kernels are those of the CPU path, bit for bit; Morton codes interleave; rows are found in sorted lists.
#include <gtest/gtest.h>

#include <random>

#include "core/contact/executor/pair_search.hpp"
#include "core/contact/executor/tree_kernels.hpp"
#include "core/contact/tree_box.hpp"

namespace bb::test::float_box_test {
namespace {

using namespace exec;

std::vector<double> awkward_numbers() {
  constexpr double inf = std::numeric_limits<double>::infinity();
  std::vector<double> out{0.0,     -0.0,   1,    -1,    1e-300,
                          -1e-300, 5e-324, 1e38, -1e38, 1e39,
                          -1e39,   1e300,  inf,  -inf,  std::numeric_limits<double>::quiet_NaN()};
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 400; ++i) out.push_back(unit(random) * std::pow(10, 12 * unit(random)));
  return out;
}

bool same(float a, float b) {
  return (std::isnan(a) && std::isnan(b)) || (a == b && std::signbit(a) == std::signbit(b));
}

TEST(FloatBox, IsTheTreeBoxOfTheCpuPath) {
  const std::vector<double> numbers = awkward_numbers();
  std::mt19937_64 random(3);
  int compared = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const auto pick = [&] { return numbers[random() % numbers.size()]; };
    TreeBox tree;
    FloatBox box = empty_box();
    for (int k = 0; k < 2; ++k) {
      const Vec3d p(pick(), pick(), pick());
      const Vec3d around(std::abs(pick()), k * 0x1p-50, 0);
      tree.add(p, around);
      for (int c = 0; c < 3; ++c) add_coordinate(box, c, p[c], around[c]);
    }
    const double margin = std::abs(pick());
    tree.inflate(margin);
    inflate(box, margin);
    for (int c = 0; c < 3; ++c) {
      ASSERT_TRUE(same(box.lo[c], tree.lo[c]) && same(box.hi[c], tree.hi[c])) << trial;
      compared += box.lo[c] < box.hi[c];
    }
  }
  EXPECT_GT(compared, 30000);
}

TEST(FloatBox, SortableBitsAreInTheOrderOfTheNumbers) {
  std::vector<double> numbers = awkward_numbers();
  std::erase_if(numbers, [](double x) { return std::isnan(x); });
  for (const double a : numbers) {
    EXPECT_EQ(from_sortable_bits(sortable_bits(a)), a);
    for (const double b : numbers) {
      EXPECT_TRUE(a == b || (sortable_bits(a) < sortable_bits(b)) == (a < b)) << a << " " << b;
    }
  }
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GT(sortable_bits(none), sortable_bits(std::numeric_limits<double>::infinity()));
  EXPECT_LT(sortable_bits(-none), sortable_bits(-std::numeric_limits<double>::infinity()));
}

TEST(FloatBox, MortonBitsAreThirdBits) {
  for (int bit = 0; bit < 21; ++bit) EXPECT_EQ(spread(Key{1} << bit), Key{1} << 3 * bit);
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 1000; ++trial) {
    const Key x = random() & 0x1fffff;
    Key expected = 0;
    for (int bit = 0; bit < 21; ++bit) expected |= (x >> bit & 1) << 3 * bit;
    EXPECT_EQ(spread(x), expected);
  }
}

TEST(SortedRows, HoldsWhatIsThere) {
  std::vector<int> rows;
  for (int a = 0; a < 6; ++a) {
    for (int b = a; b < 6; b += 2) rows.insert(rows.end(), {a, b, 7 - a});
  }
  int found = 0;
  const SortedRows<3> sorted{rows.data(), static_cast<Index>(rows.size() / 3)};
  for (int a = -1; a < 8; ++a) {
    for (int b = -1; b < 8; ++b) {
      for (int c = -1; c < 9; ++c) {
        const bool expected = a >= 0 && a < 6 && b >= a && b < 6 && (b - a) % 2 == 0 && c == 7 - a;
        EXPECT_EQ(sorted.holds({a, b, c}), expected);
        found += expected;
      }
    }
  }
  EXPECT_EQ(found, static_cast<int>(rows.size() / 3));
  EXPECT_FALSE((SortedRows<3>{nullptr, 0}.holds({1, 2, 3})));
}

}  // namespace
}  // namespace bb::test::float_box_test
