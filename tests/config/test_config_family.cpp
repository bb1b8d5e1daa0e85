// Configs of one file under many overrides, read one after the other, are those that are read by themselves.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "core/base/input/json.hpp"
#include "core/base/input/read_file.hpp"
#include "core/base/record/provenance.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "experiments/config/config_family.hpp"
#include "tests/config/config_text.hpp"
#include "tests/folders.hpp"

namespace bb::test::config_family_test {
namespace {

namespace fs = std::filesystem;
using Overrides = std::vector<std::string>;

std::vector<std::string> texts_of(const std::vector<Violation>& violations) {
  std::vector<std::string> out;
  for (const Violation& v : violations) out.push_back(v.where + ": " + v.found + "; " + v.allowed);
  return out;
}

/// What became of a config: what is wrong with it, or its id and its text.
struct Found {
  std::vector<std::string> violations;
  std::string config_id, text, identity;
  bool undecided = false;
};

Found read_alone(const std::string& path, const Overrides& overrides) {
  Found out;
  try {
    const RunConfig config = load_config(path, overrides);
    out.config_id = config_id(config);
    out.text = resolved_json(config);
    out.undecided = config.linear_solver.name == linear_solver_auto;
  } catch (const ConfigError& error) {
    out.violations = texts_of(error.violations());
  }
  return out;
}

Found read_in_family(ConfigFamily& family, const Overrides& overrides) {
  Found out;
  try {
    const RunConfig& config = family.read(overrides);
    out.text = resolved_json(config);
    out.undecided = config.linear_solver.name == linear_solver_auto;
    if (out.undecided) {
      out.config_id = config_id(config);
      return out;
    }
    const ConfigFamily::Identity identity = family.identity();
    out.config_id = identity.config_id;
    out.identity = identity.document;
    EXPECT_EQ(identity.scene, sha256_hex(json::parse(out.text)["scene"].dump()));
  } catch (const ConfigError& error) {
    out.violations = texts_of(error.violations());
  }
  return out;
}

/// Reads all of them both ways. How many were configs.
struct Count {
  int read = 0, refused = 0;
};
Count expect_alike(const std::string& path, const std::vector<Overrides>& cases) {
  Count count;
  ConfigFamily family(path);
  std::map<std::string, std::string> text_of;  // identity -> text
  std::set<std::string> texts;
  for (const Overrides& overrides : cases) {
    std::string all;
    for (const std::string& text : overrides) all += " " + text;
    SCOPED_TRACE(path + all);
    const Found alone = read_alone(path, overrides), family_found = read_in_family(family, overrides);
    EXPECT_EQ(family_found.violations, alone.violations);
    EXPECT_EQ(family_found.text, alone.text);
    EXPECT_EQ(family_found.config_id, alone.config_id);
    (alone.violations.empty() ? count.read : count.refused) += 1;
    if (::testing::Test::HasFailure()) return count;
    if (!alone.violations.empty() || alone.undecided) continue;
    EXPECT_EQ(text_of.emplace(family_found.identity, alone.text).first->second, alone.text);
    texts.insert(alone.text);
  }
  EXPECT_EQ(text_of.size(), texts.size());
  return count;
}

Overrides set_of(const json& set) {
  Overrides out;
  for (const auto& [pointer, value] : set.items()) out.push_back(pointer + "=" + value.dump());
  return out;
}

/// What each entry of an axis sets; of a range its ends.
std::vector<Overrides> entries_of(const json& axis) {
  std::vector<Overrides> out;
  if (axis.contains("cases")) {
    for (const json& one : axis["cases"]) out.push_back(set_of(one["set"]));
  } else if (axis.contains("zip")) {
    for (const json& part : axis["zip"]) {
      const auto entries = entries_of(part);
      out.resize(std::max(out.size(), entries.size()));
      for (std::size_t k = 0; k < entries.size(); ++k)
        out[k].insert(out[k].end(), entries[k].begin(), entries[k].end());
    }
  } else {
    const json values =
        axis.contains("range") ? json{axis["range"]["from"], axis["range"]["to"]} : axis["values"];
    for (const json& value : values) out.push_back({axis["pointer"].get<std::string>() + "=" + value.dump()});
  }
  return out;
}

constexpr std::size_t most_of_a_sweep = 60;

/// The first cases of the product, in its order, then some anywhere.
std::vector<Overrides> some_cases(const json& sweep, std::mt19937& random) {
  std::vector<std::vector<Overrides>> axes;
  double n = 1;
  for (const json& axis : sweep["axes"]) {
    axes.push_back(entries_of(axis));
    n *= static_cast<double>(axes.back().size());
  }
  std::vector<Overrides> out;
  const auto all = static_cast<std::size_t>(std::min(n, 1e9));
  for (std::size_t k = 0; k < std::min(all, most_of_a_sweep); ++k) {
    std::size_t index = k < most_of_a_sweep / 2 || all <= most_of_a_sweep ? k : random() % all;
    Overrides one = set_of(sweep.value("set", json::object()));
    std::vector<Overrides> parts(axes.size());
    for (std::size_t a = axes.size(); a-- > 0; index /= axes[a].size())
      parts[a] = axes[a][index % axes[a].size()];
    for (const Overrides& part : parts) one.insert(one.end(), part.begin(), part.end());
    out.push_back(std::move(one));
  }
  return out;
}

TEST(ConfigFamily, ReadsCasesOfEveryCommittedSweepAsTheyAreReadAlone) {
  std::mt19937 random(1);
  int sweeps = 0, cases = 0;
  for (const char* folder : {"/configs/sweeps", "/claims/sweeps", "/claims/confirmation"}) {
    for (const auto& file : fs::directory_iterator(std::string(BB_SOURCE_DIR) + folder)) {
      const json sweep = read_json_file(file.path().string(), sweep_file);
      if (sweep.value("schema", "") != "barrierbench.sweep/1") continue;
      const std::string base = (file.path().parent_path() / sweep["base"].get<std::string>()).string();
      cases += expect_alike(base, some_cases(sweep, random)).read;
      ++sweeps;
      if (HasFailure()) return;
    }
  }
  EXPECT_GE(sweeps, 30);
  EXPECT_GE(cases, 500);
}

/// Settings of all sections, some of them wrong, some of them at odds with others.
const std::vector<Overrides>& settings() {
  static const std::vector<Overrides> all = {
      {"", "/formulation=cubic", "/formulation=log", "/formulation/name=cubic", "/formulation=nowhere",
       R"(/formulation={"name": "mine", "shape": "quadratic", "argument": "gap", "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 3}})",
       "/formulation/shape=formula:-(d - d_hat)^2*log(d/d_hat)", "/formulation/shape=formula:d^"},
      {"", "/formulation/d_hat_m=0.002", "/formulation/d_hat_m=0.02", "/formulation/d_hat_m=-1"},
      {"", "/formulation/stiffness_policy/kappa_N_per_m=10", "/formulation/stiffness_policy/kappa_N_per_m=20",
       "/formulation/stiffness_policy/name=ipc_adaptive", "/formulation/stiffness_policy/nothing=1"},
      {"", "/time/dt_s=0.001", "/time/dt_s=0.02", "/time/duration_s=0.1", "/time/dt_s=0"},
      {"", "/time/steps=3", "/time/steps=7"},
      {"", "/step_solver/name=accumulated_toi", "/step_solver/name=penalty",
       "/step_solver/tol_velocity_m_per_s=1e-6", "/step_solver/saddle=report"},
      {"", "/integrator/name=bdf2", "/integrator/name=quasi_static"},
      {"", "/strain_limit/limit=0.1", "/strain_limit/enabled=false", "/strain_limit/shape=cubic"},
      {"", "/matching/rule=equal_curvature", "/matching/theta=0.5", "/matching/rule=as_given"},
      {"", "/linear_solver/name=pcg", "/linear_solver/name=auto"},
      {"", "/device=host", "/precision=float", "/precision=mixed", "/threads=3", "/threads=0"},
      {"", "/seeds/jitter_m=-0.0", "/seeds/jitter_m=0.0", "/seeds/jitter_m=1e-6", "/seeds/main=5"},
      {"", "/contact/step_bound=per_vertex", "/contact/min_gap_fraction=1e-5", "/contact/weighting=area"},
      {"", "/method=nowhere", "/nowhere=1", "/extends=a", "time=1", "/name=a", "/doc=b"},
      {"", "/scene/translate_m=[0,0,-0.0]", "/scene/translate_m=[0,0,1]"}};
  return all;
}

