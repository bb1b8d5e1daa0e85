// Known answers of every kind of `eval` but energies (test_eval_energies.cpp): closed forms and hand-computed values.
#include <cmath>
#include <numbers>

#include "tests/experiments/eval_asking.hpp"

namespace bb::test::eval_kinds_test {
namespace {

TEST(EvalShape, ClosedFormsLimitsAndZeros) {
  const double d = 0.3, h = 0.8, l = std::log(d / h);
  const json log = ask({{"kind", "shape"}, {"shape", "log"}, {"d", d}, {"d_hat", h}});
  expect_close(log["b"], -(d - h) * (d - h) * l);
  expect_close(log["db"], -(2 * (d - h) * l + (d - h) * (d - h) / d));
  expect_close(log["d2b"], -(2 * l + 4 * (d - h) / d - (d - h) * (d - h) / (d * d)));
  EXPECT_FALSE(log.contains("status"));

  const json squared =
      ask({{"kind", "shape"}, {"shape", "cubic"}, {"argument", "squared_gap"}, {"d", d}, {"d_hat", h}});
  const double e = h * h - d * d;
  expect_close(squared["b"], 2 / (3 * h * h) * e * e * e / (h * h));
  expect_close(squared["db"], -2 / (h * h) * e * e * 2 * d / (h * h));

  for (const char* shape : {"log", "log_squared", "quadratic", "cubic", "two_stage", "exponential"}) {
    for (const char* argument : {"gap", "squared_gap"}) {
      for (double at : {0.8, 0.9, 1e6}) {
        const json zero =
            ask({{"kind", "shape"}, {"shape", shape}, {"argument", argument}, {"d", at}, {"d_hat", h}});
        EXPECT_EQ(zero, json({{"b", 0.0}, {"db", 0.0}, {"d2b", 0.0}})) << shape << argument << at;
      }
      const json touching =
          ask({{"kind", "shape"}, {"shape", shape}, {"argument", argument}, {"d", 0}, {"d_hat", h}});
      const bool bounded = std::string(shape) != "two_stage" && !std::string(shape).starts_with("log");
      EXPECT_EQ(touching["b"].is_null(), !bounded);
      EXPECT_EQ(touching["db"].is_null(), !bounded);
      EXPECT_EQ(touching["d2b"].is_null(), !bounded);
      EXPECT_EQ(touching.value("status", ""), bounded ? "" : "infinite");
    }
  }
  EXPECT_NE(refused({{"kind", "shape"}, {"shape", "log"}, {"d", -1e-300}, {"d_hat", h}}).find("/d"),
            std::string::npos);
}

TEST(EvalRho, ClosedForms) {
  for (double u : {0.01, 0.376, 0.9}) {
    expect_close(ask({{"kind", "rho"}, {"shape", "quadratic"}, {"u", u}})["rho"], 1 / (1 - u));
    expect_close(ask({{"kind", "rho"}, {"shape", "cubic"}, {"u", u}})["rho"], 2 / (1 - u));
  }
  EXPECT_NEAR(ask({{"kind", "rho"}, {"shape", "log"}, {"u", 0.376}})["rho"].get<double>(), 5.03, 0.01);
  refused({{"kind", "rho"}, {"shape", "log"}, {"u", 1}});
}

/// Claim N1: with its derivative included the published dynamic stiffness is above log's at every gap.
TEST(EvalRho, OfAStiffnessWhoseDerivativeIsIncluded) {
  for (double u : {0.01, 0.1, 0.376, 0.9}) {
    const auto rho = [u](const char* shape, const char* derivative) {
      return ask({{"kind", "rho"}, {"shape", shape}, {"derivative", derivative}, {"u", u}})["rho"];
    };
    expect_close(rho("cubic", "included"), 2 / (1 - u) + 2 / u);
    expect_close(rho("quadratic", "included"), 1 / (1 - u) + 2 / u);
    expect_close(rho("cubic", "dropped"), 2 / (1 - u));
    EXPECT_GT(rho("cubic", "included").get<double>(), rho("log", "dropped").get<double>());
  }
  const json query = {{"kind", "rho"}, {"shape", "cubic"}, {"derivative", "included"}, {"u", 0.1}};
  EXPECT_NEAR(ask(query)["rho"].get<double>(), 22.2, 0.05);
  json refusable = query;
  refusable["shape"] = "log";
  EXPECT_NE(refused(refusable).find("quadratic, cubic"), std::string::npos);
  refusable["shape"] = "cubic";
  refusable["argument"] = "squared_gap";
  EXPECT_NE(refused(refusable).find("/derivative"), std::string::npos);
  refusable["derivative"] = "exact";
  EXPECT_NE(refused(refusable).find("dropped"), std::string::npos);
}

/// kappa (d_hat/d)^2 2 (d_hat - d)^2/d_hat = f: (d_hat/d - 1)^2 = f/(2 kappa d_hat).
TEST(EvalEquilibrium, OfAStiffnessWhoseDerivativeIsIncluded) {
  const double kappa = 50, h = 0.02;
  for (const double f : {1e-6, 0.3, 4.0, 300.0}) {
    const json rest = ask({{"kind", "equilibrium"},
                           {"shape", "cubic"},
                           {"derivative", "included"},
                           {"kappa", kappa},
                           {"d_hat", h},
                           {"load", f}});
    const double u = 1 / (1 + std::sqrt(f / (2 * kappa * h)));
    expect_close(rest["d"], u * h);
    expect_close(rest["K"], f / h * (2 / (1 - u) + 2 / u), 1e-11);
    EXPECT_TRUE(rest["capacity"].is_null());
    EXPECT_FALSE(rest.contains("status"));
  }
}

TEST(EvalEquilibrium, RestGapStiffnessAndCapacity) {
  const double kappa = 50, h = 0.02, f = 0.3;
  json query = {{"kind", "equilibrium"}, {"shape", "cubic"}, {"kappa", kappa}, {"d_hat", h}, {"load", f}};
  const json cubic = ask(query);
  expect_close(cubic["d"], h * (1 - std::sqrt(f / (2 * kappa * h))), 1e-9);
  expect_close(cubic["K"], std::sqrt(8 * kappa * f / h), 1e-9);
  expect_close(cubic["capacity"], 2 * kappa * h, 1e-9);
  EXPECT_FALSE(cubic.contains("status"));

  query["load"] = 2 * kappa * h * (1 + 1e-12);
  const json over = ask(query);
  EXPECT_TRUE(over["d"].is_null());
  EXPECT_TRUE(over["K"].is_null());
  expect_close(over["capacity"], 2 * kappa * h, 1e-9);
  EXPECT_EQ(over["status"], "above_capacity");

  query["shape"] = "log";
  const json log = ask(query);
  const double u = log["d"].get<double>() / h, e = 1 - u;
  expect_close(kappa * h * e * (e / u - 2 * std::log(u)), query["load"], 1e-9);
  EXPECT_TRUE(log["capacity"].is_null());
}

TEST(EvalMatch, BothRulesAndTheirThetas) {
  const double h = 0.02;
  json force = {{"kind", "match"}, {"rule", "equal_force"}, {"shape", "cubic"}, {"d_hat", h}, {"load", 3}};
  expect_close(ask(force)["kappa"], 3 / (2 * h * 0.9 * 0.9));
  force["theta"] = 0.5;
  expect_close(ask(force)["kappa"], 3 / (2 * h * 0.25));
  json curvature = {
      {"kind", "match"}, {"rule", "equal_curvature"}, {"shape", "cubic"}, {"d_hat", h}, {"curvature", 3}};
  expect_close(ask(curvature)["kappa"], 3 / (4 * 0.5));
  curvature["load"] = 1;
  EXPECT_NE(refused(curvature).find("/load"), std::string::npos);
  EXPECT_NE(refused({{"kind", "match"}, {"rule", "pareto"}}).find("equal_force"), std::string::npos);
}

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
}  // namespace bb::test::eval_kinds_test
