#include <fmt/format.h>

#include <functional>

#include "barriers/shapes/registry.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/energy/solid_model.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/error.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/integrators/registry.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/terminal.hpp"
#include "experiments/config/film_generators.hpp"
#include "experiments/config/mesh_generators.hpp"
#include "experiments/config/methods.hpp"
#include "experiments/config/presets.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb::cli {
namespace {

constexpr std::size_t doc_column = 25;

/// One line a parameter: key, default with its unit, what is allowed, meaning.
void print_parameters(const std::vector<Parameter>& parameters) {
  for (const Parameter& p : parameters) {
    const std::string fallback = to_text(p.fallback);
    const bool bare = fallback.empty() || p.rule.unit.empty() || p.rule.unit == "1";
    print_wrapped(fmt::format("    {:<20} {:<16} {:<46} {}", p.name,
                              fallback + (bare ? "" : " " + p.rule.unit), allowed_text(p.rule), p.doc),
                  doc_column);
  }
}

template <class Entries>
void print_entries(const char* title, const Entries& entries) {
  show("{}\n", title);
  for (const auto& entry : entries) {
    print_wrapped(fmt::format("  {:<22} {}", entry.name, entry.doc), doc_column);
    if constexpr (requires { entry.guarantee; })
      print_wrapped(fmt::format("    guarantee: {}", entry.guarantee), doc_column);
    if constexpr (requires { entry.parameters; }) print_parameters(entry.parameters);
  }
}

constexpr const char* parameter_columns = "parameter, default, allowed values, meaning";

void print_scenes() {
  show("scenes (/scene/name; below each: {})\n", parameter_columns);
  for (const ProceduralScene& scene : procedural_scenes()) {
    const SceneDefaults& d = scene.defaults;
    print_wrapped(fmt::format("  {:<22} {}", scene.name, scene.doc), doc_column);
    print_wrapped(
        fmt::format("    defaults: /time/dt_s {:g} s, /time/steps {}, /formulation/d_hat_m {:g} m, {}", d.dt,
                    d.steps, d.d_hat,
                    d.limit ? fmt::format("/strain_limit/limit {:g}", *d.limit) : "no strain limit"),
        doc_column);
    print_parameters(scene.parameters);
  }
  print_wrapped(fmt::format("  {:<22} {}", "bodies",
                            "meshes, pins and obstacles given as JSON: examples/scenes/README.md"),
                doc_column);
}

void print_generators() {
  show("generators (/scene/bodies/N/mesh/generator; below each: {})\n", parameter_columns);
  for (const MeshGenerator& generator : mesh_generators()) {
    print_wrapped(fmt::format("  {:<22} {}", generator.name, generator.doc), doc_column);
    print_parameters(generator.parameters);
  }
}

void print_films() {
  show("films (/scene/bodies/N/motion/film/generator, /scene/bodies/N/rest_film/generator; below each: {})\n",
       parameter_columns);
  for (const FilmGenerator& generator : film_generators()) {
    print_wrapped(fmt::format("  {:<22} {}", generator.name, generator.doc), doc_column);
    print_parameters(generator.parameters);
  }
}

void print_parts() {
  show("parts (/scene/bodies/N/material; below each: {})\n", parameter_columns);
  for (const PartEntry& entry : part_entries()) {
    print_wrapped(fmt::format("  {:<22} {}", entry.name, entry.doc), doc_column);
    Settings<Material> keys("");
    entry.part.add_keys(keys);
    print_parameters(keys.rows().rows);
  }
}

void print_methods() {
  show("methods (/method; below each: its settings, why, and what this program does otherwise)\n");
  for (const PublishedMethod& method : published_methods()) {
    print_wrapped(fmt::format("  {:<22} {} Source: {}.", method.name, method.doc, method.source), doc_column);
    for (const auto& [pointer, value] : method.set.items()) {
      print_wrapped(fmt::format("    {} = {}", pointer, value.dump()), 6);
      print_wrapped(fmt::format("      {}", method.because.at(pointer)), 6);
    }
    for (const auto& [subject, text] : method.differs)
      print_wrapped(fmt::format("    differs, {}: {}", subject, text), 6);
  }
}

void print_verbs() {
  show("verbs (verb, group, what it is for)\n");
  for (const Verb& verb : verbs())
    print_wrapped(fmt::format("  {:<22} {:<8} {}", verb.typed, verb.group, verb.doc), doc_column);
}

struct Section {
  const char* name;
  std::function<void()> print;
};

const std::vector<Section>& sections() {
  static const std::vector<Section> list = {
      {"shapes", [] { print_entries("shapes", all_shapes()); }},
      {"policies",
       [] {
         print_entries("policies (/formulation/stiffness_policy)", stiffness_policies());
         print_entries("policies of the limit (/strain_limit/stiffness_policy)", limit_policies());
       }},
      {"integrators", [] { print_entries("integrators", integrators()); }},
      {"step_solvers",
       [] {
         print_entries(
             "step_solvers (/step_solver/name; a guarantee against passing through is of pairs of bodies "
             "that collide as "
             "ccd, which all do unless the scene states otherwise)",
             step_solvers());
       }},
      {"scenes", print_scenes},
      {"generators", print_generators},
      {"films", print_films},
      {"parts", print_parts},
      {"linear_solvers", [] { print_entries("linear_solvers", linear_solvers()); }},
      {"preconditioners", [] { print_entries("preconditioners", preconditioners()); }},
      {"membranes", [] { print_entries("membranes", membrane_models<double>()); }},
      {"solids",
       [] { print_entries("solids (/scene/bodies/N/material/solid_model)", solid_models<double>()); }},
      {"methods", print_methods},
      {"formulations", [] { print_entries("formulations", formulation_presets()); }},
      {"verbs", print_verbs},
  };
  return list;
}

std::vector<std::string> list_sections() {
  std::vector<std::string> names{"all"};
  for (const Section& section : sections()) names.emplace_back(section.name);
  return names;
}

/// Everything that can be named in a config, and the verbs; one section or "all"; scenes and mesh generators with
/// their parameters. Errors: ConfigError for a section that is not in list_sections().
int list(const std::string& what) {
  bool known = what == "all";
  for (const Section& section : sections()) {
    if (what != "all" && what != section.name) continue;
    section.print();
    known = true;
  }
  if (!known) throw unknown_name("list", what, list_sections());
  return exit_ok;
}

}  // namespace

Action verb::list(CLI::App& app) {
  const auto what = std::make_shared<std::string>("all");
  app.add_option("what", *what, fmt::format("which section: {}", fmt::join(list_sections(), ", ")));
  return [what](const CommonOptions&) { return cli::list(*what); };
}

}  // namespace bb::cli