std::string path_of_scene(const std::string& name) {
  return fmt::format("{}/configs/scenes/{}.json", BB_SOURCE_DIR, name);
}

/// Cases in the order of a product whose last axes run fastest; each axis is left out half of the time.
std::vector<Overrides> random_product(std::mt19937& random, const Overrides& more) {
  std::vector<Overrides> axes = settings();
  axes.push_back(more);
  std::shuffle(axes.begin(), axes.end(), random);
  axes.resize(5);
  std::vector<Overrides> out(1);
  for (const Overrides& axis : axes) {
    std::vector<Overrides> longer;
    for (const Overrides& one : out) {
      for (std::size_t k = 0; k < std::min<std::size_t>(axis.size(), 3); ++k) {
        Overrides next = one;
        const std::string& text = axis[random() % axis.size()];
        if (!text.empty()) next.push_back(text);
        longer.push_back(std::move(next));
      }
    }
    out = std::move(longer);
  }
  return out;
}

TEST(ConfigFamily, ReadsRandomProductsAsTheyAreReadAlone) {
  std::mt19937 random(7);
  Count count;
  Overrides methods = {""};
  for (const auto& file : fs::directory_iterator(std::string(BB_SOURCE_DIR) + "/configs/methods"))
    methods.push_back("/method=" + file.path().stem().string());
  std::sort(methods.begin(), methods.end());
  const std::map<std::string, Overrides> scenes = {
      {"drape", {"", "/scene/n=4", "/scene/n=6", "/scene/name=hang"}},
      {"hang", methods},
      {"drape2d", {"", "/scene/protocol=article_literal", "/scene/youngs_N_per_m=50"}},
      {"solid_stack", {"", "/scene/gravity_m_per_s2=[0,0,-1]", "/scene/bodies/0/mesh/generator=nowhere"}},
      {"balloon", {"", "/scene/bodies/0/pressure_Pa=3"}}};
  for (const auto& [scene, own] : scenes) {
    for (int product = 0; product < 2; ++product) {
      const Count found = expect_alike(path_of_scene(scene), random_product(random, own));
      if (HasFailure()) return;
      count.read += found.read;
      count.refused += found.refused;
    }
  }
  EXPECT_GE(count.read, 200);
  EXPECT_GE(count.refused, 100);
}

/// The same mesh in two files is the same config in two documents.
TEST(ConfigFamily, AMeshElsewhereHasTheSameIdAndIsAnotherDocument) {
  const fs::path folder = fs::path(BB_BINARY_DIR) / "tests" / "config_family";
  fs::create_directories(folder);
  for (const char* name : {"a.obj", "b.obj"})
    std::ofstream(folder / name) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  json config = bodies_config();
  config["scene"]["bodies"][0]["mesh"] = {{"file", "a.obj"}};
  config["scene"]["bodies"][0].erase("pins");
  std::ofstream(folder / "config.json") << config.dump();
  const std::string path = (folder / "config.json").string(), pointer = "/scene/bodies/0/mesh/file=";
  EXPECT_EQ(expect_alike(path, {{pointer + "a.obj"}, {pointer + "b.obj"}, {}}).read, 3);
  ConfigFamily family(path);
  family.read(Overrides{pointer + "a.obj"});
  const auto a = family.identity();
  family.read(Overrides{pointer + "b.obj"});
  const auto b = family.identity();
  EXPECT_EQ(a.config_id, b.config_id);
  EXPECT_NE(a.document, b.document);
}

}  // namespace
}  // namespace bb::test::config_family_test
