// What bodies are made of, and what parts can have besides. Every step solver with energies has to end where line_search does, which other
// tests hold to closed forms (tests/accuracy): the answer of an integrator is that of line_search with it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/step_solvers/registry.hpp"
#include "tests/features/feature.hpp"

namespace bb::features {
namespace {

using nlohmann::json;

constexpr double off_most = 0.02;  // of the longest way

/// A body that hangs from some of its vertices.
json hanging(const Method& method, const json& mesh, const json& material, const json& held) {
  json config = bare(method, 5e-3, 40);
  config["scene"]["gravity_m_per_s2"] = {0, -1, -1};
  config["scene"]["bodies"] = {{{"name", "body"}, {"mesh", mesh}, {"material", material}, {"pins", {held}}}};
  ground(method, config, 0.5);
  if (method.still()) {
    json& pins = config["scene"]["bodies"][0]["pins"];
    pins[1].erase("all");
    for (auto v = held["indices"].size(); v < 8; ++v) pins[1]["indices"].push_back(v);
  }
  return config;
}

json cloth() { return {{"generator", "grid"}, {"n_x", 2}, {"n_y", 4}, {"size_x_m", 0.1}, {"size_y_m", 0.3}}; }
const json upper_side = {{"indices", {0, 1}}};

/// The run of the same config with line_search.
Track reference(const Method& method, const std::function<json(const Method&)>& config) {
  const Method by_line_search{step_solvers().require("line_search", ""), method.entry, method.integrator};
  return run_case(config(by_line_search)).track;
}

/// projection makes springs as stiff as its sweeps make them, whatever their N/m: the rows of the cloth stay as far apart as at rest.
std::string keeps_its_lengths(const Track& run, double row) {
  for (int v = 0; v + 2 < 8; ++v) {
    const double length = (run.end().col(v + 2) - run.end().col(v)).norm();
    if (auto wrong = differs("length", length, row, 1e-4); !wrong.empty()) return wrong;
  }
  return {};
}

Feature as_line_search(const std::string& name, const std::vector<std::string_view>& terms,
                       const std::function<json(const Method&)>& config, double row = 0.1) {
  const auto wrong = [config, row](const Method& method, const Track& run) -> std::string {
    if (method.solver.name == "projection") return keeps_its_lengths(run, row);
    const Track known = reference(method, config);
    const Positions& there = known.x[known.at(run.t_end())];
    const double way = (there - known.x[0]).colwise().norm().maxCoeff();
    if (way < 1e-3) return fmt::format("nothing moves: {:.3g} m", way);
    const double off = (run.end() - there).colwise().norm().maxCoeff();
    if (off <= off_most * way) return {};
    return fmt::format("{:.3g} m off the end of line_search, of a way of {:.3g} m", off, way);
  };
  return {name, "the state is that of line_search", terms, false, config, wrong};
}

json membrane(const Method& method, const json& more) {
  json material = {{"youngs_N_per_m", 30.0}, {"density_kg_per_m2", 1.0}};
  material.update(more);
  return hanging(method, cloth(), material, upper_side);
}

json limited(const Method& method) {
  json config = membrane(method, {{"youngs_N_per_m", 5.0}});
  config["scene"]["gravity_m_per_s2"] = {0, 10, 0};  // along the cloth, away from what holds it
  config["time"]["steps"] = 80;
  config["strain_limit"] = {{"limit", 0.04}, {"shape", "quadratic"}, {"argument", "gap"}};
  config["strain_limit"]["stiffness_policy"] = {{"name", "fixed"}, {"k_s_N_per_m", 600.0}};
  return config;
}

/// Along the cloth, from row to row.
std::string stays_below_its_limit(const Method&, const Track& run) {
  double longest = 0;
  for (const Positions& x : run.x) {
    for (int v = 0; v + 2 < 8; ++v) longest = std::max(longest, (x.col(v + 2) - x.col(v)).norm() / 0.1);
  }
  if (longest >= 1.04) return fmt::format("stretched to {:.4g}, beyond the limit of 1.04", longest);
  return longest < 1.0205 ? fmt::format("stretched to {:.4g}: the limit acts from 1.02 on", longest) : "";
}

}  // namespace

std::vector<Feature> part_features() {
  const auto springs = [](const Method& method) {
    return hanging(method, cloth(), {{"model", "none"}, {"springs_N_per_m", 20}, {"density_kg_per_m2", 1}},
                   upper_side);
  };
  const auto cloth_springs = [](const Method& method) {
    return hanging(method, cloth(),
                   {{"model", "none"},
                    {"cloth_tension_N_per_m", 20},
                    {"cloth_compression_N_per_m", 10},
                    {"density_kg_per_m2", 1}},
                   upper_side);
  };
  const auto two_apart = [](const Method& method) {
    return hanging(method, cloth(),
                   {{"model", "none"},
                    {"cloth_tension_N_per_m", 20},
                    {"cloth_skip_one_N_per_m", 8},
                    {"cloth_softening_m", 0.02},
                    {"density_kg_per_m2", 1}},
                   upper_side);
  };
  const auto rod = [](const Method& method) {
    return hanging(method, {{"generator", "rod"}, {"n_segments", 7}, {"length_m", 0.35}},
                   {{"line_density_kg_per_m", 0.1}, {"rod_stretching_N", 20}, {"rod_bending_N_m2", 1e-4}},
                   upper_side);
  };
  const auto solid = [](const Method& method) {
    return hanging(method,
                   {{"generator", "solid_box"},
                    {"n_x", 1},
                    {"n_y", 1},
                    {"n_z", 1},
                    {"size_x_m", 0.1},
                    {"size_y_m", 0.1},
                    {"size_z_m", 0.1}},
                   {{"solid_youngs_Pa", 1000}, {"solid_density_kg_per_m3", 100}},
                   {{"indices", {0, 1, 2, 3}}});
  };
  const auto of_membrane = [](const json& more) {
    return [more](const Method& method) { return membrane(method, more); };
  };
  /// Half as long again along y and x at the end of the film.
  const auto grows = [](const std::function<json(const Method&)>& config) {
    return [config](const Method& method) {
      json out = config(method);
      out["scene"]["bodies"][0]["rest_film"] = {{"generator", "grow"},
                                                {"factor_x", 1.1},
                                                {"factor_y", 1.2},
                                                {"period_s", 0.4},
                                                {"duration_s", 0.2}};
      return out;
    };
  };
  const json shrinks = {{{"time_s", 0.0}, {"factor", 1.0}}, {{"time_s", 0.2}, {"factor", 0.9}}};
  const auto shrinking = [](const std::function<json(const Method&)>& config, const json& keys) {
    return [config, keys](const Method& method) {
      json out = config(method);
      out["scene"]["bodies"][0]["material"]["shrink_schedule"] = keys;
      return out;
    };
  };
  const auto weighted = [](const Method& method) {
    json out = membrane(method, {{"bending_J", 1e-3}});
    json& body = out["scene"]["bodies"][0];
    body["weights"] = {{{"name", "down"}, {"axis", {0, 1, 0}}, {"from_m", 0.15}, {"to_m", -0.15}}};
    for (const char* of : {"membrane", "hinges"})
      body["stiffness_weights"].push_back(
          {{"of", of}, {"mix", {{{"group", "down"}}}}, {"min", 2}, {"max", 0.5}});
    return out;
  };
  return {as_line_search("springs", {"springs"}, springs),
          as_line_search("springs of cloth", {"cloth_springs"}, cloth_springs),
          as_line_search("springs two apart", {"cloth_springs"}, two_apart),
          as_line_search("membrane", {"membrane"}, of_membrane(json::object())),
          as_line_search("hinges", {"hinges"}, of_membrane({{"bending_J", 1e-3}})),
          as_line_search("rods", {"rods"}, rod),
          as_line_search("solids", {"tetrahedra"}, solid),
          as_line_search("shrink schedule", {}, of_membrane({{"shrink_schedule", shrinks}})),
          as_line_search("rest film of a membrane", {}, grows(of_membrane({{"bending_J", 1e-3}}))),
          as_line_search("rest film of springs", {}, grows(springs), 0.12),
          as_line_search("rest film of springs of cloth", {}, grows(cloth_springs)),
          as_line_search("rest film of rods", {}, grows(rod)),
          as_line_search("rest film of solids", {}, grows(solid)),
          as_line_search("shrink schedule of rods", {}, shrinking(rod, shrinks)),
          as_line_search("shrink schedule of solids", {}, shrinking(solid, shrinks)),
          as_line_search("plasticity", {}, of_membrane({{"plasticity", 0.4}})),
          as_line_search("stiffness by weights", {}, weighted),
          as_line_search("creep", {}, of_membrane({{"membrane_creep_per_s", 20.0}})),
          {"strain limit",
           "no stretch reaches the limit",
           {"strain_limit"},
           false,
           limited,
           stays_below_its_limit}};
}

}  // namespace bb::features
