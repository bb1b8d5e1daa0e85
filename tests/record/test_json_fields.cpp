// Every number of a record stands under its own name: each field gets a value of its own and is looked up
// again.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/record/writer.hpp"
#include "tests/record/sample_record.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// Hands out 1.5, 2.5, ... to fields and remembers their keys.
class Distinct {
 public:
  template <class Field>
  void operator()(const char* key, Field& field) {
    const double value = next_++ + 0.5;
    field = static_cast<Field>(value);
    expected_.emplace_back(key, json(field));
  }
  void operator()(const char* key, Number& field) {
    field = Number(next_++ + 0.5);
    expected_.emplace_back(key, json(field.value));
  }
  void expect_in(const json& j) const {
    ASSERT_FALSE(expected_.empty());
    for (const auto& [key, value] : expected_) {
      ASSERT_TRUE(j.contains(key)) << key;
      EXPECT_EQ(j.at(key), value) << key;
    }
  }

 private:
  double next_ = 1;
  std::vector<std::pair<std::string, json>> expected_;
};

json written(const RunRecord& record) { return json::parse(to_json(record)); }

TEST(JsonFields, OfAStep) {
  RunRecord record = test::sample_record();
  StepRecord& step = record.steps.at(0);
  Distinct fill;
  fill("step", step.step);
  fill("t_s", step.t_s);
  fill("newton_iterations", step.newton_iterations);
  fill("linear_iterations", step.linear_iterations);
  fill("linear_solves", step.linear_solves);
  fill("factorizations", step.factorizations);
  fill("analyses", step.analyses);
  fill("line_search_trials", step.line_search_trials);
  fill("rounding_accepts", step.rounding_accepts);
  fill("ccd_queries", step.ccd_queries);
  fill("ccd_probes", step.ccd_probes);
  fill("ccd_capped", step.ccd_capped);
  fill("ccd_zero", step.ccd_zero);
  fill("crossings", step.crossings);
  fill("violations", step.violations);
  fill("unproven", step.unproven);
  fill("inverted", step.inverted);
  fill("gap_min_m", step.gap_min_m);
  fill("gap_min_rel", step.gap_min_rel);
  fill("gap_min_iterates_m", step.gap_min_iterates_m);
  fill("gap_min_iterates_rel", step.gap_min_iterates_rel);
  fill("toi_min", step.toi_min);
  fill("max_stretch", step.max_stretch);
  fill("kappa_min_N_per_m", step.kappa_min_N_per_m);
  fill("kappa_max_N_per_m", step.kappa_max_N_per_m);
  fill("contact_load_max_N", step.contact_load_max_N);
  fill("contact_load_sum_N", step.contact_load_sum_N);
  fill("limit_load_max_N_per_m", step.limit_load_max_N_per_m);
  fill("contact_overload", step.contact_overload);
  fill("limit_overload", step.limit_overload);
  fill("kinetic_J", step.kinetic_J);
  fill("elastic_J", step.elastic_J);
  fill("limit_J", step.limit_J);
  fill("contact_J", step.contact_J);
  fill("gravity_J", step.gravity_J);
  fill("wall_s", step.wall_s);
  fill("unaccounted_s", step.unaccounted_s);
  fill.expect_in(written(record)["steps"][0]);
}

TEST(JsonFields, OfTheSummary) {
  RunRecord record = test::sample_record();
  Summary& summary = record.summary;
  Distinct fill;
  fill("steps", summary.steps);
  fill("steps_capped", summary.steps_capped);
  fill("newton_iterations", summary.newton_iterations);
  fill("linear_iterations", summary.linear_iterations);
  fill("linear_solves", summary.linear_solves);
  fill("factorizations", summary.factorizations);
  fill("analyses", summary.analyses);
  fill("line_search_trials", summary.line_search_trials);
  fill("ccd_queries", summary.ccd_queries);
  fill("ccd_probes", summary.ccd_probes);
  fill("ccd_capped", summary.ccd_capped);
  fill("gap_min_m", summary.gap_min_m);
  fill("gap_min_iterates_m", summary.gap_min_iterates_m);
  fill("gap_min_iterates_rel", summary.gap_min_iterates_rel);
  fill("max_stretch", summary.max_stretch);
  fill("contact_load_max_N", summary.contact_load_max_N);
  fill("limit_load_max_N_per_m", summary.limit_load_max_N_per_m);
  fill("wall_s", summary.wall_s);
  fill("solve_s", summary.solve_s);
  fill("unaccounted_s", summary.unaccounted_s);
  fill("peak_rss_bytes", summary.peak_rss_bytes);
  Distinct stiffness;
  stiffness("kappa_start_N_per_m", summary.stiffness.kappa_start_N_per_m);
  stiffness("kappa_end_N_per_m", summary.stiffness.kappa_end_N_per_m);
  stiffness("doublings", summary.stiffness.doublings);
  const json j = written(record)["summary"];
  fill.expect_in(j);
  stiffness.expect_in(j["stiffness"]);
}

