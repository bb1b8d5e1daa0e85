// The sections of settings.inc as lists, the policies, and the document that holds them all.
#include "experiments/config/sections.hpp"

#include "barriers/formulas.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/base/input/json.hpp"
#include "core/energy/friction_law.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/model/integrators/registry.hpp"
#include "core/newton/step_solver.hpp"
#include "core/terms/step_hessian.hpp"
#include "experiments/config/config_list.hpp"
#include "experiments/config/methods.hpp"

namespace bb {
namespace {

template <class... Registries>
std::vector<Parameter> rows_of_each(const Registries&... registries) {
  std::vector<Parameter> all;
  const auto append = [&all](std::vector<Parameter> rows) {
    all.insert(all.end(), rows.begin(), rows.end());
  };
  (append(rows_of_all(registries)), ...);
  return all;
}

template <class Entry>
Settings<PolicyConfig> policy_settings(const Registry<Entry>& registry, std::string doc) {
  Settings<PolicyConfig> out(std::move(doc));
  out.add("name", name_in([&registry] { return registry.names(); }), "A registered stiffness policy.",
          &PolicyConfig::name);
  out.add("scale", positive("1"), "Factor on every kappa.", &PolicyConfig::scale);
  out.own(rows_of_all(registry), &PolicyConfig::parameters);
  return out;
}

}  // namespace

const Settings<PolicyConfig>& contact_policy_settings() {
  static const Settings<PolicyConfig> list = policy_settings(
      stiffness_policies(), "Rule that gives every contact its kappa, with the parameters of that policy.");
  return list;
}
const Settings<PolicyConfig>& limit_policy_settings() {
  static const Settings<PolicyConfig> list =
      policy_settings(limit_policies(),
                      "Rule that gives every element its kappa_e. Default: the formulation's, or fixed where "
                      "the limit does not "
                      "have it.");
  return list;
}

#define SECTION(type, doc)   \
  template <>                \
  Settings<type> list_of() { \
    using S = type;          \
    Settings<S> out(doc);
#define SETTING(type, member, name, rule, doc, ...) out.add(name, rule, doc, &S::member);
#define NEST(type, member, name, settings) out.nest(name, settings, &S::member);
#define OWN(...) out.own(rows_of_each(__VA_ARGS__), &S::parameters);
#define END_SECTION \
  return out;       \
  }
#include "experiments/config/settings.inc"

namespace {

/// What the document is, and what it is laid over.
void add_origin(Settings<RunConfig>& out) {
  out.add_row({"schema", required(word({"barrierbench.config/1"})), no_default, "Version of this format."},
              nullptr, [](const RunConfig&) { return "barrierbench.config/1"; });
  out.add_row(
      {"name", any_text(), no_default,
       "Free label, which progress lines, tables and figures show; no part of the identity of a run."});
  out.add_row({"doc", free_text(), no_default, "Free text; no part of the identity of a run."});
  out.add_row({"extends", any_text(), no_default,
               "Path of a config, relative to this file, that this one is laid over, object by object."});
  out.add("method", name_in(method_names),
          "A published method in one piece (configs/methods/NAME.json, `bench list methods`): its settings "
          "are laid "
          "underneath those that stand beside its name, and over those of a config that this one extends. "
          "The record "
          "names those that are overridden: such a run is of no published method.",
          &RunConfig::method);
}

/// A limit that is off is written as that alone.
void add_strain_limit(Settings<RunConfig>& out) {
  out.add_row(
      {"strain_limit", settings_of<StrainLimitConfig>().rule(), no_default, ""},
      [](const nlohmann::json* given, RunConfig& config) {
        settings_of<StrainLimitConfig>().read(given ? *given : nlohmann::json::object(), config.strain_limit);
      },
      [](const RunConfig& config) {
        if (!config.strain_limit.enabled) return nlohmann::json{{"enabled", false}};
        return settings_of<StrainLimitConfig>().write(config.strain_limit);
      });
}

/// What a run computes in, and where.
void add_arithmetic(Settings<RunConfig>& out) {
  out.add(
      "precision", one_of<Precision>(),
      "Arithmetic of the pipeline. mixed: Hessians of elements and contacts in float, all else in double. "
      "float: states are rounded to float, gaps, energies, gradients, Hessians and step bounds computed in "
      "it; "
      "sums, solves and the audit stay double. The times of mixed and float are no times of such a program.",
      &RunConfig::precision);
  out.add("device", one_of<Device>(),
          "Where it computes. cpu: the CPU pipeline. host: the device backend on threads, the same "
          "kernels as on a "
          "device. cuda: on a CUDA device (./bench device reports whether there is one).",
          &RunConfig::device);
}

}  // namespace

template <>
Settings<RunConfig> list_of() {
  Settings<RunConfig> out(
      "Everything one run is made of. What is left out takes the default of the scene, then the default "
      "written "
      "here. Lengths in m, times in s, masses in kg; the unit of each number stands in its key and in the "
      "annotation \"unit\". Names of shapes, policies, integrators, solvers, scenes and mesh generators "
      "are open: "
      "`bench list` shows them.");
  add_origin(out);
  out.add_row({"scene", required(scene_rule()), no_default, ""}, nullptr,
              [](const RunConfig& config) { return scene_json(config.scene); });
  out.nest("formulation", settings_of<FormulationConfig>(), &RunConfig::formulation, "the name of a preset");
  add_strain_limit(out);
  out.nest("matching", settings_of<MatchingConfig>(), &RunConfig::matching);
  out.nest("contact", settings_of<ContactConfig>(), &RunConfig::contact);
  out.nest("friction", settings_of<FrictionConfig>(), &RunConfig::friction);
  out.nest("integrator", settings_of<IntegratorConfig>(), &RunConfig::integrator);
  out.nest("time", settings_of<TimeConfig>(), &RunConfig::time);
  out.nest("step_solver", settings_of<StepSolverConfig>(), &RunConfig::step_solver);
  out.nest("hessian", settings_of<HessianConfig>(), &RunConfig::hessian);
  out.nest("linear_solver", settings_of<LinearSolverConfig>(), &RunConfig::linear_solver);
  add_arithmetic(out);
  out.nest("passes", settings_of<PassesConfig>(), &RunConfig::passes);
  out.nest("diagnose", settings_of<DiagnoseConfig>(), &RunConfig::diagnose);
  out.nest("seeds", settings_of<SeedsConfig>(), &RunConfig::seeds);
  out.nest("output", settings_of<OutputConfig>(), &RunConfig::output);
  out.add("threads", count(0, 4096), "Threads of the loops; 0: all cores. Never changes a result.",
          &RunConfig::threads);
  return out;
}

ParameterList config_list() { return settings_of<RunConfig>().rows(); }

}  // namespace bb
