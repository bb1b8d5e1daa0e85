// Weight groups of a config: files with their hash, boxes, formulas, ramps; what a resolved config states of them, and what is refused with its place.
#include <fstream>

#include "tests/config/config_text.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::weight_settings_test {
namespace {

using namespace test;

json group(const char* name, const json& more) {
  json out = {{"name", name}};
  out.update(more);
  return out;
}

/// A square of four vertices, at (+-0.5, +-0.5), the first one held.
json square() {
  json config = bodies_config();
  config["scene"]["bodies"][0]["pins"][0] = {{"indices", {0}}};
  return config;
}
/// The same with these groups.
json weighted(const json& groups) {
  json config = square();
  config["scene"]["bodies"][0]["weights"] = groups.is_array() ? groups : json::array({groups});
  return config;
}

/// A file that stays as long as the test program.
std::string written(const std::string& name, const std::string& text) {
  static const TemporaryFolder folder;
  const std::string path = (folder.path() / name).string();
  std::ofstream(path) << text;
  return path;
}

/// Stiffness factors of a body whose membrane has the weights of the group, min 0 and max 1, one a triangle.
std::vector<double> factors(const json& groups, const char* of = "a") {
  json config = weighted(groups);
  json& body = config["scene"]["bodies"][0];
  body["material"] = {{"youngs_N_per_m", 2.0}, {"poisson", 0.0}};  // mu = 1
  body["stiffness_weights"] = {{{"of", "membrane"}, {"mix", {{{"group", of}}}}}};
  return build_scene(parsed(config)).membranes.at(0).lame_mu;
}

std::string refused(const json& config) {
  try {
    build_scene(parsed(config));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(WeightSettings, have_the_numbers_of_files_boxes_and_ramps) {
  const json whole = {{-9, -9, -9}, {9, 9, 9}}, right = {{0, -9, -9}, {9, 9, 9}};
  const json boxes = {{{"box_m", whole}, {"weight", 0.5}}, {{"box_m", right}, {"weight", 0.25}}};
  const RunConfig config = parsed(square());
  const Scene scene = build_scene(config);
  ASSERT_EQ(scene.n_vertices(), 4);
  const auto expected = [&](const std::function<double(const Vec3d&)>& weight) {
    std::vector<double> out;
    for (const auto& t : scene.membranes[0].triangles) {
      out.push_back(0);
      for (const int v : t) out.back() += weight(scene.x0.col(v)) / 3;
    }
    return out;
  };
  const auto expect = [](const std::vector<double>& found, const std::vector<double>& wanted) {
    ASSERT_EQ(found.size(), 2U);
    for (std::size_t t = 0; t < 2; ++t) EXPECT_NEAR(found[t], wanted[t], 1e-15);
    EXPECT_NE(found[0], found[1]);
  };
  expect(factors({group("a", {{"boxes", boxes}})}),
         expected([](const Vec3d& x) { return x[0] >= 0 ? 0.25 : 0.5; }));
  const json ramp = {{"axis", {0, -3, 0}}, {"from_m", -1}, {"to_m", 0.75}};
  expect(factors({group("b", {{"boxes", boxes}}), group("a", ramp)}),
         expected([](const Vec3d& x) { return std::clamp((1 - x[1]) / 1.75, 0.0, 1.0); }));
  const std::string file = written("weights.txt", "0.5\n1\r\n\n 0.25 \n1e-1\n");
  std::vector<double> numbers{0.5, 1, 0.25, 0.1}, of_file;
  for (const auto& t : scene.membranes[0].triangles) {
    of_file.push_back(0);
    for (const int v : t) of_file.back() += numbers[static_cast<std::size_t>(v)] / 3;
  }
  expect(factors({group("a", {{"file", file}})}), of_file);
}

TEST(WeightSettings, have_the_numbers_of_formulas) {
  json config = square();
  config["scene"]["bodies"][0]["mesh"].update({{"n_x", 9}, {"n_y", 9}});
  json& body = config["scene"]["bodies"][0];
  body["weights"] = {group("disc", {{"formula", "x^2 + y^2 < 0.02 ? 1 : 0"}}),
                     group("rise", {{"formula", "min(max((y + 0.25) / 0.5, 0), 1)"}}),
                     group("ramp", {{"axis", {0, 1, 0}}, {"from_m", -0.25}, {"to_m", 0.25}})};
  body["pins"] = {
      {{"mix", {{{"group", "disc"}}}}, {"threshold", 1}},
      {{"mix", {{{"group", "rise"}}}}, {"pull_N_per_m", 3}, {"box_m", {{0.3, -9, -9}, {9, 9, 9}}}},
      {{"mix", {{{"group", "ramp"}}}}, {"pull_N_per_m", 3}, {"box_m", {{0.3, -9, -9}, {9, 9, 9}}}}};
  const Scene scene = build_scene(parsed(config));
  ASSERT_EQ(scene.n_vertices(), 81);
  std::vector<int> held, disc;
  for (const Pin& pin : scene.pins) held.push_back(pin.vertex);
  for (int v = 0; v < 81; ++v) {
    if (scene.x0(0, v) * scene.x0(0, v) + scene.x0(1, v) * scene.x0(1, v) < 0.02) disc.push_back(v);
  }
  ASSERT_EQ(disc, (std::vector<int>{31, 39, 40, 41, 49})) << "vertices are 0.125 m apart";
  EXPECT_EQ(held, disc);
  ASSERT_EQ(scene.pulls.size(), 2U);
  const std::vector<double>&rise = scene.pulls[0].weights.layers.at(0).weight,
        &ramp = scene.pulls[1].weights.layers.at(0).weight;
  ASSERT_EQ(rise.size(), 18U);
  ASSERT_EQ(ramp.size(), 18U);
  for (std::size_t i = 0; i < ramp.size(); ++i) EXPECT_NEAR(rise[i], ramp[i], 1e-15);
  EXPECT_EQ(*std::max_element(rise.begin(), rise.end()), 1);
}

TEST(WeightSettings, of_a_formula_multiply_stiffnesses_and_stand_in_a_resolved_config) {
  const json formula = group("a", {{"formula", "x > 0 ? 0.25 : 0.5"}});
  const json boxes = group("a", {{"boxes",
                                  {{{"box_m", {{-9, -9, -9}, {9, 9, 9}}}, {"weight", 0.5}},
                                   {{"box_m", {{1e-9, -9, -9}, {9, 9, 9}}}, {"weight", 0.25}}}}});
  EXPECT_EQ(factors({formula}), factors({boxes}));
  EXPECT_NE(factors({formula})[0], factors({formula})[1]);
  const std::string text = resolved_json(parsed(weighted(formula)));
  EXPECT_EQ(resolved_json(parse_config(text, "a.json")), text);
  EXPECT_EQ(json::parse(text)["scene"]["bodies"][0]["weights"][0], formula);
}

TEST(WeightSettings, of_a_formula_are_refused_with_its_position_or_the_vertex) {
  const auto said = [](const char* formula) {
    return refused(weighted({group("a", {{"formula", formula}})}));
  };
  const std::string at = "a.json#/scene/bodies/0/weights/0/formula: found ";
  for (const auto& [formula, found, allowed] :
       {std::tuple{"x +", "\"x +\", position 4: Unexpected end", "a formula in x, y, z (m)"},
        {"min(x, ", "\"min(x, \", position 8: Unexpected end", "a formula in x, y, z (m)"},
        {"x + * y", "\"x + * y\", position 4, token \"*\": Unexpected", "a formula in x, y, z (m)"},
        {"x < r ? 1 : 0", "the name \"r\" at position 4 of \"x < r ? 1 : 0\"", "x, y, z (m), numbers, _pi"},
        {"x = 0 ? 1 : 0", "an assignment at position 2 of \"x = 0 ? 1 : 0\"", "== for a comparison"},
        {"0.5, 1", "2 values of \"0.5, 1\"", "one value"},
        {"x + 0.75", "1.25 at vertex 1, which starts at (0.5, -0.5, 0)",
         "a number in [0, 1] at every vertex"},
        {"x", "-0.5 at vertex 0, which starts at (-0.5, -0.5, 0)", "a number in [0, 1] at every vertex"},
        {"1 / (x - 0.5)", "-1 at vertex 0", "a number in [0, 1]"},
        {"x < 0 ? 0 : 1 / (x - 0.5)", "inf at vertex 1", "a number in [0, 1]"},
        {"sqrt(x)", "not a number at vertex 0", "a number in [0, 1]"}}) {
    const std::string text = said(formula);
    EXPECT_NE(text.find(at + found), std::string::npos) << formula << ": " << text;
    EXPECT_NE(text.find(std::string("; allowed: ") + allowed), std::string::npos) << formula << ": " << text;
  }
  EXPECT_EQ(said("x == -0.5 && y >= -1 ? 1 : exp(-_pi)"), "");
}

TEST(WeightSettings, stand_in_a_resolved_config_with_the_hash_of_their_file) {
  json config = weighted({group("a", {{"file", written("kept.txt", "0\n1\n0\n1\n")}}),
                          group("b", {{"from_m", 0}, {"to_m", 1}})});
  json& pin = config["scene"]["bodies"][0]["pins"][0];
  pin["pull_N_per_m"] = 3;
  pin["mix"] = {{{"group", "a"}, {"influence_schedule", {{{"time_s", 0}, {"influence", 0.5}}}}},
                {{"group", "b"}, {"influence", -0.25}}};
  const std::string text = resolved_json(parsed(config));
  EXPECT_EQ(resolved_json(parse_config(text, "a.json")), text);
  const json body = json::parse(text)["scene"]["bodies"][0];
  EXPECT_EQ(body["weights"][0]["sha256"].get<std::string>().size(), 64U);
  EXPECT_EQ(body["pins"][0]["mix"][1]["influence"], -0.25);
  EXPECT_FALSE(body["weights"][0].contains("axis"));
  EXPECT_EQ(body["weights"][1]["axis"], json({1, 0, 0}));
  const std::string plain = resolved_json(parsed(bodies_config()));
  for (const char* key : {"weights", "mix", "threshold", "plasticity"})
    EXPECT_EQ(plain.find(key), std::string::npos) << key;
  config["scene"]["bodies"][0]["weights"][0]["sha256"] = std::string(64, '0');
  EXPECT_NE(refused(config).find("/scene/bodies/0/weights/0/sha256"), std::string::npos);
}

TEST(WeightSettings, of_a_file_are_refused_with_its_line_and_what_is_allowed) {
  const auto said = [](const std::string& text) {
    json config = weighted({group("a", {{"file", written("wrong.txt", text)}})});
    return refused(config);
  };
  const char* const allowed = "allowed: one number from 0 to 1 in a line";
  for (const auto& [text, found] :
       {std::pair<std::string, std::string>{"0\n1\n1.5\n0\n", "wrong.txt:3: found 1.5; "},
        {"0\n-0.1\n1\n0\n", "wrong.txt:2: found -0.1; "},
        {"0\nnan\n1\n0\n", "wrong.txt:2: found nan; "},
        {"half\n1\n1\n0\n", "wrong.txt:1: found \"half\"; "},
        {"0 1\n1\n0\n", "wrong.txt:1: found 2 words; "}}) {
    EXPECT_NE(said(text).find(found + allowed), std::string::npos) << said(text);
  }
  EXPECT_NE(said("0\n1\n1\n").find("wrong.txt: found 3 numbers; allowed: 4, one a vertex"), std::string::npos)
      << said("0\n1\n1\n");
  EXPECT_EQ(said("0\n1\n1\n0"), "");
}

TEST(WeightSettings, have_one_source_each) {
  const auto at = [](const json& more, const std::string& place, const std::string& found,
                     const std::string& allowed) {
    expect_violation(weighted({group("a", more)}), "/scene/bodies/0/weights/0" + place, found, allowed);
  };
  const json boxes = {{{"box_m", {{0, 0, 0}, {1, 1, 1}}}}};
  at(json::object(), "", "no weights, or two ways to state them",
     "one of file, boxes, formula, from_m with to_m");
  at({{"boxes", boxes}, {"from_m", 0}, {"to_m", 1}}, "", "no weights, or two ways to state them", "one of");
  at({{"boxes", boxes}, {"formula", "1"}}, "", "no weights, or two ways to state them", "one of");
  at({{"from_m", 0}}, "/to_m", "nothing", "both from_m and to_m");
  at({{"to_m", 0}}, "/from_m", "nothing", "both from_m and to_m");
  at({{"from_m", 2}, {"to_m", 2}}, "/to_m", "2", "another number than from_m");
  at({{"boxes", boxes}, {"axis", {0, 1, 0}}}, "/axis", "[0,1,0]", "nothing without from_m and to_m");
  json rigid = square();
  rigid["scene"]["bodies"].push_back({{"name", "plate"},
                                      {"kind", "rigid"},
                                      {"mesh", {{"generator", "grid"}}},
                                      {"weights", json::array({group("a", {{"boxes", boxes}})})}});
  EXPECT_NE(refused(rigid).find("/scene/bodies/1/weights: found weights of a rigid body"), std::string::npos)
      << refused(rigid);
}

}  // namespace
}  // namespace bb::weight_settings_test
