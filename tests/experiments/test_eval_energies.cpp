// Known answers of the kind `energy` of `eval`, model by model: closed forms and hand-computed values.
#include <cmath>
#include <numbers>

#include "tests/experiments/eval_asking.hpp"

namespace bb::test::eval_energies_test {
namespace {

TEST(EvalEnergy, SpringMembraneAndHinge) {
  const json spring = ask({{"kind", "energy"},
                           {"model", "spring"},
                           {"rest", {{0, 0, 0}, {0, 0, 2}}},
                           {"x", {{0, 0, 0}, {1, 0, 0}}},
                           {"k", 8}});
  EXPECT_EQ(spring["energy"], 4.0);
  EXPECT_EQ(spring["gradient"], json({8.0, 0.0, 0.0, -8.0, 0.0, 0.0}));
  EXPECT_EQ(spring["hessian"][1][1], -8.0);  // transverse, in compression
  EXPECT_EQ(spring["hessian_psd"][1][1], 0.0);
  EXPECT_EQ(spring["hessian_psd"][0][3], -8.0);

  const json rest = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};  // area 1
  const json x = {{0, 0, 0}, {2.2, 0, 0}, {0, 1.3, 0}};
  const double mu = 3, lambda = 2, e0 = 0.1, e1 = 0.3, green0 = (1.21 - 1) / 2, green1 = (1.69 - 1) / 2;
  const auto energy = [&](const char* model) {
    return ask({{"kind", "energy"},
                {"model", model},
                {"rest", rest},
                {"x", x},
                {"lame_mu", mu},
                {"lame_lambda", lambda}})["energy"];
  };
  expect_close(energy("corotational"), mu * (e0 * e0 + e1 * e1) + lambda / 2 * (e0 + e1) * (e0 + e1));
  expect_close(energy("arap"), mu * (e0 * e0 + e1 * e1));
  expect_close(energy("stvk"),
               mu * (green0 * green0 + green1 * green1) + lambda / 2 * (green0 + green1) * (green0 + green1));
  const double j = 1.1 * 1.3;
  expect_close(energy("stable_neo_hookean"),
               mu / 2 * (1.21 + 1.69 - 2) - mu * (j - 1) + lambda / 2 * (j - 1) * (j - 1));
  expect_close(energy("baraff_witkin"), mu / 2 * (e0 * e0 + e1 * e1));

  const json hinge = ask({{"kind", "energy"},
                          {"model", "hinge"},
                          {"x", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}}},
                          {"k", 2},
                          {"rest_angle", 0}});
  expect_close(hinge["energy"], std::numbers::pi * std::numbers::pi / 4);
  EXPECT_EQ(hinge["hessian"].size(), 12u);
  EXPECT_NE(refused({{"kind", "energy"},
                     {"model", "arap"},
                     {"rest", {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}},
                     {"x", rest},
                     {"lame_mu", 1},
                     {"lame_lambda", 1}})
                .find("/rest"),
            std::string::npos);
}

/// 0.5 m at rest: 20 % longer, 20 % shorter; parts that grow e-fold every 0.25 of it.
TEST(EvalEnergy, SpringOfCloth) {
  const auto spring = [](double length) {
    return json{{"kind", "energy"},
                {"model", "cloth_spring"},
                {"rest", {{0, 0, 0}, {0, 0.5, 0}}},
                {"x", {{1, 0, 0}, {1, 0, length}}},
                {"tension", 3},
                {"tension_exponential", 2},
                {"compression", 5},
                {"exponent", 4}};
  };
  const json longer = ask(spring(0.6));
  const double grown = std::exp(0.8) - 1;  // a = 8/m
  expect_close(longer["energy"], 3 * 0.005 + 2 / 64.0 * (grown - 0.8));
  expect_close(longer["gradient"][5], 3 * 0.1 + 2 / 8.0 * grown);
  expect_close(ask(spring(0.4))["energy"], 5 * 0.005);
  EXPECT_EQ(longer["hessian"].size(), 6u);
  json bad = spring(0.6);
  bad["rest"] = {{1, 1, 1}, {1, 1, 1}};
  EXPECT_NE(refused(bad).find("/rest"), std::string::npos);
}

