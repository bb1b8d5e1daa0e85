// Every setting of every section, from the lists that the program reads configs by: given wrongly, twice,
// under a wrong name, or not at all.
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "barriers/stiffness/registry.hpp"
#include "core/base/input/json.hpp"
#include "core/base/parameters/check.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/model/integrators/registry.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/config/config_list.hpp"
#include "experiments/config/mesh_generators.hpp"
#include "tests/config/config_text.hpp"

namespace bb::test::settings_test {
namespace {

/// One row with its place, in a config in which that place exists.
struct Place {
  std::string pointer;
  Parameter row;
  json config;
};

/// One entry, with what it needs, in every list of a scene whose entries need something.
void add_lists(json& scene) {
  const json first = {{"time_s", 0}}, film = {{"generator", "twist"}};
  const json motion = {{"film", film}, {"keyframes", {first}}, {"then", {{{"keyframes", {first}}}}}};
  json& pin = scene["bodies"][0]["pins"][0];
  pin["pull_N_per_m"] = 1;
  pin["pull_factors"] = {{{"time_s", 0}, {"factor", 1}}};
  const json mix = {{{"group", "a"}, {"influence_schedule", {{{"time_s", 0}, {"influence", 1}}}}}};
  pin["mix"] = scene["bodies"][0]["pressure_mix"] = mix;
  scene["bodies"][0]["stiffness_weights"] = {{{"of", "membrane"}, {"mix", mix}}};
  scene["bodies"][0]["weights"] = {{{"name", "a"}, {"boxes", {{{"box_m", {{0, 0, 0}, {1, 1, 1}}}}}}}};
  pin["motion"] = scene["bodies"][1]["motion"] = scene["obstacles"][0]["motion"] = motion;
  scene["obstacles"][0]["motion"].erase("film");
  scene["gravity_schedule"] = {{{"time_s", 0}, {"gravity_m_per_s2", {0, 0, -9}}}};
  scene["air"]["wind_schedule"] = {{{"time_s", 0}, {"wind_m_per_s", {0, 0, 1}}}};
  scene["bodies"][0]["material"]["shrink_schedule"] = {{{"time_s", 0}, {"factor", 1}}};
  scene["bodies"][0]["pressure_schedule"] = {{{"time_s", 0}, {"pressure_Pa", 1}}};
  scene["collisions"] = {{{"a", "cloth"}, {"b", "plate"}, {"kind", "ccd"}}};
  scene["stitches"] = {
      {{"a", "cloth"}, {"a_vertices", {0}}, {"b", "cloth"}, {"b_vertices", {3}}, {"stiffness_N_per_m", 1}}};
}

/// Two bodies, one of each kind, and an obstacle, that have every setting; of the rest shape the one of that name.
json full_bodies(const char* rest, const char* generator) {
  json config = bodies_config();
  config["scene"]["bodies"].push_back(
      {{"name", "plate"}, {"kind", "rigid"}, {"mesh", {{"generator", "grid"}}}});
  config["scene"]["bodies"][0][rest] = {{"generator", generator}};
  config["scene"]["obstacles"] = {{{"name", "pole"}, {"kind", "cylinder"}, {"radius_m", 1}}};
  add_lists(config["scene"]);
  return config;
}

/// What a config with everything else cannot have: obstacles have no film, and a body one rest shape.
bool is_excluded(const std::string& pointer, const json& config) {
  const json::json_pointer body("/scene/bodies/0");
  const auto given = [&](const char* rest) { return config.contains(body / rest); };
  return pointer == "/scene/obstacles/0/motion/film" ||
         (pointer == "/scene/bodies/0/rest_film" && given("rest_mesh")) ||
         (pointer == "/scene/bodies/0/rest_mesh" && given("rest_film"));
}

void walk(const ParameterList& list, const std::string& pointer, const json& config,
          std::vector<Place>& out) {
  for (const Parameter& row : list.rows) {
    std::string at = pointer + "/" + row.name;
    if (at == "/scene/bodies/0/motion") at = "/scene/bodies/1/motion";  // only a rigid body has one
    if (is_excluded(at, config)) continue;
    out.push_back({at, row, config});
    if (!row.rule.list || row.rule.kind == Kind::word) continue;
    const json::json_pointer place(at);
    const json here = config.contains(place) && config[place].is_object() ? config[place] : json::object();
    walk(row.rule.list(here), at + (row.rule.kind == Kind::objects ? "/0" : ""), config, out);
  }
}

/// Every row of a config with a registered scene, and of one with bodies.
std::vector<Place> all_places() {
  std::vector<Place> out;
  walk(config_list(), "", hang_config(), out);
  for (const json& bodies : {full_bodies("rest_mesh", "grid"), full_bodies("rest_film", "grow")}) {
    for (const Parameter& row : config_list().rows) {
      if (row.name == "scene") walk(row.rule.list(bodies["scene"]), "/scene", bodies, out);
    }
  }
  return out;
}

/// Exactly one violation, at this place.
void expect_refused(const json& config, const std::string& pointer, const std::string& found,
                    const std::string& allowed) {
  const std::vector<Violation> violations = violations_of(config.dump());
  ASSERT_EQ(violations.size(), 1u) << pointer << "\n" << ConfigError(violations).what();
  EXPECT_EQ(violations[0].where, "a.json#" + pointer);
  EXPECT_EQ(violations[0].found, found) << pointer;
  EXPECT_EQ(violations[0].allowed, allowed) << pointer;
}

bool is_range(const Rule& rule) { return rule.kind == Kind::integer || rule.kind == Kind::number; }

/// The nearest values outside the bounds.
std::vector<json> outside(const Rule& rule) {
  std::vector<json> out;
  const bool whole = rule.kind == Kind::integer;
  const auto add = [&](double value) {
    out.push_back(whole ? json(static_cast<std::int64_t>(value)) : json(value));
  };
  if (std::isfinite(rule.low))
    add(rule.low_open ? rule.low : whole ? rule.low - 1 : std::nextafter(rule.low, -1e300));
  // 2^53 + 1 is refused by the JSON reader itself
  if (std::isfinite(rule.high) && rule.high < max_json_integer)
    add(rule.high_open ? rule.high : whole ? rule.high + 1 : std::nextafter(rule.high, 1e300));
  return out;
}

TEST(Settings, AreAllThere) {
  std::set<std::string> pointers;
  for (const Place& place : all_places()) pointers.insert(place.pointer);
  for (const char* known :
       {"/time/dt_s", "/formulation/stiffness_policy/kappa_N_per_m", "/step_solver/cap_fraction",
        "/linear_solver/tol_rel", "/scene/n", "/scene/bodies/0/pins/0/motion/axis",
        "/scene/bodies/0/mesh/n_x", "/scene/obstacles/0/radius_m", "/threads"}) {
    EXPECT_TRUE(pointers.contains(known)) << known;
  }
  EXPECT_GT(pointers.size(), 130u);
}

TEST(Settings, AWrongTypeIsNamed) {
  for (const Place& place : all_places()) {
    const Rule& rule = place.row.rule;
    const bool object = rule.kind == Kind::object || (rule.kind == Kind::word && rule.list);  // or a word
    const json wrong = object ? json(3) : json{{"a", 1}};
    expect_refused(with(place.config, place.pointer, wrong), place.pointer, wrong.dump(),
                   allowed_text(place.row.rule));
  }
}

TEST(Settings, AValueOutsideItsRangeIsNamed) {
  int n = 0;
  for (const Place& place : all_places()) {
    if (!is_range(place.row.rule)) continue;
    for (const json& wrong : outside(place.row.rule)) {
      expect_refused(with(place.config, place.pointer, wrong), place.pointer, wrong.dump(),
                     allowed_text(place.row.rule));
      ++n;
    }
  }
  EXPECT_GT(n, 60);
}

TEST(Settings, AMisspeltWordSuggestsTheNearest) {
  int n = 0;
  for (const Place& place : all_places()) {
    if (place.row.rule.kind != Kind::word || place.row.rule.words().size() < 2) continue;
    // the last word that is a name; one with a number in it, as exponential:A, is refused by what it allows
    std::vector<std::string> names = place.row.rule.words();
    std::erase_if(names, [](const std::string& word) { return word.find(':') != std::string::npos; });
    const std::string right = names.back(), wrong = right + "_";
    const std::string all = allowed_text(place.row.rule);
    expect_refused(with(place.config, place.pointer, wrong), place.pointer, '"' + wrong + '"',
                   all + " (did you mean " + right + "?)");
    ++n;
  }
  EXPECT_GT(n, 15);
}

TEST(Settings, AMisspeltNameSuggestsTheNearest) {
  for (const Place& place : all_places()) {
    const std::string key = place.row.name + "_", pointer = place.pointer + "_";
    const std::vector<Violation> violations = violations_of(with(place.config, pointer, 1).dump());
    ASSERT_EQ(violations.size(), 1u) << ConfigError(violations).what();
    EXPECT_EQ(violations[0].where, "a.json#" + pointer);
    EXPECT_EQ(violations[0].found, "the unknown key \"" + key + '"');
    EXPECT_TRUE(violations[0].allowed.ends_with("(did you mean " + place.row.name + "?)"))
        << violations[0].allowed;
  }
}

TEST(Settings, ASettingTwiceIsNamed) {
  for (const Place& place : all_places()) {
    // {"time": {"dt_s": 0, "dt_s": 0}}: arrays do not matter to the reader
    std::string text, end;
    std::istringstream parts(place.pointer.substr(1));
    std::string part;
    for (std::string next; std::getline(parts, part, '/'); text = next, end += "}") {
      next = text + "{\"" + part + "\":";
      if (parts.peek() == std::istringstream::traits_type::eof()) next += "0,\"" + part + "\":0";
    }
    const std::vector<Violation> violations = violations_of(text + end);
    ASSERT_EQ(violations.size(), 1u);
    EXPECT_EQ(violations[0].where, "a.json:1") << text;
    EXPECT_EQ(violations[0].found, "the key \"" + place.row.name + "\" twice in one object");
    EXPECT_EQ(violations[0].allowed, "each key once");
  }
}

TEST(Settings, ARequiredOneThatIsMissingIsNamed) {
  int n = 0;
  for (const Place& place : all_places()) {
    if (!place.row.rule.required) continue;
    json config = place.config;
    const json::json_pointer at(place.pointer);
    if (!config.contains(at)) continue;
    config[at.parent_pointer()].erase(place.row.name);
    expect_refused(config, place.pointer, "nothing", allowed_text(place.row.rule));
    ++n;
  }
  EXPECT_GE(n, 7);
}

/// Not those of policies: one that the policy does not read is refused.
TEST(Settings, ADefaultThatIsGivenChangesNothing) {
  int n = 0;
  for (const Place& place : all_places()) {
    const json fallback = to_json(place.row.fallback);
    const bool policy = place.pointer.find("stiffness_policy") != std::string::npos;
    const json::json_pointer at(place.pointer);
    if (fallback.is_null() || policy || !place.row.rule.computed.empty() || place.config.contains(at))
      continue;
    EXPECT_EQ(resolved_json(parsed(with(place.config, place.pointer, fallback))),
              resolved_json(parsed(place.config)))
        << place.pointer;
    ++n;
  }
  EXPECT_GT(n, 60);
}

/// A parameter that several entries of a registry read has one rule and one default.
template <class Registry>
int expect_one_rule(const Registry& registry) {
  std::map<std::string, const Parameter*> known;
  for (const auto& entry : registry) {
    EXPECT_FALSE(std::string(entry.doc).empty()) << entry.name;
    for (const Parameter& row : entry.parameters) {
      const auto [at, fresh] = known.emplace(row.name, &row);
      EXPECT_FALSE(row.doc.empty()) << row.name;
      EXPECT_EQ(allowed_text(at->second->rule), allowed_text(row.rule)) << row.name;
      EXPECT_EQ(at->second->fallback, row.fallback) << row.name;
    }
  }
  return static_cast<int>(known.size());
}

TEST(Settings, EntriesShareARowOnlyWithOneRule) {
  EXPECT_GE(expect_one_rule(stiffness_policies()), 10);
  EXPECT_GE(expect_one_rule(step_solvers()), 4);
  EXPECT_GE(expect_one_rule(linear_solvers()), 3);
  EXPECT_GE(expect_one_rule(limit_policies()), 3);
  expect_one_rule(preconditioners());
  expect_one_rule(integrators());
}

/// What is reported of step solvers that end in a minimum is of all of these, and of no other.
TEST(Settings, HelpNamesTheStepSolversThatEndInAMinimum) {
  const auto schema = schema_document("config");
  const auto& sections = schema["properties"];
  const auto says = [&](const char* section, const char* key) {
    return sections[section]["properties"][key]["description"].get<std::string>();
  };
  for (const std::string& text : {says("step_solver", "saddle"), says("friction", "lag_iterations"),
                                  says("contact", "hessian_mode"), says("hessian", "membrane")}) {
    for (const StepSolverEntry& entry : step_solvers()) {
      EXPECT_EQ(text.find(entry.name) != std::string::npos, entry.needs.minimum)
          << entry.name << ": " << text;
    }
  }
}

TEST(Settings, TheSchemaOfTheTreeIsTheOneOfTheLists) {
  for (const char* format : {"config", "sweep"}) {
    std::ifstream file(configs_folder() + "/schema/" + format + ".schema.json");
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    EXPECT_EQ(text, schema_document(format).dump(1) + "\n")
        << "./bench help " << format << " --schema > configs/schema/" << format << ".schema.json";
  }
}

}  // namespace
}  // namespace bb::test::settings_test
