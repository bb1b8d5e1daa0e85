// Queries with a known truth: the reader, the generator, and that neither continuous test ever misses a hit.
#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>

#include "core/math/error.hpp"
#include "experiments/ccd/head_on.hpp"
#include "experiments/ccd/random_queries.hpp"
#include "experiments/ccd/read_queries.hpp"
#include "experiments/ccd/score.hpp"
#include "tests/exact/exact_closest.hpp"
#include "tests/optional_data.hpp"

namespace bb::ccd {
namespace {

using Points = Mat<double, 3, 4>;
constexpr int n_random = 6000;

/// Eight rows: a point at (0, 0, z0) that moves to z1, above the triangle (0 0 0), (1 0 0), (0 1/3 0).
std::string rows(const std::string& z0, const std::string& z1, const std::string& truth) {
  const std::string triangle =
      "0,1,0,1,0,1," + truth + "\n1,1,0,1,0,1," + truth + "\n0,1,1,3,0,1," + truth + "\n";
  return "0,1,0,1," + z0 + "," + truth + "\n" + triangle + "0,1,0,1," + z1 + "," + truth + "\n" + triangle;
}

std::string complaint(const std::string& text) {
  try {
    parse_queries(text, "a.csv");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(CcdFiles, RowsAreReadAndRoundingIsSeen) {
  const auto queries = parse_queries(rows("1,2", "-1,4", "1") + rows("1,2", "1,1", "0"), "a.csv");
  ASSERT_EQ(queries.size(), 2U);
  EXPECT_EQ(queries[0].x0(2, 0), 0.5);
  EXPECT_EQ(queries[0].x1(2, 0), -0.25);
  EXPECT_EQ(queries[0].x0(1, 3), 1.0 / 3);  // the nearest double
  EXPECT_TRUE(queries[0].hits);
  EXPECT_FALSE(queries[1].hits);
  EXPECT_TRUE(queries[0].rounded_double);
  EXPECT_TRUE(queries[0].rounded_float);
}

TEST(CcdFiles, ALeadingZeroIsDecimal) {
  const auto queries = parse_queries(rows("010,02", "09,1", "0"), "a.csv");
  ASSERT_EQ(queries.size(), 1U);
  EXPECT_EQ(queries[0].x0(2, 0), 5);
  EXPECT_EQ(queries[0].x1(2, 0), 9);
}

TEST(CcdFiles, FaultsAreNamedWithTheirLine) {
  EXPECT_NE(complaint(rows("1,0", "1,2", "1")).find("a.csv:1: found a denominator of 0"), std::string::npos);
  EXPECT_NE(complaint(rows("1,2", "x,2", "1")).find("a.csv:5: found \"x\""), std::string::npos);
  EXPECT_NE(complaint(rows("1,2", "1,2", "2")).find("a.csv:1: found the truth \"2\""), std::string::npos);
  EXPECT_NE(complaint("1,2,3\n").find("a.csv:1: found 3 fields"), std::string::npos);
  EXPECT_NE(complaint("").find("a.csv: found 0 rows"), std::string::npos);
  EXPECT_NE(complaint(rows("1,2", "1,2", "0").substr(14)).find("found 7 rows"), std::string::npos);
  EXPECT_NE(complaint(rows("1" + std::string(400, '0') + ",1", "1,2", "0")).find("too large"),
            std::string::npos);
  EXPECT_NE(complaint(rows("1,1", "-1,1", "1").replace(26, 1, "0")).find("another truth"), std::string::npos);
}

/// By exact distances at sixteenths of the time: those that hit touch at one of them, the others never do.
TEST(CcdRandom, TruthHoldsInExactArithmetic) {
  const QuerySet queries = random_queries(240, 9);
  for (const PairKind kind : {PairKind::point_triangle, PairKind::edge_edge}) {
    int hits = 0;
    for (const Query& q : queries.of(kind)) {
      const Mat<float, 3, 4> f0 = q.x0.cast<float>(), f1 = q.x1.cast<float>();
      EXPECT_EQ(Points(f0.cast<double>()), q.x0);
      EXPECT_EQ(Points(f1.cast<double>()), q.x1);
      bool touches = false;
      for (int k = 0; k <= 16; ++k) {
        const Mat<double, 3, 4> x = q.x0 + (k / 16.0) * (q.x1 - q.x0);  // without rounding: 24 + 4 bits
        touches = touches || test::exact_distance(test::exact_pair(x, pair_split(kind))).num == 0;
      }
      EXPECT_EQ(touches, q.hits);
      hits += q.hits;
    }
    EXPECT_EQ(hits, 120);
  }
}

TEST(CcdRandom, NoFalseNegative) {
  const std::vector<Score> scores = score_queries(random_queries(n_random, 1));
  std::cout << score_table(scores);
  ASSERT_EQ(scores.size(), 6U);
  for (const Score& s : scores) {
    EXPECT_EQ(s.queries, static_cast<std::size_t>(n_random));
    EXPECT_EQ(s.positives, static_cast<std::size_t>(n_random / 2));
    EXPECT_EQ(s.left_out, 0U);
    EXPECT_EQ(s.false_negatives, 0U) << s.pair << s.precision << s.method;
    // Free pairs stay a unit of 2^-10 m apart before a map that shrinks lengths by less than 30: far above 1e-9 of
    // the coordinates, where double has to say so.
    if (s.precision == "double") {
      EXPECT_EQ(s.false_positives, 0U) << s.pair << s.method;
    }
  }
  EXPECT_FALSE(any_false_negative(scores));
}

TEST(CcdHandMade, NoFalseNegative) {
  const std::filesystem::path data = optional_data("ccd-queries");
  if (!std::filesystem::is_directory(data)) GTEST_SKIP() << "no CCD queries at " << data;
  const std::vector<Score> scores = score_queries(read_queries(data.string()));
  std::cout << score_table(scores);
  ASSERT_EQ(scores.size(), 6U);
  for (const Score& s : scores) {
    EXPECT_GT(s.queries, 1500U);
    EXPECT_GT(s.positives, 50U);
    EXPECT_EQ(s.false_negatives, 0U) << s.pair << s.precision << s.method;
  }
}

TEST(CcdHeadOn, NoAcceptedStateHasCrossed) {
  const std::vector<HeadOn> rows = head_on_sweeps(400, 1);
  std::cout << head_on_table(rows);
  ASSERT_EQ(rows.size(), 24U);
  int moved = 0;
  for (const HeadOn& row : rows) {
    EXPECT_EQ(row.crossed, 0) << row.precision << " " << row.offset << " " << row.gap;
    EXPECT_EQ(row.sweeps, 400);
    moved += row.sweeps - row.start_wrong - row.refused;
  }
  EXPECT_GT(moved, 4000);
  EXPECT_FALSE(any_crossed(rows));
}

}  // namespace
}  // namespace bb::ccd
