// The gather of local Hessians: the bits of a plain sum in the order of the elements, whatever the layout of the
// stencils, the size of the family and the number of threads.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

#include "core/linear/gather_map.hpp"
#include "core/math/at.hpp"
#include "core/math/lower_blocks.hpp"

namespace bb::gather_map_test {
namespace {

struct Case {
  int width, size, n_vertices;
  unsigned seed;
};

/// Random stencils: neighbours on a line, in any order, some vertices twice, some missing.
std::vector<int> random_stencils(const Case& c) {
  std::mt19937_64 random(c.seed);
  const auto below = [&random](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  std::vector<int> vertices;
  for (int e = 0; e < c.size; ++e) {
    const int first = below(c.n_vertices - 7);
    for (int k = 0; k < c.width; ++k) vertices.push_back(below(40) == 0 ? -1 : first + below(8));
  }
  return vertices;
}

/// What the matrix has to get, entry by entry, without a map: elements in their order, local blocks in the order of
/// their columns, both orders of a pair that is one vertex twice.
std::vector<double> plain_sum(const Case& c, const std::vector<int>& vertices,
                              const std::vector<double>& hess, const BlockPattern& pattern,
                              std::vector<double> values, int& straight, int& turned) {
  const std::size_t w = at(c.width);
  for (std::size_t e = 0; e < at(c.size); ++e) {
    const int* v = &vertices[w * e];
    for (std::size_t b = 0; b < w; ++b) {
      for (std::size_t a = 0; a < w; ++a) {
        if (v[a] < 0 || v[b] < 0 || v[a] < v[b]) continue;
        double* out = &values[9 * at(pattern.find(v[a], v[b]))];
        const double* in = &hess[n_lower_numbers(w) * e + 9 * lower_block(w, std::max(a, b), std::min(a, b))];
        (a < b ? turned : straight) += 1;
        for (std::size_t k = 0; k < 9; ++k) out[k] += a < b ? in[3 * (k % 3) + k / 3] : in[k];
      }
    }
  }
  return values;
}

class GatherMapTest : public ::testing::TestWithParam<Case> {};

TEST_P(GatherMapTest, AddsInTheOrderOfTheElements) {
  const Case& c = GetParam();
  const std::vector<int> vertices = random_stencils(c);
  const Stencils stencils{c.width, vertices};
  GatherMap map;
  map.build(stencils, c.n_vertices);
  BlockPattern pattern;
  unite(diagonal_pattern(c.n_vertices), map.column_start(), map.rows(), pattern);
  map.place(pattern);

  std::mt19937_64 random(c.seed + 1);
  const auto number = [&random] { return static_cast<double>(random()) * 0x1p-63 - 1; };
  std::vector<double> hess(stencils.size() * n_lower_numbers(at(c.width))), start(9 * pattern.row.size());
  for (double& h : hess) h = number();
  for (double& v : start) v = number();
  int straight = 0, turned = 0;
  const std::vector<double> expected = plain_sum(c, vertices, hess, pattern, start, straight, turned);
  ASSERT_GT(straight, 10);
  ASSERT_GT(turned, 10);
  ASSERT_NE(expected, start);
  for (const std::size_t threads : {std::size_t{1}, std::size_t{2}}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    std::vector<double> values = start;
    map.add_hessians(hess, values);
    EXPECT_EQ(values, expected) << threads << " threads";
  }
}

TEST_P(GatherMapTest, AddsWhatIsBetweenTwoHessians) {
  const Case& c = GetParam();
  const std::vector<int> vertices = random_stencils(c);
  GatherMap map;
  map.build({c.width, vertices}, c.n_vertices);
  BlockPattern pattern;
  unite(diagonal_pattern(c.n_vertices), map.column_start(), map.rows(), pattern);
  map.place(pattern);
  std::vector<double> exact(map.n_elements() * n_lower_numbers(at(c.width))), clamped(exact.size()),
      between(exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    exact[i] = std::sin(static_cast<double>(i)), clamped[i] = std::cos(3.0 * static_cast<double>(i));
    between[i] = exact[i] + 0.125 * (clamped[i] - exact[i]);
  }
  const std::vector<double> zero(9 * pattern.row.size());
  std::vector<double> expected = zero, found = zero, alone = zero;
  map.add_hessians(between, expected);
  map.add_hessians({exact, clamped, 0.125}, found);
  map.add_hessians(exact, alone);
  EXPECT_EQ(found, expected);
  EXPECT_NE(alone, expected);
  EXPECT_THROW(map.add_hessians({exact, std::span(clamped).first(9), 0.125}, found), std::logic_error);
}

// The last two on either side of the size from which the Hessians are prefetched, 8 MiB: 11650 elements of width 4.
INSTANTIATE_TEST_SUITE_P(Families, GatherMapTest,
                         ::testing::Values(Case{2, 90, 20, 1}, Case{3, 400, 90, 2}, Case{4, 300, 60, 3},
                                           Case{4, 3000, 5000, 4}, Case{4, 11000, 3000, 5},
                                           Case{4, 12500, 3000, 6}));

}  // namespace
}  // namespace bb::gather_map_test
