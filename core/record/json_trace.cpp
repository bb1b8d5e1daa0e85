// TraceRow -> one line of trace.jsonl.
#include "core/record/json_fields.hpp"
#include "core/record/writer.hpp"

namespace bb {
namespace {

using fields::Json;
using fields::put;

/// An unknown eigenvalue is null, its reason the estimate's own status word.
Number known(double v, const char* status) { return std::isfinite(v) ? Number(v) : Number::missing(status); }

Json condition(const ConditionSample& sample) {
  const ConditionEstimate& e = sample.estimate;
  const std::string status(to_string(e.status));
  Json j = {
      {"stage", to_string(sample.stage)}, {"scaling", to_string(sample.scaling)}, {"tier", sample.tier}};
  put(j, "lambda_min", known(e.lambda_min, status.c_str()));
  put(j, "lambda_max", known(e.lambda_max, status.c_str()));
  put(j, "cond", known(e.cond, status.c_str()));
  j["status"] = status;
  j["method"] = e.method;
  put(j, "residual", e.residual);
  j["solves"] = e.solves;
  j["products"] = e.products;
  j["factorizations"] = e.factorizations;
  put(j, "time_s", e.seconds);
  return j;
}

void put_step_length(Json& j, const TraceRow& row) {
  put(j, "alpha", row.alpha);
  put(j, "alpha_ccd", row.alpha_ccd);
  put(j, "alpha_strain", row.alpha_strain);
  j["line_search_trials"] = row.line_search_trials;
  j["rounding_accept"] = row.rounding_accept;
}

void put_linear(Json& j, const TraceRow& row) {
  j["linear_status"] = row.linear_status;
  j["linear_iterations"] = row.linear_iterations;
  put(j, "residual_true", row.residual_true);
  put(j, "residual_recurrence", row.residual_recurrence);
  put(j, "ritz_min", row.ritz_min);
  put(j, "ritz_max", row.ritz_max);
  put(j, "probe_pcg_iterations", row.probe_pcg_iterations);
  j["n_free"] = row.n_free;
  j["nnz"] = row.nnz;
  j["analyzed"] = row.analyzed;
}

void put_contact(Json& j, const TraceRow& row) {
  j["contacts"] = fields::contacts(row.contacts);
  put(j, "gap_min_iterates_m", row.gap_min_iterates_m);
  put(j, "gap_min_iterates_rel", row.gap_min_iterates_rel);
  put(j, "kappa_min_N_per_m", row.kappa_min_N_per_m);
  put(j, "kappa_max_N_per_m", row.kappa_max_N_per_m);
  put(j, "kappa_change_rel", row.kappa_change_rel);
  put(j, "limit_kappa_change_rel", row.limit_kappa_change_rel);
  put(j, "limit_gap_min_rel", row.limit_gap_min_rel);
  put(j, "contact_curvature_max_N_per_m", row.contact_curvature_max_N_per_m);
  put(j, "contact_load_max_N", row.contact_load_max_N);
  put(j, "max_stretch", row.max_stretch);
  put(j, "limit_load_max_N_per_m", row.limit_load_max_N_per_m);
}

}  // namespace

std::string to_json(const TraceRow& row) {
  Json j = {{"step", row.step}, {"iteration", row.iteration}};
  put(j, "t_s", row.t_s);
  put(j, "energy_J", row.energy_J);
  put(j, "energy_change_J", row.energy_change_J);
  put(j, "grad_inf_N", row.grad_inf_N);
  put(j, "dx_inf_m", row.dx_inf_m);
  put(j, "decrement_J", row.decrement_J);
  put_step_length(j, row);
  put_linear(j, row);
  put_contact(j, row);
  j["cond"] = Json::array();
  for (const ConditionSample& sample : row.cond) j["cond"].push_back(condition(sample));
  j["time"] = fields::phases(row.time);
  fields::require_finite(j);
  return j.dump();
}

}  // namespace bb
