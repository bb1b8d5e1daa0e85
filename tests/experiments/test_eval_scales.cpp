// Answers of `eval` about pairs of any size: those of the same pair at size 1, and lines that are too long.
#include <cmath>
#include <string>

#include "tests/experiments/eval_asking.hpp"

namespace bb::test::eval_scales_test {
namespace {

json scaled(json points, double by) {
  for (json& point : points) {
    for (json& c : point) c = c.get<double>() * by;
  }
  return points;
}

struct Pair {
  const char* name;
  json points, moved;  // none overlaps at either end, all pass through each other but the last
};
const Pair pairs[] = {
    {"point_point", {{0.3, 0.2, 0.7}, {0.1, -0.4, 0.2}}, {{-0.1, -1.0, -0.3}, {0.1, -0.4, 0.2}}},
    {"point_edge",
     {{0.25, 0.6, 0.0}, {-0.5, 0.1, 0.0}, {0.75, -0.2, 0.0}},
     {{0.25, -0.9, 0.0}, {-0.5, 0.1, 0.0}, {0.75, -0.2, 0.0}}},
    {"point_triangle",
     {{0.2, 0.3, 0.6}, {0, 0, 0.1}, {0.9, 0.1, 0}, {0.1, 0.8, -0.1}},
     {{0.2, 0.3, -0.6}, {0, 0, 0.1}, {0.9, 0.1, 0}, {0.1, 0.8, -0.1}}},
    {"edge_edge",
     {{-0.5, 0.1, 0.4}, {0.7, 0.2, 0.5}, {0.1, -0.6, 0}, {0.2, 0.8, -0.1}},
     {{-0.5, 0.1, 0.9}, {0.7, 0.2, 0.8}, {0.1, -0.6, 0}, {0.2, 0.8, -0.1}}}};

/// Powers of two, so that nothing is rounded: beyond 2^170 (float: 2^21) the product of six lengths overflows.
std::vector<int> exponents(const std::string& precision) {
  return precision == "double" ? std::vector<int>{-1000, -400, -171, -30, 30, 171, 400, 1000}
                               : std::vector<int>{-100, -40, -22, -10, 10, 22, 40, 100};
}

TEST(EvalScales, DistancesGrowWithTheirPairAndWeightsStay) {
  for (const std::string precision : {"double", "float"}) {
    for (const Pair& pair : pairs) {
      const auto answer = [&](double by) {
        return ask({{"kind", "distance"},
                    {"pair", pair.name},
                    {"points", scaled(pair.points, by)},
                    {"precision", precision}});
      };
      const json here = answer(1);
      ASSERT_GT(here["d"], 0.1);
      for (const int exponent : exponents(precision)) {
        json there = answer(std::ldexp(1.0, exponent));
        EXPECT_EQ(std::ldexp(there["d"].get<double>(), -exponent), here["d"].get<double>())
            << pair.name << exponent;
        there["d"] = here["d"];
        EXPECT_EQ(there, here) << pair.name << exponent;
      }
    }
  }
}

TEST(EvalScales, TimesOfImpactStay) {
  for (const std::string precision : {"double", "float"}) {
    int hits = 0;
    for (const Pair& pair : pairs) {
      const auto answer = [&](double by) {
        return ask({{"kind", "ccd"},
                    {"pair", pair.name},
                    {"points_t0", scaled(pair.points, by)},
                    {"points_t1", scaled(pair.moved, by)},
                    {"offset", 0.125 * by},
                    {"park", 0.03125 * by},
                    {"precision", precision}});
      };
      const json here = answer(1);
      hits += here["hit"].get<bool>() ? 1 : 0;
      ASSERT_GT(here["toi"], 0.1);
      for (const int exponent : exponents(precision)) {
        EXPECT_EQ(answer(std::ldexp(1.0, exponent)), here) << pair.name << exponent;
      }
    }
    EXPECT_EQ(hits, 3);
  }
}

TEST(EvalScales, AGapThatItsMotionDwarfsIsNoOverlap) {
  const json answer = ask({{"kind", "ccd"},
                           {"pair", "point_point"},
                           {"points_t0", {{0, 0, 0}, {1, 0, 0}}},
                           {"points_t1", {{0, 0, 0}, {-1e200, 0, 0}}}});
  EXPECT_EQ(answer, json({{"hit", true}, {"toi", 0.0}}));
}

TEST(EvalScales, FrictionSlidesAlongATinyLaggedPair) {
  json query = {{"kind", "friction"},
                {"law", "capped"},
                {"mu", 0.5},
                {"load", 2},
                {"eps", 0.1},
                {"pair", "point_triangle"},
                {"points_lagged", pairs[2].points},
                {"points_start", pairs[2].points},
                {"points_end", pairs[2].moved}};
  const json here = ask(query);
  ASSERT_GT(here["slide"], 0.1);
  for (const int exponent : {-900, 900}) {
    query["points_lagged"] = scaled(pairs[2].points, std::ldexp(1.0, exponent));
    EXPECT_EQ(ask(query), here) << exponent;
  }
}

TEST(EvalScales, AStiffnessBeyondDoublesIsInfinite) {
  const json rest =
      ask({{"kind", "equilibrium"}, {"shape", "log"}, {"kappa", 1}, {"d_hat", 1}, {"load", 1e300}});
  EXPECT_NEAR(rest["d"].get<double>() * 1e300, 1, 1e-9);
  EXPECT_TRUE(rest["K"].is_null());
  EXPECT_EQ(rest["status"], "infinite");
}

TEST(EvalScales, ALineThatIsTooLongSparesTheOthers) {
  const std::string good = R"({"id": 1, "kind": "rho", "shape": "cubic", "u": 0.5})";
  const Reply reply = ask_text(good + "\n{\"id\": 2, \"kind\": \"" + std::string(max_query_bytes, 'x') +
                               "\"}\n" + good + "\n");
  ASSERT_EQ(reply.answers.size(), 3U);
  EXPECT_EQ(reply.code, 2);
  EXPECT_EQ(reply.answers[0], reply.answers[2]);
  EXPECT_NE(reply.answers[1]["error"].get<std::string>().find("at most"), std::string::npos);
  EXPECT_TRUE(reply.answers[1]["id"].is_null());
  EXPECT_EQ(reply.talk, "eval: 1 of 3 queries could not be answered\n");
}

}  // namespace
}  // namespace bb::test::eval_scales_test
