// Which queries get an offset for their rounding: those that were rounded to the scalar that they are evaluated in, and no
// others. A pair that stands still just above the rounding of its coordinates shows which.
#include <gtest/gtest.h>

#include "experiments/ccd/score.hpp"

namespace bb::ccd {
namespace {

/// A pair that stands still at the distance d along z; |coordinates| up to 1.
Query still(PairKind kind, double d, bool hits) {
  Query q;
  if (kind == PairKind::point_triangle) {
    q.x0 << 0, -1, 1, 0,  //
        0, -1, -1, 1,     //
        d, 0, 0, 0;
  } else {
    q.x0 << -1, 1, 0, 0,  //
        0, 0, -1, 1,      //
        d, d, 0, 0;
  }
  q.x1 = q.x0;
  q.hits = hits;
  return q;
}

const Score& find(const std::vector<Score>& scores, const char* precision, const char* method) {
  for (const Score& s : scores) {
    if (s.precision == precision && s.method == method) return s;
  }
  throw std::logic_error("no such score");
}

std::vector<Score> scores_of(PairKind kind, const Query& query) {
  QuerySet set;
  (kind == PairKind::point_triangle ? set.point_triangle : set.edge_edge) = {query};
  return score_queries(set);
}

/// 17 ulps are above the 16 below which a pair counts as touching; with the offset of a rounded query, two ulps, they
/// are not.
TEST(CcdRounding, OnlyWhatWasRoundedToAScalarIsAskedWithAnOffsetInIt) {
  int offsets = 0, none = 0;
  for (const PairKind kind : {PairKind::point_triangle, PairKind::edge_edge}) {
    for (const bool in_double : {false, true}) {
      for (const bool in_float : {false, true}) {
        Query at_double = still(kind, 17 * std::numeric_limits<double>::epsilon(), false);
        Query at_float = still(kind, 17.0 * std::numeric_limits<float>::epsilon(), false);
        for (Query* q : {&at_double, &at_float}) q->rounded_double = in_double, q->rounded_float = in_float;
        const std::vector<Score> doubles = scores_of(kind, at_double), floats = scores_of(kind, at_float);
        EXPECT_EQ(find(doubles, "double", "accd").false_positives, in_double ? 1U : 0U) << in_float;
        EXPECT_EQ(find(floats, "float", "accd").false_positives, in_float ? 1U : 0U) << in_double;
        EXPECT_EQ(find(floats, "double", "accd").false_positives, 0U);
        offsets += in_double + in_float;
        none += !in_double + !in_float;
      }
    }
  }
  EXPECT_EQ(offsets, 8);
  EXPECT_EQ(none, 8);
}

/// The exact test decides nothing of what was rounded to double, and is applied to all else.
TEST(CcdRounding, TheExactTestLeavesOutWhatIsNoDouble) {
  int judged = 0;
  for (const PairKind kind : {PairKind::point_triangle, PairKind::edge_edge}) {
    for (const bool in_double : {false, true}) {
      for (const bool in_float : {false, true}) {
        Query query = still(kind, 0.25, true);  // a truth that is wrong: counted as a miss where it is tested
        query.rounded_double = in_double, query.rounded_float = in_float;
        const std::vector<Score> scores = scores_of(kind, query);
        const Score& audit = find(scores, "double", "audit");
        EXPECT_EQ(audit.left_out, in_double ? 1U : 0U);
        EXPECT_EQ(audit.queries, in_double ? 0U : 1U);
        EXPECT_EQ(audit.false_negatives, in_double ? 0U : 1U);
        for (const char* precision : {"double", "float"}) {
          const Score& accd = find(scores, precision, "accd");
          EXPECT_EQ(accd.queries, 1U);
          EXPECT_EQ(accd.left_out, 0U);
          EXPECT_EQ(accd.positives, 1U);
          EXPECT_EQ(accd.false_negatives, 1U);
        }
        EXPECT_TRUE(any_false_negative(scores));
        ++judged;
      }
    }
  }
  EXPECT_EQ(judged, 8);
}

}  // namespace
}  // namespace bb::ccd