TEST(JsonFields, OfOrderStatisticsAndConditioning) {
  RunRecord record = test::sample_record();
  const auto fill_stats = [](Distinct& fill, Stats& stats) {
    fill("n", stats.n);
    fill("min", stats.min);
    fill("p05", stats.p05);
    fill("median", stats.median);
    fill("p95", stats.p95);
    fill("max", stats.max);
    fill("sum", stats.sum);
  };
  Distinct newton;
  fill_stats(newton, record.summary.newton_per_step);
  Summary::Conditioning& cond = record.summary.cond["full/none"];
  cond.log10_cond = summarize({3});
  cond.log10_lambda_min = summarize({-1});
  cond.log10_lambda_max = summarize({2});
  record.summary.linear_per_solve = summarize({11});
  record.summary.probe_pcg = summarize({12});
  record.summary.contacts = summarize({13});
  record.summary.gap_min_rel = summarize({14});
  const json j = written(record)["summary"];
  newton.expect_in(j["newton_per_step"]);
  EXPECT_EQ(j["cond"]["full/none"]["log10_cond"]["min"], 3);
  EXPECT_EQ(j["cond"]["full/none"]["log10_lambda_min"]["min"], -1);
  EXPECT_EQ(j["cond"]["full/none"]["log10_lambda_max"]["min"], 2);
  EXPECT_EQ(j["linear_per_solve"]["min"], 11);
  EXPECT_EQ(j["probe_pcg"]["min"], 12);
  EXPECT_EQ(j["contacts"]["min"], 13);
  EXPECT_EQ(j["gap_min_rel"]["min"], 14);
}

TEST(JsonFields, OfMatchingAndAudit) {
  RunRecord record = test::sample_record();
  MatchingRecord& matching = record.matching;
  Distinct fill;
  fill("theta", matching.theta);
  fill("load_N", matching.load_N);
  fill("d_hat_m", matching.d_hat_m);
  fill("limit_load_N_per_m", matching.limit_load_N_per_m);
  fill("curvature_N_per_m", matching.curvature_N_per_m);
  fill("limit_curvature", matching.limit_curvature);
  fill("kappa_N_per_m", matching.kappa_N_per_m);
  fill("limit_stiffness_N_per_m", matching.limit_stiffness_N_per_m);
  fill("scale", matching.scale);
  fill("limit_scale", matching.limit_scale);
  fill("capacity_N", matching.capacity_N);
  AuditRecord& audit = record.audit;
  Distinct judged;
  judged("edges", audit.edges);
  judged("triangles", audit.triangles);
  judged("vertices", audit.vertices);
  judged("obstacles", audit.obstacles);
  judged("state_pairs", audit.state_pairs);
  judged("motion_pairs", audit.motion_pairs);
  judged("obstacle_queries", audit.obstacle_queries);
  judged("judged", audit.judged);
  judged("obstacle_violations", audit.obstacle_violations);
  judged("scene_faults", audit.scene_faults);
  judged("states", audit.states);
  judged("motions", audit.motions);
  judged("crossings", audit.crossings);
  judged("touches", audit.touches);
  judged("violations", audit.violations);
  judged("unproven", audit.unproven);
  judged("inverted", audit.inverted);
  judged("first_bad_step", audit.first_bad_step);
  const json j = written(record);
  fill.expect_in(j["matching"]);
  judged.expect_in(j["audit"]);
}

TEST(JsonFields, OfComparability) {
  RunRecord record = test::sample_record();
  Comparability& found = record.comparability;
  found.reference_run = "log-0123";
  found.reference_run_id = "id";
  Distinct fill;
  fill("gap_rel", found.gap_rel);
  fill("reference_gap_rel", found.reference_gap_rel);
  fill("ratio", found.ratio);
  fill("max_ratio", found.max_ratio);
  const json j = written(record)["comparability"];
  fill.expect_in(j);
  EXPECT_EQ(j["verdict"], found.verdict);
  EXPECT_EQ(j["reason"], found.reason);
  EXPECT_EQ(j["reference_run"], "log-0123");
  EXPECT_EQ(j["reference_run_id"], "id");
}

