#include "experiments/run/linear_choice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/input/json.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/newton/newton_system.hpp"
#include "core/parameters/check.hpp"
#include "core/record/provenance.hpp"
#include "core/solvers/linear_solvers.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/method.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr InputKind model_file{"a model of linear solvers", std::uint64_t{1} << 20};

Rule object(ParameterList (*list)()) {
  Rule rule;
  rule.kind = Kind::object;
  rule.list = [list](const json&) { return list(); };
  return rule;
}

ParameterList machine_list() {
  ParameterList list;
  list.rows = {{"cpu_model", required(text_up_to(0)), no_default, "as in the records of that machine"}};
  return list;
}

ParameterList free_list() {
  ParameterList list;
  list.open = true;
  return list;
}

ParameterList seconds_list() {
  ParameterList list;
  for (const std::string_view name : work_term_names) {
    list.rows.push_back({std::string(name), required(non_negative("s")), no_default, "seconds of one"});
  }
  return list;
}

ParameterList cost_list() {
  ParameterList list;
  list.rows = {
      {"solver", required(name_in([] { return linear_solvers().names(); })), no_default, "a linear solver"},
      {"preconditioner", name_in([] { return preconditioners().names(); }), no_default,
       "of a solver with one"},
      {"seconds_each", required(object(seconds_list)), no_default, "coefficients of the work terms"}};
  return list;
}

ParameterList model_list() {
  Rule costs = object(cost_list);
  costs.kind = Kind::objects;
  costs.min_size = 1;
  ParameterList list;
  list.rows = {
      {"schema", required(word({"barrierbench.linear_model/1"})), no_default, "version of this format"},
      {"machine", required(object(machine_list)), no_default, "whose times they are"},
      {"fitted", object(free_list), no_default, "what the fit was made from; free"},
      {"costs", required(costs), no_default, "the solvers to choose from"}};
  return list;
}

LinearCost cost_of(const json& entry) {
  LinearCost cost;
  cost.solver = entry["solver"].get<std::string>();
  cost.preconditioner = entry.value("preconditioner", "");
  for (std::size_t i = 0; i < work_term_names.size(); ++i) {
    cost.seconds_each[i] = entry["seconds_each"][std::string(work_term_names[i])].get<double>();
  }
  return cost;
}

/// The model of this processor. Files are read in the order of their names.
LinearModel model_of_this_machine() {
  const std::string folder = configs_folder() + "/linear_models", cpu = collect_machine().cpu_model;
  std::vector<std::string> files, others;
  std::error_code error;
  for (const auto& file : fs::directory_iterator(folder, error)) {
    if (file.path().extension() == ".json") files.push_back(file.path().string());
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) {
    LinearModel model = read_linear_model(file);
    if (model.cpu_model == cpu) return model;
    others.push_back(model.cpu_model);
  }
  throw ConfigError(
      "/linear_solver/name", fmt::format("auto without a model for this machine ({})", cpu),
      fmt::format("one of {}, or auto after ./bench fit-linear has made a model here; there are "
                  "models for: {}",
                  fmt::join(linear_solvers().names(), ", "),
                  others.empty() ? "no machine" : fmt::format("{}", fmt::join(others, "; "))));
}

/// Of the matrix of the elements alone.
LinearWork work_of(const RunConfig& config) {
  const Scene scene = build_scene(config);
  Calibration any;  // stiffness does not change a pattern
  any.kappa = any.k_s = any.solid_k_s = 1;
  Method method = make_method(config, any);
  method.linear = {};  // any solver will do: nothing is solved
  NewtonSystem system(scene, method);
  return linear_work(system.diagnosis().fixed_pattern());
}

}  // namespace

LinearModel read_linear_model(const std::string& file) {
  json given = read_json_file(file, model_file);
  std::vector<Violation> violations;
  check_value(given, object(model_list), file + "#", violations);
  for (std::size_t i = 0; violations.empty() && i < given["costs"].size(); ++i) {
    const LinearCost cost = cost_of(given["costs"][i]);
    const Parameter* const named = preconditioner_parameter(linear_solvers().require(cost.solver, file));
    const std::vector<std::string> its = named ? named->rule.words() : std::vector<std::string>{""};
    if (std::find(its.begin(), its.end(), cost.preconditioner) != its.end()) continue;
    violations.push_back(
        {fmt::format("{}#/costs/{}/preconditioner", file, i),
         cost.preconditioner.empty() ? "nothing" : "\"" + cost.preconditioner + "\"",
         named ? "a preconditioner that " + cost.solver + " has: " + fmt::format("{}", fmt::join(its, ", "))
               : "nothing: " + cost.solver + " has none"});
  }
  if (!violations.empty()) throw ConfigError(std::move(violations));
  LinearModel model{file, given["machine"]["cpu_model"].get<std::string>(), {}};
  for (const json& entry : given["costs"]) model.costs.push_back(cost_of(entry));
  return model;
}

void decide_linear_solver(RunConfig& config) {
  if (config.linear_solver.name != linear_solver_auto) return;
  const LinearModel model = model_of_this_machine();
  const LinearWork work = work_of(config);
  const LinearCost& chosen = model.costs[cheapest(model.costs, work)];
  config.linear_solver.name = chosen.solver;
  const LinearSolverEntry& entry = linear_solvers().require(chosen.solver, "/linear_solver/name");
  set_preconditioner(entry, chosen.preconditioner, config.linear_solver.parameters);
  config.linear_solver_reason = fmt::format(
      "by auto: a solve is expected to take {} ({}); {:.0f} unknowns, {:.3g} entries, of a Cholesky "
      "factor {:.3g}, {:.3g} operations",
      cost_text(model.costs, work), fs::path(model.file).filename().string(), work.unknowns, work.entries,
      work.factor_entries, work.factor_flop);
}

std::optional<double> expected_solve_s(const RunConfig& config) {
  try {
    const LinearModel model = model_of_this_machine();
    const auto of_solver = [&](const std::string& name) {
      return std::find_if(model.costs.begin(), model.costs.end(),
                          [&](const LinearCost& cost) { return cost.solver == name; });
    };
    auto found = of_solver(config.linear_solver.name);
    if (found == model.costs.end()) found = of_solver("cholmod");
    if (found == model.costs.end()) return {};
    return found->seconds(work_of(config));
  } catch (const ConfigError&) {
    return {};
  }
}

RunConfig load_run(const std::string& path, std::span<const std::string> overrides) {
  RunConfig config = load_config(path, overrides);
  decide_linear_solver(config);
  return config;
}

}  // namespace bb
