// Known answers of `eval` about barriers: shape, rho, equilibrium, match.
#include <cmath>

#include "tests/experiments/eval_asking.hpp"

namespace bb::test::eval_barriers_test {
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

  for (const char* shape : {"log", "log_squared", "quadratic", "cubic", "two_stage", "exponential",
                            "minimax_bounded", "minimax"}) {
    for (const char* argument : {"gap", "squared_gap"}) {
      for (double at : {0.8, 0.9, 1e6}) {
        const json zero =
            ask({{"kind", "shape"}, {"shape", shape}, {"argument", argument}, {"d", at}, {"d_hat", h}});
        EXPECT_EQ(zero, json({{"b", 0.0}, {"db", 0.0}, {"d2b", 0.0}})) << shape << argument << at;
      }
      const json touching =
          ask({{"kind", "shape"}, {"shape", shape}, {"argument", argument}, {"d", 0}, {"d_hat", h}});
      const std::string name = shape;
      const bool bounded = name != "two_stage" && name != "minimax" && !name.starts_with("log");
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

}  // namespace
}  // namespace bb::test::eval_barriers_test