TEST(JsonFields, TheStatusIsThatOfTheChecks) {
  RunRecord record = test::sample_record();
  for (const bool valid : {false, true}) {
    record.validity.valid = valid;
    const json j = written(record);
    EXPECT_EQ(j["status"]["valid"], valid);
    EXPECT_EQ(j["validity"]["valid"], valid);
  }
  record.validity.checks = {{"a", 1.5, 2.5, true}};
  const json check = written(record)["validity"]["checks"][0];
  EXPECT_EQ(check["value"], 1.5);
  EXPECT_EQ(check["bound"], 2.5);
  EXPECT_EQ(check["pass"], true);
}

TEST(JsonFields, ABareNumberThatIsNotFiniteIsRefused) {
  for (const double value : {std::nan(""), -std::numeric_limits<double>::infinity()}) {
    RunRecord record = test::sample_record();
    record.machine.load_avg[1] = value;
    EXPECT_THROW(to_json(record), std::logic_error);
  }
}

TEST(JsonFields, OfATraceLine) {
  TraceRow row;
  Distinct fill;
  fill("step", row.step);
  fill("iteration", row.iteration);
  fill("t_s", row.t_s);
  fill("energy_J", row.energy_J);
  fill("energy_change_J", row.energy_change_J);
  fill("grad_inf_N", row.grad_inf_N);
  fill("dx_inf_m", row.dx_inf_m);
  fill("decrement_J", row.decrement_J);
  fill("alpha", row.alpha);
  fill("alpha_ccd", row.alpha_ccd);
  fill("alpha_strain", row.alpha_strain);
  fill("line_search_trials", row.line_search_trials);
  fill("linear_iterations", row.linear_iterations);
  fill("residual_true", row.residual_true);
  fill("residual_recurrence", row.residual_recurrence);
  fill("ritz_min", row.ritz_min);
  fill("ritz_max", row.ritz_max);
  fill("probe_pcg_iterations", row.probe_pcg_iterations);
  fill("gap_min_iterates_m", row.gap_min_iterates_m);
  fill("gap_min_iterates_rel", row.gap_min_iterates_rel);
  fill("n_free", row.n_free);
  fill("nnz", row.nnz);
  fill("kappa_min_N_per_m", row.kappa_min_N_per_m);
  fill("kappa_max_N_per_m", row.kappa_max_N_per_m);
  fill("kappa_change_rel", row.kappa_change_rel);
  fill("limit_kappa_change_rel", row.limit_kappa_change_rel);
  fill("limit_gap_min_rel", row.limit_gap_min_rel);
  fill("contact_curvature_max_N_per_m", row.contact_curvature_max_N_per_m);
  fill("contact_load_max_N", row.contact_load_max_N);
  fill("max_stretch", row.max_stretch);
  fill("limit_load_max_N_per_m", row.limit_load_max_N_per_m);
  Distinct kinds;
  kinds("point_point", row.contacts.point_point);
  kinds("point_edge", row.contacts.point_edge);
  kinds("point_triangle", row.contacts.point_triangle);
  kinds("edge_edge", row.contacts.edge_edge);
  kinds("obstacle", row.contacts.obstacle);
  kinds("mollified", row.contacts.mollified);
  ConditionSample sample;
  Distinct estimate;
  estimate("tier", sample.tier);
  estimate("lambda_min", sample.estimate.lambda_min);
  estimate("lambda_max", sample.estimate.lambda_max);
  estimate("cond", sample.estimate.cond);
  estimate("solves", sample.estimate.solves);
  estimate("products", sample.estimate.products);
  estimate("factorizations", sample.estimate.factorizations);
  estimate("residual", sample.estimate.residual);
  estimate("time_s", sample.estimate.seconds);
  row.cond = {sample};
  const json j = json::parse(to_json(row));
  fill.expect_in(j);
  kinds.expect_in(j["contacts"]);
  EXPECT_EQ(j["contacts"]["total"], row.contacts.total());
  estimate.expect_in(j["cond"][0]);
}

}  // namespace
}  // namespace bb
