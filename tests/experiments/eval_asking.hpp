// How the tests call `eval`: lines in, parsed answers out.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "experiments/eval/eval.hpp"

namespace bb::test {

using nlohmann::json;

struct Reply {
  int code;
  std::string text, talk;
  std::vector<json> answers;
};

inline Reply ask_text(const std::string& lines) {
  std::istringstream in(lines);
  std::ostringstream out, err;
  Reply reply{run_eval(in, out, err), {}, {}, {}};
  reply.text = out.str();
  reply.talk = err.str();
  std::istringstream answers(reply.text);
  for (std::string line; std::getline(answers, line);) reply.answers.push_back(json::parse(line));
  return reply;
}

/// The answer to one query that has to be answerable.
inline json ask(const json& query) {
  const Reply reply = ask_text(query.dump() + "\n");
  EXPECT_EQ(reply.code, 0) << query << "\n" << reply.text;
  EXPECT_EQ(reply.answers.size(), 1u);
  return reply.answers.empty() ? json() : reply.answers[0];
}

/// The error text of one query that must not be answerable.
inline std::string refused(const json& query) {
  const Reply reply = ask_text(query.dump() + "\n");
  EXPECT_EQ(reply.code, 2) << query << "\n" << reply.text;
  if (reply.answers.size() != 1 || !reply.answers[0].contains("error")) return {};
  EXPECT_EQ(reply.answers[0].size(), 2u);
  return reply.answers[0]["error"];
}

inline void expect_close(const json& value, double expected, double relative = 1e-12) {
  ASSERT_TRUE(value.is_number()) << value;
  EXPECT_NEAR(value.get<double>(), expected, relative * std::max(std::abs(expected), 1e-300));
}

/// A complete, valid query of every kind, with the names of the fields that may be left out.
struct Example {
  json query;
  std::vector<std::string> optional;
};
inline std::vector<Example> examples() {
  const json square = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const json moved = {{0, 0, 0.1}, {1.2, 0, 0}, {0, 0.9, 0.05}};
  const json identity9 = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
  return {
      {{{"kind", "shape"}, {"shape", "log"}, {"argument", "gap"}, {"d", 0.25}, {"d_hat", 1}}, {"argument"}},
      {{{"kind", "rho"}, {"shape", "cubic"}, {"argument", "gap"}, {"derivative", "included"}, {"u", 0.5}},
       {"argument", "derivative"}},
      {{{"kind", "equilibrium"},
        {"shape", "cubic"},
        {"argument", "gap"},
        {"derivative", "included"},
        {"kappa", 10},
        {"d_hat", 0.1},
        {"load", 1}},
       {"argument", "derivative"}},
      {{{"kind", "match"},
        {"rule", "equal_force"},
        {"shape", "log"},
        {"argument", "gap"},
        {"d_hat", 0.1},
        {"load", 2},
        {"theta", 0.2}},
       {"argument", "theta"}},
      {{{"kind", "match"},
        {"rule", "equal_curvature"},
        {"shape", "log"},
        {"argument", "gap"},
        {"d_hat", 0.1},
        {"curvature", 2},
        {"theta", 0.2}},
       {"argument", "theta"}},
      {{{"kind", "distance"}, {"pair", "point_edge"}, {"points", {{0.5, 1, 0}, {0, 0, 0}, {1, 0, 0}}}}, {}},
      {{{"kind", "ccd"},
        {"pair", "point_point"},
        {"points_t0", {{0, 0, 0}, {1, 0, 0}}},
        {"points_t1", {{2, 0, 0}, {1, 0, 0}}},
        {"offset", 0.1},
        {"park", 1e-6}},
       {"offset", "park"}},
      {{{"kind", "intersects"}, {"segment", {{0.2, 0.2, -1}, {0.2, 0.2, 1}}}, {"triangle", square}}, {}},
      {{{"kind", "stiffness"}, {"policy", "fixed"}, {"kappa", 3}}, {}},
      {{{"kind", "stiffness"},
        {"policy", "elasticity_inclusive"},
        {"mass_term", "paper"},
        {"elastic_term", true},
        {"weights", {1}},
        {"normal", {0, 0, 1}},
        {"gap", 0.5},
        {"masses", {3}},
        {"hessian", identity9}},
       {"elastic_term"}},
      {{{"kind", "stiffness"},
        {"policy", "elasticity_inclusive"},
        {"mass_term", "inertia"},
        {"dt", 0.1},
        {"c", 1},
        {"weights", {1}},
        {"normal", {0, 0, 1}},
        {"gap", 0.5},
        {"masses", {3}},
        {"hessian", identity9}},
       {"gap"}},
      {{{"kind", "stiffness"},
        {"policy", "elasticity_inclusive"},
        {"mass_term", "scaled"},
        {"dt", 0.1},
        {"c", 1},
        {"weights", {1}},
        {"normal", {0, 0, 1}},
        {"gap", 0.5},
        {"d_hat", 1},
        {"masses", {3}},
        {"hessian", identity9}},
       {}},
      {{{"kind", "strain_limit"},
        {"shape", "cubic"},
        {"sigma", {1.015, 1.0}},
        {"onset", 0.01},
        {"width", 0.01}},
       {}},
      {{{"kind", "strain_limit"},
        {"shape", "log"},
        {"F", {{1.015, 0}, {0, 1}, {0, 0}}},
        {"onset", 0.01},
        {"width", 0.01}},
       {}},
      {{{"kind", "energy"},
        {"model", "corotational"},
        {"rest", square},
        {"x", moved},
        {"lame_mu", 3},
        {"lame_lambda", 2}},
       {}},
      {{{"kind", "energy"},
        {"model", "spring"},
        {"rest", {{0, 0, 0}, {1, 0, 0}}},
        {"x", {{0, 0, 0}, {1.5, 0, 0}}},
        {"k", 8}},
       {}},
      {{{"kind", "energy"},
        {"model", "hinge"},
        {"rest", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}}},
        {"x", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.2}, {0, -1, 0}}},
        {"k", 2},
        {"rest_angle", 0.1}},
       {"rest"}},
      {{{"kind", "friction"},
        {"law", "capped"},
        {"mu", 0.5},
        {"load", 2},
        {"eps", 0.1},
        {"pair", "point_point"},
        {"points_lagged", {{0, 0, 1}, {0, 0, 0}}},
        {"points_start", {{0, 0, 1}, {0, 0, 0}}},
        {"points_end", {{0.3, 0, 1}, {0, 0, 0}}}},
       {}},
      {{{"kind", "svd"}, {"F", {{3, 0}, {0, -2}}}}, {}},
      {{{"kind", "condition"},
        {"rows", {0, 1, 1}},
        {"cols", {0, 0, 1}},
        {"values", {2, 1, 2}},
        {"scaling", "none"},
        {"tier", 3}},
       {}},
  };
}

}  // namespace bb::test