TEST(EvalEnergy, HingeThatGrowsStiffer) {
  const json hinge = ask({{"kind", "energy"},
                          {"model", "hinge"},
                          {"x", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}}},
                          {"k", 2},
                          {"rest_angle", 0},
                          {"exponential", 3},
                          {"exponent", 0.5}});
  const double y = std::numbers::pi / 4;
  expect_close(hinge["energy"], std::numbers::pi * std::numbers::pi / 4 + 3 / 0.25 * (std::exp(y) - 1 - y));
}

json rod_bend(const json& points, double rest_angle) {
  return {{"kind", "energy"}, {"model", "rod_bend"}, {"x", points}, {"k", 2}, {"rest_angle", rest_angle}};
}

TEST(EvalEnergy, BendingOfARod) {
  const double right_angle = std::numbers::pi / 2;
  const json bent = ask(rod_bend({{0, 0, 0}, {1, 0, 0}, {1, 2, 0}}, 0.5));
  const double deviation = right_angle - 0.5;
  expect_close(bent["energy"], deviation * deviation);
  // p0 turns its segment of 1 m, p2 its segment of 2 m: forces of k deviation over the length
  expect_close(bent["gradient"][1], 2 * deviation);
  expect_close(bent["gradient"][6], -2 * deviation / 2);
  EXPECT_EQ(bent["hessian"].size(), 9u);
  EXPECT_FALSE(bent.contains("status"));

  const json straight = {{0, 0, 0}, {1, 0, 0}, {3, 0, 0}};
  EXPECT_FALSE(ask(rod_bend(straight, 0)).contains("status"));
  const json cusp = ask(rod_bend(straight, 0.5));
  EXPECT_EQ(cusp["status"], "cusp");
  expect_close(cusp["energy"], 0.25);
  EXPECT_EQ(cusp["gradient"], json(std::vector<double>(9, 0.0)));
  for (const json& points :
       {json({{0, 0, 0}, {0, 0, 0}, {3, 0, 0}}), json({{0, 0, 0}, {3, 0, 0}, {3, 0, 0}})}) {
    const std::string said = refused(rod_bend(points, 0));
    EXPECT_NE(said.find("/x"), std::string::npos) << said;
    EXPECT_NE(said.find("coincide"), std::string::npos) << said;
  }
}

TEST(EvalEnergy, Solids) {
  const json rest = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 3}};  // volume 1
  const json x = {
      {0, 0, 0}, {2.2, 0, 0}, {0, 1.3, 0}, {0, 0, -1.2}};  // turned inside out: sigma 1.3, 1.1, -0.4
  const double mu = 3, lambda = 2, sum = 0.1 + 0.3 - 1.4, squares = 0.01 + 0.09 + 1.96, j = 1.1 * 1.3 * -0.4;
  const double g0 = (1.21 - 1) / 2, g1 = (1.69 - 1) / 2, g2 = (0.16 - 1) / 2, green = g0 + g1 + g2;
  json query = {{"kind", "energy"}, {"rest", rest}, {"x", x}, {"lame_mu", mu}, {"lame_lambda", lambda}};
  const auto energy = [&](const char* model) {
    query["model"] = model;
    const json answer = ask(query);
    EXPECT_EQ(answer["gradient"].size(), 12u);
    EXPECT_EQ(answer["hessian"].size(), 12u);
    EXPECT_EQ(answer["hessian_psd"][11].size(), 12u);
    return answer["energy"];
  };
  expect_close(energy("arap_solid"), mu * squares);
  expect_close(energy("corotational_solid"), mu * squares + lambda / 2 * sum * sum);
  expect_close(energy("stvk_solid"), mu * (g0 * g0 + g1 * g1 + g2 * g2) + lambda / 2 * green * green);
  expect_close(energy("stable_neo_hookean_solid"),
               mu / 2 * (1.21 + 1.69 + 0.16 - 3) - mu * (j - 1) + lambda / 2 * (j - 1) * (j - 1));
  query["rest"] = {{0, 0, 0}, {0, 1, 0}, {2, 0, 0}, {0, 0, 3}};
  EXPECT_NE(refused(query).find("a tetrahedron of -1 m^3"), std::string::npos) << refused(query);
  query["rest"] = {{0, 0, 0}, {0, 1, 0}, {2, 0, 0}, {1, 3, 0}};
  EXPECT_NE(refused(query).find("a tetrahedron of 0 m^3"), std::string::npos);
  query["rest"] = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  EXPECT_NE(refused(query).find("/rest"), std::string::npos);
}

}  // namespace
}  // namespace bb::test::eval_energies_test
