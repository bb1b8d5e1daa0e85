// Known answers of `eval` about what a contact or an element is given: stiffness, strain_limit, svd, condition.
#include "tests/experiments/eval_asking.hpp"

namespace bb::test::eval_kinds_test {
namespace {

TEST(EvalStiffness, PoliciesByHand) {
  json query = {{"kind", "stiffness"},  {"policy", "elasticity_inclusive"},
                {"mass_term", "paper"}, {"weights", {1, -0.5}},
                {"normal", {0, 1, 0}},  {"gap", 0.1},
                {"masses", {2, 4}}};
  query["hessian"] = json::array();
  for (int i = 0; i < 6; ++i) {
    json row = json::array();
    for (int j = 0; j < 6; ++j) row.push_back(i == j ? 10 : i % 3 == j % 3 ? -3 : 0);
    query["hessian"].push_back(row);
  }
  const double w_sq = 1.25, elastic = 10 * 1.25 + 2 * (-3) * (-0.5), mass = 2 + 4 * 0.25;
  expect_close(ask(query)["kappa"], (mass / 0.01 + elastic) / w_sq);
  query["mass_term"] = "none";
  expect_close(ask(query)["kappa"], elastic / w_sq);
  query["mass_term"] = "inertia";
  query["dt"] = 0.2;
  query["c"] = 0.25;
  expect_close(ask(query)["kappa"], (mass / (0.25 * 0.04) + elastic) / w_sq);
  query["elastic_term"] = false;
  expect_close(ask(query)["kappa"], mass / (0.25 * 0.04) / w_sq);
  query["mass_term"] = "scaled";
  EXPECT_NE(refused(query).find("/d_hat"), std::string::npos);
  query["d_hat"] = 0.3;
  expect_close(ask(query)["kappa"], 9 * mass / (0.25 * 0.04) / w_sq);
  query["mass_term"] = "inertia";

  query["hessian"].erase(0);
  EXPECT_NE(refused(query).find("/hessian"), std::string::npos);
  EXPECT_NE(refused({{"kind", "stiffness"}, {"policy", "ipc_adaptive"}}).find("needs a scene"),
            std::string::npos);
  expect_close(ask({{"kind", "stiffness"}, {"policy", "fixed"}, {"kappa", 7}})["kappa"], 7);
}

TEST(EvalStrainLimit, ListsZerosLimitAndStress) {
  const double w = 0.02, y = w - (1.02 - 1 - 0.01);
  const json lists = ask({{"kind", "strain_limit"},
                          {"shape", "cubic"},
                          {"sigma", {1.0, 1.02, 1.03, 0.5}},
                          {"onset", 0.01},
                          {"width", w}});
  const double e = w - y;
  EXPECT_EQ(lists["E"][0], 0.0);
  expect_close(lists["E"][1], 2 / (3 * w) * e * e * e, 1e-9);
  expect_close(lists["dE"][1], 2 / w * e * e, 1e-9);
  expect_close(lists["d2E"][1], 4 / w * e, 1e-9);
  EXPECT_EQ(lists["E"][3], 0.0);
  EXPECT_FALSE(lists.contains("PK1"));

  const json f = ask({{"kind", "strain_limit"},
                      {"shape", "cubic"},
                      {"F", {{0, 1.02}, {1, 0}, {0, 0}}},
                      {"onset", 0.01},
                      {"width", w}});
  expect_close(f["dE"][0], lists["dE"][1], 1e-9);
  EXPECT_EQ(f["dE"][1], 0.0);
  expect_close(f["PK1"][0][1], lists["dE"][1], 1e-9);
  EXPECT_NEAR(f["PK1"][1][0].get<double>(), 0, 1e-15);

  json beyond = {
      {"kind", "strain_limit"}, {"shape", "log"}, {"sigma", {1.2, 1.005}}, {"onset", 0.01}, {"width", w}};
  const json answer = ask(beyond);
  EXPECT_TRUE(answer["E"][0].is_null() && answer["dE"][0].is_null() && answer["d2E"][0].is_null());
  EXPECT_EQ(answer["E"][1], 0.0);
  EXPECT_EQ(answer["status"], "beyond_limit");
  beyond["F"] = {{1, 0}, {0, 1}, {0, 0}};
  EXPECT_NE(refused(beyond).find("sigma and F"), std::string::npos);
}

TEST(EvalSvd, SignsAndOrder) {
  const json flat = ask({{"kind", "svd"}, {"F", {{2, 0}, {0, -3}}}});
  EXPECT_EQ(flat["sigma"], json({3.0, -2.0}));
  const json tall = ask({{"kind", "svd"}, {"F", {{0, 2}, {0, 0}, {-3, 0}}}});
  EXPECT_EQ(tall["sigma"], json({3.0, 2.0}));
  EXPECT_EQ(tall["U"].size(), 3u);
  EXPECT_EQ(tall["U"][0].size(), 2u);
  const json solid = ask({{"kind", "svd"}, {"F", {{1, 0, 0}, {0, 1, 0}, {0, 0, -4}}}});
  EXPECT_EQ(solid["sigma"], json({4.0, 1.0, -1.0}));
  EXPECT_NE(refused({{"kind", "svd"}, {"F", {{1, 2, 3}, {4, 5, 6}}}}).find("2x3"), std::string::npos);
  EXPECT_NE(refused({{"kind", "svd"}, {"F", {{1, 2}, {3}}}}).find("/F/1"), std::string::npos);
}

/// diag(1..6) with one pair of coupled rows and a duplicate entry.
json small_matrix(const char* scaling, int tier) {
  return {{"kind", "condition"},
          {"rows", {0, 1, 2, 3, 4, 5, 1, 5}},
          {"cols", {0, 1, 2, 3, 4, 5, 0, 5}},
          {"values", {2, 2, 3, 4, 5, 6, 1, 2}},
          {"scaling", scaling},
          {"tier", tier}};
}

TEST(EvalCondition, TiersScalingsAndErrors) {
  for (int tier : {1, 2, 3, 4}) {
    const json raw = ask(small_matrix("none", tier));
    expect_close(raw["lambda_min"], 1, tier == 1 ? 0.1 : 1e-3);
    expect_close(raw["lambda_max"], 8, tier == 1 ? 0.1 : 1e-3);
    EXPECT_TRUE(raw["method"].is_string());
    EXPECT_EQ(raw["status"], tier == 1 ? "lower_bound" : "ok");
  }
  const json jacobi = ask(small_matrix("jacobi", 3));
  expect_close(jacobi["lambda_min"], 0.5, 1e-9);
  expect_close(jacobi["lambda_max"], 1.5, 1e-9);
  expect_close(ask(small_matrix("block_jacobi", 3))["cond"], 1, 1e-9);
  const json ritz = ask(small_matrix("none", 0));
  EXPECT_EQ(ritz["status"], "lower_bound");
  EXPECT_LE(ritz["cond"].get<double>(), 8 * (1 + 1e-9));
  EXPECT_GT(ritz["cond"].get<double>(), 4);

  json upper = small_matrix("none", 3);
  upper["cols"][0] = 3;
  EXPECT_NE(refused(upper).find("/cols/0"), std::string::npos);
  json short_list = small_matrix("none", 3);
  short_list["values"].erase(0);
  EXPECT_NE(refused(short_list).find("/values"), std::string::npos);
  json fraction = small_matrix("none", 3);
  fraction["rows"][0] = 0.5;
  EXPECT_NE(refused(fraction).find("/rows/0"), std::string::npos);
  json huge = small_matrix("none", 2);
  huge["rows"][0] = 4000000000;
  EXPECT_NE(refused(huge).find("/rows/0"), std::string::npos);
  EXPECT_EQ(ask({{"kind", "condition"},
                 {"rows", {0, 1}},
                 {"cols", {0, 1}},
                 {"values", {1, -1}},
                 {"scaling", "none"},
                 {"tier", 2}})["status"],
            "not_pd");
  for (const int tier : {0, 1, 2, 3, 4}) {  // eigenvalues 3 and -1; the Ritz value of tier 0 is positive
    const json answer = ask({{"kind", "condition"},
                             {"rows", {0, 1, 1}},
                             {"cols", {0, 0, 1}},
                             {"values", {1, 2, 1}},
                             {"scaling", "none"},
                             {"tier", tier}});
    EXPECT_EQ(answer["status"], "not_pd") << tier;
    EXPECT_TRUE(answer["cond"].is_null()) << tier;
  }
}

}  // namespace
}  // namespace bb::test::eval_kinds_test
