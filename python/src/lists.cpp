// What can be named in a config, with its parameters, and configs as JSON text.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>

#include "barriers/shapes/registry.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/base/parameters/parameter.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/model/bodies/part.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/config/mesh_generators.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/scenes/procedural_scene.hpp"
#include "python/src/bindings.hpp"

namespace bb::python {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::vector<Parameter>& parameters) {
  Json out = Json::array();
  for (const Parameter& p : parameters) {
    out.push_back({{"name", p.name},
                   {"default", to_text(p.fallback)},
                   {"unit", p.rule.unit},
                   {"allowed", allowed_text(p.rule)},
                   {"doc", p.doc}});
  }
  return out;
}

template <class Entries>
std::string entries_json(const Entries& entries) {
  Json out = Json::array();
  for (const auto& entry : entries) {
    Json one = {{"name", entry.name}, {"doc", entry.doc}, {"parameters", Json::array()}};
    if constexpr (requires { entry.parameters; }) one["parameters"] = json_of(entry.parameters);
    out.push_back(std::move(one));
  }
  return out.dump();
}

std::string parts_json() {
  Json out = Json::array();
  for (const PartEntry& entry : part_entries()) {
    Settings<Material> keys("");
    entry.part.add_keys(keys);
    out.push_back({{"name", entry.name}, {"doc", entry.doc}, {"parameters", json_of(keys.rows().rows)}});
  }
  return out.dump();
}

}  // namespace

void bind_lists(nb::module_& m) {
  m.def("shapes_json", [] { return entries_json(all_shapes()); });
  m.def("scenes_json", [] { return entries_json(procedural_scenes()); });
  m.def("generators_json", [] { return entries_json(mesh_generators()); });
  m.def("parts_json", &parts_json);
  m.def("policies_json", [] { return entries_json(stiffness_policies()); });
  m.def("step_solvers_json", [] { return entries_json(step_solvers()); });
  m.def("linear_solvers_json", [] { return entries_json(linear_solvers()); });
  m.def(
      "resolved_json",
      [](const std::string& text, const std::string& source, const std::string& folder,
         const std::vector<std::string>& overrides) {
        return resolved_json(parse_config(text, source, folder, overrides));
      },
      nb::arg("text"), nb::arg("source"), nb::arg("folder"), nb::arg("overrides"));
}

}  // namespace bb::python
