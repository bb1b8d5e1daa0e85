// What every part has to hold, in a loop over their registry: a new part is tested without a line here, as long as one of
// the mesh generators makes a mesh that it has elements on.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "core/audit/state_audit.hpp"
#include "core/exec/host_executor.hpp"
#include "core/model/bodies/part.hpp"
#include "experiments/config/mesh_generators.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/audit_mesh.hpp"
#include "tests/terms/at_iterate.hpp"

namespace bb::every_part_test {
namespace {

using nlohmann::json;

std::vector<Parameter> keys_of(const Part& part) {
  Settings<Material> keys("");
  part.add_keys(keys);
  return keys.rows().rows;
}

TriangleMesh mesh_of(const MeshGenerator& made) { return made.make(to_map(made.parameters, json::object())); }

/// All other parts are off; of this one, every number that is 0 by default is 1, and so is every mass, whosever it is; but for
/// what the mesh has nothing for, for plasticity, which stands in the place of rates of creep, and for a softening, which lengthens springs
/// beyond their rest.
json material_of(const PartEntry& entry, const TriangleMesh& mesh) {
  json out = json::object();
  if (entry.name != "membrane") out["model"] = "none";
  for (const PartEntry& each : part_entries()) {
    for (const Parameter& key : keys_of(each.part)) {
      const bool own = each.name == entry.name || key.rule.unit.starts_with("kg");
      if (!own || !each.part.lacks(mesh, key.name).empty()) continue;
      const bool off = key.name == "plasticity" || key.name == "cloth_softening_m";
      if (to_json(key.fallback) == 0.0 && !off) out[key.name] = 1.0;
    }
  }
  return out;
}

json body_of(const PartEntry& entry, const MeshGenerator& made) {
  return {{"name", "body"},
          {"mesh", {{"generator", made.name}}},
          {"material", material_of(entry, mesh_of(made))}};
}

RunConfig config_of(const json& bodies) {
  json config = {{"schema", "barrierbench.config/1"}, {"formulation", {{"d_hat_m", 1e-3}}}};
  config["time"] = {{"dt_s", 0.01}, {"steps", 1}};
  config["scene"]["bodies"] = bodies;
  return parse_config(config.dump(), "test");
}

/// A scene of one body that has elements of this part only, or nothing where no generator makes one.
std::optional<Scene> scene_of(const PartEntry& entry, json& body) {
  for (const MeshGenerator& made : mesh_generators()) {
    body = body_of(entry, made);
    try {
      Scene scene = build_scene(config_of(json::array({body})));
      if (entry.part.size(scene) == 0) continue;
      return scene;
    } catch (const ConfigError&) {
      continue;  // nothing of that mesh has a mass
    }
  }
  return std::nullopt;
}

struct PartScene {
  const PartEntry& entry;
  json body;
  Scene scene;
};

std::vector<PartScene> part_scenes() {
  std::vector<PartScene> out;
  for (const PartEntry& entry : part_entries()) {
    json body;
    std::optional<Scene> scene = scene_of(entry, body);
    EXPECT_TRUE(scene) << entry.name << ": no generator makes a body of it";
    if (scene) out.push_back({entry, body, std::move(*scene)});
  }
  return out;
}

TEST(EveryPart, says_of_every_key_what_it_means_and_what_is_allowed) {
  std::size_t n = 0;
  for (const PartEntry& entry : part_entries()) {
    EXPECT_FALSE(entry.doc.empty()) << entry.name;
    EXPECT_FALSE(entry.part.elements().empty() || entry.part.no_elements().empty()) << entry.name;
    EXPECT_FALSE(keys_of(entry.part).empty()) << entry.name;
    for (const Parameter& key : keys_of(entry.part)) {
      EXPECT_FALSE(key.doc.empty()) << key.name;
      if (key.rule.kind != Kind::number) continue;
      EXPECT_FALSE(key.rule.unit.empty()) << key.name;
      EXPECT_TRUE(std::isfinite(key.rule.low)) << key.name << " has no lower bound";
      ++n;
    }
  }
  EXPECT_GT(n, part_entries().size());
}

TEST(EveryPart, refuses_numbers_out_of_range_of_a_config_and_of_a_scene_in_the_same_words) {
  for (const PartScene& part : part_scenes()) {
    for (const Parameter& key : keys_of(part.entry.part)) {
      if (key.rule.kind != Kind::number) continue;
      json bodies = json::array({part.body});
      bodies[0]["material"][key.name] = key.rule.low - 1;
      const std::string allowed = allowed_text(key.rule);
      try {
        config_of(bodies);
        FAIL() << key.name << " accepted";
      } catch (const ConfigError& error) {
        EXPECT_NE(std::string(error.what()).find("/material/" + key.name), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find(allowed), std::string::npos) << error.what();
      }
    }
  }
}

TEST(EveryPart, makes_a_body_of_itself_alone) {
  for (const PartScene& part : part_scenes()) {
    for (const PartEntry& other : part_entries()) {
      EXPECT_EQ(other.part.size(part.scene) > 0, other.name == part.entry.name) << other.name;
    }
    exec::HostExecutor executor;
    std::vector<std::unique_ptr<ElementFamily>> families;
    part.entry.part.add_families(part.scene, {executor}, families);
    std::size_t n = 0;
    for (const auto& family : families) n += static_cast<std::size_t>(family->size());
    EXPECT_EQ(n, part.entry.part.size(part.scene)) << part.entry.name;
  }
}

TEST(EveryPart, has_no_elements_of_a_body_all_of_whose_vertices_are_held) {
  for (const PartScene& part : part_scenes()) {
    json held = part.body, free = held;
    held["name"] = "held", held["pins"] = {{{"all", true}}};
    const Scene scene = build_scene(config_of(json::array({held, free})));
    EXPECT_EQ(part.entry.part.size(scene), part.entry.part.size(part.scene)) << part.entry.name;
  }
}

double energy_at(test::TermsOf& at, const Positions& x) {
  double sum = 0;
  for (const auto& term : at.terms) {
    if (term->group() != TermGroup::elastic) continue;
    term->evaluate(x);
    sum += test::trial_energy(*term);
  }
  return sum;
}

Positions gradient_at(test::TermsOf& at, const Positions& x) {
  Positions sum = Positions::Zero(3, x.cols());
  for (const auto& term : at.terms) {
    if (term->group() != TermGroup::elastic) continue;
    term->linearise(x, at.context(Projection::none));
    sum += test::gradient_of(*term, x.cols());
  }
  return sum;
}

double curvature_at(const test::TermsOf& at, const Positions& dx) {
  double sum = 0;
  for (const auto& term : at.terms) {
    if (term->group() == TermGroup::elastic) sum += test::curvature_along(*term, dx);
  }
  return sum;
}

/// Through its term: the energy of the deformed body, its gradient and exact Hessian along three directions.
TEST(EveryPart, has_an_energy_whose_derivatives_are_its_differences) {
  for (const PartScene& part : part_scenes()) {
    test::TermsOf at(part.scene, part.scene.x0, test::AtIterate::frame(part.scene));
    const auto terms = std::count_if(at.terms.begin(), at.terms.end(),
                                     [&](const auto& term) { return term->name() == part.entry.name; });
    ASSERT_GT(terms, 0) << part.entry.name;
    const double size = (part.scene.x0.rowwise().maxCoeff() - part.scene.x0.rowwise().minCoeff()).maxCoeff();
    const Positions x = test::disturbed(part.scene, 0.02 * size);
    EXPECT_GT(energy_at(at, x), 1e-9) << part.entry.name;
    EXPECT_LT(energy_at(at, part.scene.x0), 1e-12 * energy_at(at, x)) << part.entry.name << ": at rest";
    const double h = 1e-6 * size;
    for (int seed = 0; seed < 3; ++seed) {
      Positions dx = x;
      for (Eigen::Index i = 0; i < dx.size(); ++i)
        dx.data()[i] = std::sin(2.3 * static_cast<double>(i + 50 * seed));
      const double slope = (energy_at(at, x + h * dx) - energy_at(at, x - h * dx)) / (2 * h);
      const Positions behind = gradient_at(at, x - h * dx), ahead = gradient_at(at, x + h * dx);
      const double curvature = (ahead - behind).cwiseProduct(dx).sum() / (2 * h);
      const Positions gradient = gradient_at(at, x);
      ASSERT_GT(std::abs(slope), 1e-6) << part.entry.name;
      ASSERT_GT(std::abs(curvature), 1e-6) << part.entry.name;
      EXPECT_NEAR(gradient.cwiseProduct(dx).sum(), slope, 1e-5 * gradient.norm() * dx.norm())
          << part.entry.name;
      EXPECT_NEAR(curvature_at(at, dx), curvature, 1e-5 * std::abs(curvature)) << part.entry.name;
    }
  }
}

bool has_surface(const Part& part, const MeshGenerator& made) {
  const TriangleMesh mesh = mesh_of(made);
  BodySurface surface;
  surface.enclosed.assign(static_cast<std::size_t>(mesh.n_vertices()), 0);
  part.add_surface(mesh, surface);
  return !surface.mesh.triangles.empty() || !surface.mesh.segments.empty();
}

long crossings_at_start(const Scene& scene) {
  return audit::audit_state(make_audit_mesh(scene, 0.01), scene.x0, true).crossings;
}

/// A rigid sheet through the middle of the body: the audit finds that it crosses what the part brings to the surface.
TEST(EveryPart, brings_a_surface_that_the_audit_judges) {
  json sheet = {{"name", "sheet"}, {"kind", "rigid"}, {"mesh", {{"generator", "grid"}}}};
  sheet["transform"] = {{"scale", 3}, {"axis", {0, 1, 0}}, {"angle_deg", 90}};
  sheet["transform"]["translate_m"] = {0.0123, 0.0345, 0.0456};
  std::set<std::string_view> judged;
  for (const PartEntry& entry : part_entries()) {
    for (const MeshGenerator& made : mesh_generators()) {
      if (!has_surface(entry.part, made)) continue;
      const json body = body_of(entry, made);
      EXPECT_GT(crossings_at_start(build_scene(config_of(json::array({body, sheet})))), 0) << made.name;
      EXPECT_EQ(crossings_at_start(build_scene(config_of(json::array({body})))), 0) << made.name;
      judged.insert(entry.name);
    }
  }
  EXPECT_TRUE(judged.contains("membrane"));
  EXPECT_TRUE(judged.contains("springs"));
}

/// A part that has no kernels, for the refusal of a device.
class Plain final : public Part {
 public:
  void add_keys(Settings<Material>&) const override {}
  std::string_view lacks(const TriangleMesh&, std::string_view) const override { return {}; }
  void add_elements(const BodySpec&, BodyElements&) const override {}
  std::size_t size(const Scene& scene) const override { return scene.bodies.size(); }
  std::string_view elements() const override { return "plain things"; }
  std::string_view no_elements() const override { return "nothing plain"; }
  void add_families(const Scene&, const FamilyPlace&,
                    std::vector<std::unique_ptr<ElementFamily>>&) const override {}
  std::vector<std::string> element_names() const override { return {}; }
  ElementAnswer element(const std::string&, Fields&) const override { return {}; }
};

TEST(RequireKernels, names_a_part_that_no_kernel_is_there_for) {
  const Plain plain;
  std::vector<PartEntry> entries(part_entries().begin(), part_entries().end());
  const Scene scene = part_scenes().front().scene;
  EXPECT_NO_THROW(require_kernels(entries, scene, "/scene"));
  entries.push_back({"plain", "", plain});
  EXPECT_NO_THROW(require_kernels(entries, Scene(), "/scene"));
  try {
    require_kernels(entries, scene, "/scene");
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.violations().front().found, "1 plain things, a part without kernels");
    EXPECT_EQ(error.violations().front().allowed,
              "elements of membrane, springs, cloth_springs, hinges, rods, tetrahedra");
  }
}

}  // namespace
}  // namespace bb::every_part_test
