#include "experiments/matrix/replay_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

namespace bb {
namespace {

using nlohmann::ordered_json;

ordered_json number(double v) { return std::isfinite(v) ? ordered_json(v) : ordered_json(nullptr); }
ordered_json number(const Number& v) { return v.finite() ? ordered_json(v.value) : ordered_json(nullptr); }
std::string shown(double v) { return std::isfinite(v) ? fmt::format("{:.4g}", v) : "-"; }

std::string origin_text(const SystemOrigin& o) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (!o.scene.empty()) add(o.scene);
  if (!o.formulation.empty()) add(o.formulation);
  if (!o.integrator.empty()) add(o.integrator);
  if (o.dt_s > 0) add(fmt::format("dt {:g} s", o.dt_s));
  if (o.step >= 0) add(fmt::format("step {}", o.step));
  if (o.iteration >= 0) add(fmt::format("iteration {}", o.iteration));
  if (!o.form.empty()) add(o.form + " matrix");
  if (!o.cause.empty()) add("cause: " + o.cause);
  return text.empty() ? "origin unknown" : text;
}

/// "144 blocks of 3"
std::string blocks_text(const std::vector<int>& start) {
  int least = 3, most = 1;
  for (std::size_t b = 1; b < start.size(); ++b) {
    least = std::min(least, start[b] - start[b - 1]);
    most = std::max(most, start[b] - start[b - 1]);
  }
  return fmt::format("{} blocks of {}", start.size() - 1,
                     least == most ? std::to_string(least) : fmt::format("{} to {}", least, most));
}

ordered_json to_json(const ReplayedSolve& row) {
  const LinearReport& r = row.report;
  ordered_json out = {{"solver", row.solver},          {"preconditioner", row.preconditioner},
                      {"status", to_string(r.status)}, {"detail", r.detail},
                      {"iterations", r.iterations},    {"residual", number(r.residual_true)}};
  if (r.iterative) out["tolerance"] = r.tolerance;
  out["factor_entries"] = number(r.factor_nnz);
  out["preconditioner_shift"] = number(r.preconditioner_shift);
  out["analyze_s"] = r.analyze_s;
  out["factor_s"] = r.factor_s;
  out["solve_s"] = r.solve_s;
  return out;
}

ordered_json to_json(const ReplayedEstimate& row) {
  const ConditionEstimate& e = row.estimate;
  return {{"tier", static_cast<int>(row.estimator)},
          {"scaling", to_string(row.scaling)},
          {"status", to_string(e.status)},
          {"cond", number(e.cond)},
          {"lambda_min", number(e.lambda_min)},
          {"lambda_max", number(e.lambda_max)},
          {"method", e.method},
          {"dense", to_string(row.agreement)},
          {"cond_change_rel", number(row.cond_change_rel)},
          {"residual", number(e.residual)},
          {"proof", to_string(e.proof)},
          {"solves", e.solves},
          {"products", e.products},
          {"factorizations", e.factorizations},
          {"time_s", e.seconds}};
}

}  // namespace

std::string replay_table(const std::string& path, const StoredSystem& stored, const Replay& replay) {
  const ReducedSystem& system = stored.system;
  std::string text = fmt::format(
      "{}: {} rows, {} entries in the lower triangle, {}{}\n  {}\n  right-hand side: {}, |b| = {:.4g}\n",
      path, system.lower.rows(), system.lower.nonZeros(), blocks_text(system.block_start),
      stored.has_side_car ? "" : " (no side-car: 3 where that divides the rows, else 1)",
      origin_text(stored.origin), stored.rhs_source, stored.rhs.norm());
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "  {:<16} {:<13} {:<25} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "solver",
                 "preconditioner", "status", "iterations", "residual", "analyse s", "factor s", "solve s");
  for (const ReplayedSolve& row : replay.solves) {
    const LinearReport& r = row.report;
    fmt::format_to(out, "  {:<16} {:<13} {:<25} {:>10} {:>10} {:>10.2e} {:>10.2e} {:>10.2e}{}{}\n",
                   row.solver, row.preconditioner == "none" && !r.iterative ? "-" : row.preconditioner,
                   to_string(r.status), r.iterations, shown(r.residual_true), r.analyze_s, r.factor_s,
                   r.solve_s, r.detail.empty() ? "" : "  ", r.detail);
  }
  fmt::format_to(out, "  {:<13} {:<13} {:<14} {:>10} {:>11} {:>10} {:>9} {:>10} {:>10}  {}\n", "estimator",
                 "scaling", "status", "cond", "lambda_min", "lambda_max", "dense", "change", "seconds",
                 "method");
  for (const ReplayedEstimate& row : replay.estimates) {
    const ConditionEstimate& e = row.estimate;
    fmt::format_to(out, "  {:<13} {:<13} {:<14} {:>10} {:>11} {:>10} {:>9} {:>10} {:>10.2e}  {}\n",
                   to_string(row.estimator), to_string(row.scaling), to_string(e.status), shown(e.cond),
                   shown(e.lambda_min), shown(e.lambda_max), to_string(row.agreement),
                   shown(row.cond_change_rel.value), e.seconds, e.method);
  }
  return text;
}

nlohmann::ordered_json replay_json(const std::string& path, const StoredSystem& stored,
                                   const Replay& replay) {
  const SystemOrigin& origin = stored.origin;
  ordered_json out = {{"file", path},
                      {"rows", stored.system.lower.rows()},
                      {"entries", stored.system.lower.nonZeros()},
                      {"blocks", stored.system.block_start.size() - 1},
                      {"side_car", stored.has_side_car},
                      {"rhs", stored.rhs_source},
                      {"scene", origin.scene},
                      {"formulation", origin.formulation},
                      {"form", origin.form},
                      {"cause", origin.cause}};
  out["solves"] = out["estimates"] = ordered_json::array();
  for (const ReplayedSolve& row : replay.solves) out["solves"].push_back(to_json(row));
  for (const ReplayedEstimate& row : replay.estimates) out["estimates"].push_back(to_json(row));
  return out;
}

}  // namespace bb
