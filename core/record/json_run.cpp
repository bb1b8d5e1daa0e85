// RunRecord -> run.json. One function a section, in the order of the schema.
#include <stdexcept>

#include "core/record/json_fields.hpp"
#include "core/record/writer.hpp"

namespace bb {
namespace {

using fields::Json;
using fields::put;

Json parse_config(const std::string& text) {
  Json j = Json::parse(text, nullptr, false);
  if (j.is_discarded()) throw std::invalid_argument("record: config_json is not JSON");
  return j;
}

Json ids(const Ids& v) {
  Json j = {{"config_id", v.config_id},   {"run_id", v.run_id},         {"build_id", v.build_id},
            {"machine_id", v.machine_id}, {"repetition", v.repetition}, {"parent_ids", v.parent_ids}};
  if (!v.sweep_id.empty()) j["sweep_id"] = v.sweep_id;
  if (!v.rerun_of.empty()) j["rerun_of"] = v.rerun_of;
  return j;
}

Json status(const Status& v, bool valid) {
  return {{"outcome", to_string(v.outcome)}, {"detail", v.detail},           {"valid", valid},
          {"exit_code", v.exit_code},        {"started_utc", v.started_utc}, {"ended_utc", v.ended_utc}};
}

Json labels(const Labels& v) {
  Json j = {{"scene", v.scene},
            {"formulation", v.formulation},
            {"shape", v.shape},
            {"argument", v.argument},
            {"stiffness_policy", v.stiffness_policy},
            {"matching_rule", v.matching_rule},
            {"integrator", v.integrator},
            {"step_solver", v.step_solver},
            {"linear_solver", v.linear_solver},
            {"preconditioner", v.preconditioner},
            {"precision", v.precision},
            {"note", v.note}};
  put(j, "d_hat_m", v.d_hat_m);
  put(j, "dt_s", v.dt_s);
  return j;
}

Json scene(const SceneSize& v) {
  Json j = {{"vertices", v.vertices},      {"free_dofs", v.free_dofs}, {"triangles", v.triangles},
            {"springs", v.springs},        {"hinges", v.hinges},       {"obstacles", v.obstacles},
            {"mesh_sha256", v.mesh_sha256}};
  put(j, "extent_m", v.extent_m);
  return j;
}

Json provenance(const Provenance& v) {
  Json plugins = Json::array();
  for (const PluginFile& p : v.plugins) {
    plugins.push_back({{"name", p.name}, {"file", p.file}, {"sha256", p.sha256}});
  }
  return {{"tool_version", v.tool_version},
          {"git_commit", v.git_commit},
          {"git_dirty", v.git_dirty},
          {"compiler", v.compiler},
          {"flags", v.flags},
          {"build_type", v.build_type},
          {"fast_math", v.fast_math},
          {"fp_contract", v.fp_contract},
          {"libraries", v.libraries},
          {"plugins", plugins},
          {"argv", v.argv},
          {"env", v.env},
          {"threads", v.threads},
          {"blas",
           {{"kernel", v.blas.kernel},
            {"requested", v.blas.requested},
            {"config", v.blas.config},
            {"library", v.blas.library},
            {"threads", v.blas.threads}}},
          {"blas_threads", v.blas.threads}};
}

Json machine(const Machine& v) {
  return {{"cpu_model", v.cpu_model}, {"cores", v.cores},
          {"governor", v.governor},   {"load_avg", v.load_avg},
          {"mem_bytes", v.mem_bytes}, {"os", v.os},
          {"kernel", v.kernel},       {"virtualised", v.virtualised}};
}

Json stats(const Stats& v) {
  Json j = {{"n", v.n}};
  put(j, "min", v.min);
  put(j, "p05", v.p05);
  put(j, "median", v.median);
  put(j, "p95", v.p95);
  put(j, "max", v.max);
  put(j, "sum", v.sum);
  return j;
}

Json matching(const MatchingRecord& v) {
  Json j = {{"rule", v.rule},
            {"load_source", v.load_source},
            {"limit_load_source", v.limit_load_source},
            {"pilot_config_id", v.pilot_config_id},
            {"pilot_note", v.pilot_note},
            {"contact", v.contact},
            {"contacts_considered", v.contacts_considered},
            {"limit_element", v.limit_element},
            {"elements_considered", v.elements_considered}};
  put(j, "contact_step", v.contact_step);
  put(j, "limit_step", v.limit_step);
  put(j, "theta", v.theta);
  put(j, "load_N", v.load_N);
  put(j, "d_hat_m", v.d_hat_m);
  put(j, "limit_load_N_per_m", v.limit_load_N_per_m);
  put(j, "curvature_N_per_m", v.curvature_N_per_m);
  put(j, "limit_curvature", v.limit_curvature);
  put(j, "kappa_N_per_m", v.kappa_N_per_m);
  put(j, "limit_stiffness_N_per_m", v.limit_stiffness_N_per_m);
  put(j, "scale", v.scale);
  put(j, "limit_scale", v.limit_scale);
  put(j, "capacity_N", v.capacity_N);
  return j;
}

void put_step_contact(Json& j, const StepRecord& v) {
  j["contacts"] = fields::contacts(v.contacts);
  put(j, "gap_min_m", v.gap_min_m);
  put(j, "gap_min_rel", v.gap_min_rel);
  put(j, "gap_min_iterates_m", v.gap_min_iterates_m);
  put(j, "gap_min_iterates_rel", v.gap_min_iterates_rel);
  put(j, "toi_min", v.toi_min);
  put(j, "max_stretch", v.max_stretch);
  put(j, "kappa_min_N_per_m", v.kappa_min_N_per_m);
  put(j, "kappa_max_N_per_m", v.kappa_max_N_per_m);
  put(j, "contact_load_max_N", v.contact_load_max_N);
  put(j, "contact_load_sum_N", v.contact_load_sum_N);
  put(j, "limit_load_max_N_per_m", v.limit_load_max_N_per_m);
  put(j, "contact_overload", v.contact_overload);
  put(j, "limit_overload", v.limit_overload);
}

void put_step_energy(Json& j, const StepRecord& v) {
  put(j, "kinetic_J", v.kinetic_J);
  put(j, "elastic_J", v.elastic_J);
  put(j, "limit_J", v.limit_J);
  put(j, "contact_J", v.contact_J);
  put(j, "gravity_J", v.gravity_J);
}

Json step(const StepRecord& v) {
  Json j = {{"step", v.step},
            {"status", v.status},
            {"stop_reason", v.stop_reason},
            {"newton_iterations", v.newton_iterations},
            {"linear_iterations", v.linear_iterations},
            {"linear_solves", v.linear_solves},
            {"factorizations", v.factorizations},
            {"analyses", v.analyses},
            {"line_search_trials", v.line_search_trials},
            {"rounding_accepts", v.rounding_accepts},
            {"not_pd", v.not_pd},
            {"ccd_queries", v.ccd_queries},
            {"ccd_probes", v.ccd_probes},
            {"ccd_capped", v.ccd_capped},
            {"ccd_zero", v.ccd_zero},
            {"crossings", v.crossings},
            {"violations", v.violations},
            {"unproven", v.unproven},
            {"inverted", v.inverted}};
  put(j, "t_s", v.t_s);
  put_step_contact(j, v);
  put_step_energy(j, v);
  put(j, "wall_s", v.wall_s);
  put(j, "unaccounted_s", v.unaccounted_s);
  j["time"] = fields::phases(v.time);
  return j;
}

Json audit(const AuditRecord& v) {
  Json j = {{"enabled", v.enabled},
            {"edges", v.edges},
            {"triangles", v.triangles},
            {"vertices", v.vertices},
            {"obstacles", v.obstacles},
            {"states", v.states},
            {"motions", v.motions},
            {"state_pairs", v.state_pairs},
            {"motion_pairs", v.motion_pairs},
            {"obstacle_queries", v.obstacle_queries},
            {"judged", v.judged},
            {"crossings", v.crossings},
            {"touches", v.touches},
            {"violations", v.violations},
            {"unproven", v.unproven},
            {"inverted", v.inverted},
            {"obstacle_violations", v.obstacle_violations},
            {"scene_faults", v.scene_faults},
            {"first_bad_step", v.first_bad_step},
            {"first_bad_iteration", v.first_bad_iteration},
            {"examples", v.examples}};
  put(j, "time_s", v.seconds);
  return j;
}

Json validity(const Validity& v) {
  Json checks = Json::array();
  for (const Check& c : v.checks) {
    Json j = {{"name", c.name}};
    put(j, "value", c.value);
    put(j, "bound", c.bound);
    j["pass"] = c.pass;
    checks.push_back(j);
  }
  return {{"valid", v.valid}, {"checks", checks}};
}

Json conditioning(const Summary& v) {
  Json all = Json::object();
  for (const auto& [key, c] : v.cond) {
    all[key] = {{"log10_cond", stats(c.log10_cond)},
                {"log10_lambda_min", stats(c.log10_lambda_min)},
                {"log10_lambda_max", stats(c.log10_lambda_max)},
                {"statuses", c.statuses}};
  }
  return all;
}

Json stiffness(const StiffnessRecord& v) {
  Json j = {{"doublings", v.doublings}, {"saturated", v.saturated}};
  put(j, "kappa_start_N_per_m", v.kappa_start_N_per_m);
  put(j, "kappa_end_N_per_m", v.kappa_end_N_per_m);
  return j;
}

Json summary(const Summary& v) {
  Json j = {{"steps", v.steps},
            {"steps_capped", v.steps_capped},
            {"newton_iterations", v.newton_iterations},
            {"linear_iterations", v.linear_iterations},
            {"linear_solves", v.linear_solves},
            {"factorizations", v.factorizations},
            {"analyses", v.analyses},
            {"line_search_trials", v.line_search_trials},
            {"ccd_queries", v.ccd_queries},
            {"ccd_probes", v.ccd_probes},
            {"ccd_capped", v.ccd_capped},
            {"not_pd", v.not_pd},
            {"newton_per_step", stats(v.newton_per_step)},
            {"linear_per_solve", stats(v.linear_per_solve)},
            {"probe_pcg", stats(v.probe_pcg)},
            {"contacts", stats(v.contacts)},
            {"gap_min_rel", stats(v.gap_min_rel)}};
  put(j, "gap_min_m", v.gap_min_m);
  put(j, "gap_min_iterates_m", v.gap_min_iterates_m);
  put(j, "gap_min_iterates_rel", v.gap_min_iterates_rel);
  put(j, "max_stretch", v.max_stretch);
  put(j, "contact_load_max_N", v.contact_load_max_N);
  put(j, "limit_load_max_N_per_m", v.limit_load_max_N_per_m);
  j["first_contact"] = v.first_contact;
  j["stiffness"] = stiffness(v.stiffness);
  j["cond"] = conditioning(v);
  put(j, "wall_s", v.wall_s);
  put(j, "solve_s", v.solve_s);
  put(j, "unaccounted_s", v.unaccounted_s);
  j["time"] = fields::phases(v.time);
  j["peak_rss_bytes"] = v.peak_rss_bytes;
  j["state_hash"] = v.state_hash;
  return j;
}

Json samples(const RunRecord& r) {
  Json all = Json::object();
  for (const auto& [name, values] : r.samples) {
    Json list = Json::array();
    bool complete = true;
    for (double v : values) {
      list.push_back(std::isfinite(v) ? Json(v) : Json(nullptr));
      complete = complete && std::isfinite(v);
    }
    all[name] = list;
    if (!complete) all[name + "_status"] = "null entries are non-finite";
  }
  return all;
}

template <class List, class Make>
Json array_of(const List& list, Make make) {
  Json out = Json::array();
  for (const auto& v : list) out.push_back(make(v));
  return out;
}

}  // namespace

Json fields::comparability(const Comparability& v) {
  Json j = {{"verdict", v.verdict},
            {"reason", v.reason},
            {"reference_run", v.reference_run},
            {"reference_run_id", v.reference_run_id}};
  put(j, "gap_rel", v.gap_rel);
  put(j, "reference_gap_rel", v.reference_gap_rel);
  put(j, "ratio", v.ratio);
  put(j, "max_ratio", v.max_ratio);
  return j;
}

std::string to_json(const RunRecord& r) {
  Json j;
  j["schema"] = {{"name", "barrierbench.run"}, {"version", kRunSchemaVersion}};
  j["ids"] = ids(r.ids);
  j["status"] = status(r.status, r.validity.valid);
  j["labels"] = labels(r.labels);
  j["passes"] = {{"time", r.passes.time}, {"diagnose", r.passes.diagnose}, {"audit", r.passes.audit}};
  j["config"] = parse_config(r.config_json);
  j["scene"] = scene(r.scene);
  j["provenance"] = provenance(r.provenance);
  j["machine"] = machine(r.machine);
  j["plan"] = array_of(r.plan, [](const PlanLine& p) {
    return Json{{"item", p.item}, {"active", p.active}, {"reason", p.reason}};
  });
  j["skipped"] = array_of(r.skipped, [](const Skipped& s) {
    return Json{{"metric", s.metric}, {"reason", s.reason}};
  });
  j["matching"] = matching(r.matching);
  j["summary"] = summary(r.summary);
  j["steps"] = array_of(r.steps, step);
  j["samples"] = samples(r);
  j["audit"] = audit(r.audit);
  j["validity"] = validity(r.validity);
  j["comparability"] = fields::comparability(r.comparability);
  j["artifacts"] = array_of(r.artifacts, [](const Artifact& a) {
    return Json{{"path", a.path},
                {"kind", a.kind},
                {"media_type", a.media_type},
                {"sha256", a.sha256},
                {"bytes", a.bytes}};
  });
  fields::require_finite(j);
  // Bytes that are no UTF-8 (arguments, paths) are replaced: they must not cost the record.
  return j.dump(1, ' ', false, decltype(j)::error_handler_t::replace) + "\n";
}

}  // namespace bb
