// Known answers of `eval` about pairs of primitives: distance, ccd, intersects, friction.
#include <vector>

#include "tests/experiments/eval_asking.hpp"

namespace bb::test::eval_geometry_test {
namespace {

TEST(EvalDistance, WeightsAndRegions) {
  const json edge =
      ask({{"kind", "distance"}, {"pair", "point_edge"}, {"points", {{0.25, 2, 0}, {0, 0, 0}, {1, 0, 0}}}});
  EXPECT_EQ(edge, json({{"d", 2.0}, {"weights", {1.0, -0.75, -0.25}}, {"region", "p_e"}}));
  const json triangle = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto region = [&](double x, double y) {
    const json points = {{x, y, 0.5}, triangle[0], triangle[1], triangle[2]};
    return ask({{"kind", "distance"}, {"pair", "point_triangle"}, {"points", points}})["region"]
        .get<std::string>();
  };
  EXPECT_EQ(region(0.2, 0.2), "p_t");
  EXPECT_EQ(region(-1, -1), "p_t0");
  EXPECT_EQ(region(3, 0), "p_t1");
  EXPECT_EQ(region(0, 3), "p_t2");
  EXPECT_EQ(region(0.5, -1), "p_e01");
  EXPECT_EQ(region(1, 1), "p_e12");
  EXPECT_EQ(region(-1, 0.5), "p_e20");
  const json crossed = ask({{"kind", "distance"},
                            {"pair", "edge_edge"},
                            {"points", {{0, 0, 0}, {1, 0, 0}, {0.5, -1, 1}, {0.5, 1, 1}}}});
  EXPECT_EQ(crossed, json({{"d", 1.0}, {"weights", {0.5, 0.5, -0.5, -0.5}}, {"region", "ea_eb"}}));
}

TEST(EvalCcd, HitMissAndOverlap) {
  json query = {{"kind", "ccd"},
                {"pair", "point_triangle"},
                {"points_t0", {{0.2, 0.2, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                {"points_t1", {{0.2, 0.2, -1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
  const json hit = ask(query);
  EXPECT_TRUE(hit["hit"].get<bool>());
  EXPECT_LE(hit["toi"].get<double>(), 0.5);
  EXPECT_GT(hit["toi"].get<double>(), 0.5 - 1e-9);
  EXPECT_EQ(hit.size(), 2u);

  query["offset"] = 0.5;
  EXPECT_NEAR(ask(query)["toi"].get<double>(), 0.25, 1e-9);
  query["points_t1"][0] = {0.2, 0.2, 0.75};
  EXPECT_EQ(ask(query), json({{"hit", false}, {"toi", 1.0}}));
  query["offset"] = 1;
  EXPECT_EQ(ask(query), json({{"hit", true}, {"toi", 0.0}, {"status", "overlap_at_start"}}));
}

TEST(EvalIntersects, CrossingTouchAndNeither) {
  const auto at = [](double x, double y, double z0, double z1) {
    return ask({{"kind", "intersects"},
                {"segment", {{x, y, z0}, {x, y, z1}}},
                {"triangle", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}});
  };
  EXPECT_EQ(at(0.2, 0.2, -1, 1), json({{"crossing", true}, {"touch", false}}));
  EXPECT_EQ(at(0.2, 0.2, 0, 1), json({{"crossing", false}, {"touch", true}}));
  EXPECT_EQ(at(0.5, 0.5, -1, 1), json({{"crossing", false}, {"touch", true}}));
  EXPECT_EQ(at(2, 2, -1, 1), json({{"crossing", false}, {"touch", false}}));
}

/// A point over a triangle's inside, at weights 1/2, 1/4, 1/4, that slides by `length` along x while both move along z.
json sliding(const char* law, double length) {
  return {{"kind", "friction"},
          {"law", law},
          {"mu", 0.5},
          {"load", 8},
          {"eps", 0.1},
          {"pair", "point_triangle"},
          {"points_lagged", {{1, 1, 0.5}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
          {"points_start", {{5, 5, 5}, {1, 1, 1}, {2, 1, 1}, {1, 2, 1}}},
          {"points_end", {{5 + length, 5, 6}, {1, 1, 2}, {2, 1, 1}, {1, 2, 7}}}};
}

TEST(EvalFriction, ClosedFormsOnATriangle) {
  const double eps = 0.1, force = 4, y = 0.03, r = 0.3;
  const std::vector<double> weight{1, -0.5, -0.25, -0.25};
  const auto expect_spread = [&](const json& answer, double along, double across, double pull) {
    for (int i = 0; i < 12; ++i) {
      EXPECT_NEAR(answer["gradient"][i].get<double>(), i % 3 == 0 ? weight[i / 3] * pull : 0, 1e-12);
      for (int j = 0; j < 12; ++j) {
        const double value = i % 3 != j % 3 || i % 3 == 2 ? 0 : i % 3 == 0 ? along : across;
        EXPECT_NEAR(answer["hessian"][i][j].get<double>(), weight[i / 3] * weight[j / 3] * value, 1e-10);
      }
    }
    EXPECT_EQ(answer["hessian"], answer["hessian_psd"]);
  };
  const json smoothed = ask(sliding("smoothed_coulomb", y));
  expect_close(smoothed["slide"], y, 1e-13);
  expect_close(smoothed["energy"], force * (eps / 3 + y * y / eps - y * y * y / (3 * eps * eps)));
  expect_spread(smoothed, force * 2 * (1 - r) / eps, force * (2 - r) / eps, force * (2 * r - r * r));
  const json capped = ask(sliding("capped", y));
  expect_close(capped["energy"], force * (eps + y * y / eps) / 2);
  expect_spread(capped, force / eps, force / eps, force * r);
  for (const char* law : {"smoothed_coulomb", "capped"}) {
    const json whole = ask(sliding(law, 0.4));
    expect_close(whole["energy"], force * 0.4);
    expect_spread(whole, 0, force / 0.4, force);
    const json rest = ask(sliding(law, 0));
    EXPECT_EQ(rest["slide"], 0.0);
    expect_spread(rest, rest["hessian"][0][0], rest["hessian"][0][0], 0);
    EXPECT_GT(rest["hessian"][0][0], 39);
  }
}

TEST(EvalFriction, RunsInFloatAndRefusesWhatHasNoMeaning) {
  json query = sliding("smoothed_coulomb", 0.03);
  const json exact = ask(query);
  query["precision"] = "float";
  const json single = ask(query);
  EXPECT_NE(single["energy"], exact["energy"]);
  expect_close(single["energy"], exact["energy"], 1e-5);  // 0.03 m on coordinates of 5 m
  for (const char* name : {"mu", "load", "eps"}) {
    query = sliding("capped", 0.03);
    query[name] = -1;
    EXPECT_NE(refused(query).find(std::string("/") + name), std::string::npos);
  }
  query = sliding("capped", 0.03);
  query["eps"] = 0;
  EXPECT_NE(refused(query).find("a number > 0"), std::string::npos);
  query = sliding("kapped", 0.03);
  EXPECT_NE(refused(query).find("did you mean capped?"), std::string::npos);
  query = sliding("capped", 0.03);
  query["points_lagged"][0] = {1, 1, 0};
  EXPECT_NE(refused(query).find("a pair that touches"), std::string::npos);
  query["points_lagged"].erase(0);
  EXPECT_NE(refused(query).find("/points_lagged"), std::string::npos);
}

}  // namespace
}  // namespace bb::test::eval_geometry_test
