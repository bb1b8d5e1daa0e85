#include <fmt/format.h>

#include <functional>

#include "barriers/shapes/registry.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/integrators/registry.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/math/error.hpp"
#include "core/newton/step_solver.hpp"
#include "experiments/cli/verbs.hpp"
#include "experiments/config/presets.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb::cli {
namespace {

template <class Entries>
void print_entries(const char* title, const Entries& entries) {
  fmt::print("{}\n", title);
  for (const auto& entry : entries) fmt::print("  {:<22} {}\n", entry.name, entry.doc);
}

struct Section {
  const char* name;
  std::function<void()> print;
};

}  // namespace

int list(const std::string& what) {
  const Section sections[] = {
      {"shapes", [] { print_entries("shapes", shapes()); }},
      {"policies", [] { print_entries("policies", stiffness_policies()); }},
      {"integrators", [] { print_entries("integrators", integrators()); }},
      {"step_solvers", [] { print_entries("step_solvers", step_solvers()); }},
      {"scenes", [] { print_entries("scenes", procedural_scenes()); }},
      {"linear_solvers", [] { print_entries("linear_solvers", linear_solvers()); }},
      {"membranes", [] { print_entries("membranes", membrane_models<double>()); }},
      {"formulations", [] { print_entries("formulations", formulation_presets()); }},
  };
  bool known = what == "all";
  std::string names = "all";
  for (const Section& section : sections) {
    names += std::string(", ") + section.name;
    if (what != "all" && what != section.name) continue;
    section.print();
    known = true;
  }
  if (!known) throw ConfigError("list", '"' + what + '"', names);
  return exit_ok;
}

}  // namespace bb::cli
