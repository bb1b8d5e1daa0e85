// What a recorder makes of a simulation: each number against the state that it describes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/record/writer.hpp"
#include "core/step_solvers/simulation.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/recorder.hpp"
#include "tests/contact/contact_scenes.hpp"
#include "tests/newton/small_scenes.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::recorder_test {
namespace {

constexpr double mass = 0.2, d_hat = 0.04, kappa = 400, dt = 0.01;

/// The passes of this config, nothing else of it, decide what a recorder does.
RunConfig observed(const std::vector<std::string>& overrides = {}) {
  return parse_config(
      R"({"schema": "barrierbench.config/1", "scene": {"name": "hang"}, "formulation": "log"})", "test", ".",
      overrides);
}

/// A particle that falls on the plane from `height` with 1 m/s, and bounces back: in contact the smallest gap
/// of a step is not that of its end.
struct RecordedFall {
  Scene scene = test::particle_over_plane(mass, 0.9 * d_hat, d_hat);
  RunConfig config = observed({"/passes/audit=false"});
  RunRecord record;
  std::vector<Positions> ends;

  explicit RecordedFall(int steps, int max_iterations = 200) {
    scene.v0(2, 0) = -1;
    Method method = test::fixed_method("cubic", kappa);
    method.step_solver.max_iterations = max_iterations;
    Simulation simulation(scene, method, dt, steps);
    Recorder recorder(config, scene, record, nullptr);
    for (int i = 0; i < steps; ++i) {
      simulation.step(recorder);
      ends.push_back(simulation.history().x);
    }
    recorder.finish();
  }
};

TEST(Recorder, the_gap_of_a_step_is_that_of_its_end_in_metres_and_in_d_hat) {
  const RecordedFall run(8);
  ASSERT_EQ(run.record.steps.size(), 8U);
  double smallest = 1;
  int touching = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const StepRecord& step = run.record.steps[i];
    const double z = run.ends[i](2, 0);
    ASSERT_EQ(step.status, StepStatus::converged);
    if (z >= d_hat) {
      EXPECT_FALSE(step.gap_min_m.finite()) << i;
      continue;
    }
    ++touching;
    smallest = std::min(smallest, z);
    EXPECT_EQ(step.gap_min_m.value, z) << i;
    EXPECT_EQ(step.gap_min_rel.value, z / d_hat) << i;
  }
  ASSERT_GT(touching, 2);
  EXPECT_EQ(run.record.summary.gap_min_m.value, smallest);
  EXPECT_EQ(run.record.summary.gap_min_rel.min.value, smallest / d_hat);
}

TEST(Recorder, the_load_and_the_energies_of_a_step_are_those_of_its_end) {
  const RecordedFall run(3);
  ASSERT_EQ(run.record.steps.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const StepRecord& step = run.record.steps[i];
    const double z = run.ends[i](2, 0), before = i == 0 ? run.scene.x0(2, 0) : run.ends[i - 1](2, 0);
    ASSERT_LT(z, d_hat);
    const double y = d_hat - z, v = (z - before) / dt;
    EXPECT_NEAR(step.contact_load_max_N.value, kappa * 2 / d_hat * y * y, 1e-12);
    EXPECT_NEAR(step.contact_load_sum_N.value, kappa * 2 / d_hat * y * y, 1e-12);
    EXPECT_NEAR(step.contact_J, kappa * 2 / (3 * d_hat) * y * y * y, 1e-12);
    EXPECT_NEAR(step.kinetic_J, 0.5 * mass * v * v, 1e-12);
    EXPECT_NEAR(step.gravity_J, mass * 10 * z, 1e-12);
    EXPECT_EQ(step.kappa_min_N_per_m.value, kappa);
    EXPECT_EQ(step.kappa_max_N_per_m.value, kappa);
    EXPECT_NEAR(step.t_s, dt * static_cast<double>(i + 1), 1e-15);
  }
}

TEST(Recorder, the_gaps_of_a_pair_are_weighted_by_its_loads) {
  const RecordedFall run(3);
  double sum = 0, least = 1, most = 0, time = 0;
  for (const StepRecord& step : run.record.steps) {
    ASSERT_EQ(step.status, StepStatus::converged);
    time += step.dt_s;
    sum += step.contact_load_sum_N.value * step.dt_s;
    least = std::min(least, step.gap_min_rel.value), most = std::max(most, step.gap_min_rel.value);
  }
  ASSERT_EQ(run.record.summary.contact_gaps.size(), 1U);
  const PairGaps& pair = run.record.summary.contact_gaps.begin()->second;
  EXPECT_GT(pair.load_N, 0);
  EXPECT_NEAR(pair.load_N, sum / time, 1e-12 * pair.load_N);
  EXPECT_EQ(pair.load_share, 1);
  EXPECT_EQ(pair.time_share, 1);
  EXPECT_GT(pair.gap_rel_p05, least * 0.989);
  EXPECT_LT(pair.gap_rel_p95, most * 1.011);
  EXPECT_LE(pair.gap_rel_p05, pair.gap_rel_median);
  EXPECT_LE(pair.gap_rel_median, pair.gap_rel_p95);
}

TEST(Recorder, a_step_that_did_not_converge_has_no_gap_of_its_own) {
  const RecordedFall run(1, 1);
  const StepRecord& step = run.record.steps.at(0);
  ASSERT_EQ(step.status, StepStatus::iteration_cap);
  EXPECT_STREQ(step.gap_min_m.status, "not_converged");
  EXPECT_STREQ(step.gap_min_rel.status, "not_converged");
  EXPECT_TRUE(step.gap_min_iterates_m.finite());
  EXPECT_FALSE(run.record.summary.gap_min_m.finite());
  EXPECT_EQ(run.record.summary.gap_min_rel.n, 0U);
  EXPECT_TRUE(run.record.summary.contact_gaps.empty());
  EXPECT_GT(step.contact_load_max_N.value, 0);  // else the line above shows nothing
  EXPECT_EQ(run.record.summary.steps_capped, 1);
}

TEST(Recorder, the_smallest_gap_over_iterates_is_that_of_each_step_alone) {
  const RecordedFall run(8);
  const auto& steps = run.record.steps;
  double smallest = 1;
  for (const StepRecord& step : steps) {
    if (step.gap_min_iterates_m.finite()) smallest = std::min(smallest, step.gap_min_iterates_m.value);
    if (step.gap_min_m.finite()) {
      EXPECT_LE(step.gap_min_iterates_m.value, step.gap_min_m.value);
    }
  }
  EXPECT_EQ(run.record.summary.gap_min_iterates_m.value, smallest);
  EXPECT_NEAR(run.record.summary.gap_min_iterates_rel.value, smallest / d_hat, 1e-15);
  // the particle has bounced off: its last contact is farther away than the closest one
  const auto last =
      std::find_if(steps.rbegin(), steps.rend(), [](const StepRecord& s) { return s.gap_min_m.finite(); });
  ASSERT_NE(last, steps.rend());
  EXPECT_GT(last->gap_min_iterates_m.value, smallest);
}

TEST(Recorder, the_summary_sums_its_steps_and_keeps_the_largest_load) {
  const RecordedFall run(8);
  const Summary& summary = run.record.summary;
  int iterations = 0;
  WorkCounts work;
  double largest = 0, contacts = 0;
  for (const StepRecord& step : run.record.steps) {
    iterations += step.newton_iterations;
    work += step;
    contacts += static_cast<double>(step.contacts.total());
    if (step.contact_load_max_N.finite()) largest = std::max(largest, step.contact_load_max_N.value);
  }
  EXPECT_EQ(summary.steps, 8);
  EXPECT_EQ(summary.steps_capped, 0);
  EXPECT_EQ(summary.newton_iterations, iterations);
  EXPECT_EQ(summary.newton_per_step.sum.value, iterations);
  for_each_field<WorkCounts>(
      [&](const FieldText& field, auto count) { EXPECT_EQ(summary.*count, work.*count) << field.name; });
  EXPECT_GT(work.line_search_trials, 8);
  EXPECT_EQ(summary.contacts.sum.value, contacts);
  EXPECT_EQ(summary.contact_load_max_N.value, largest);
  ASSERT_GT(largest, run.record.steps[0].contact_load_max_N.value);
}

/// Two rods that cross at an angle of 0.04 with a gap of d_hat/4, and a particle over a plane with one of
/// d_hat/2 and another kappa.
TEST(Recorder, the_closest_row_and_the_range_of_kappa_are_of_both_tables) {
  class TwoKappas final : public StiffnessPolicy {
   public:
    std::string_view name() const override { return "two_kappas"; }
    Refresh refresh() const override { return Refresh::per_iteration; }
    void fill(const StiffnessBatch& rows, double* value) const override {
      for (std::size_t r = 0; r < rows.n; ++r) value[r] = rows.n_free[r] == 1 ? 10 : 30;
    }
  };
  Scene scene;
  test::add_body(scene, "rod", {Vec3d(-0.5, 0, 5), Vec3d(0.5, 0, 5)}, {}, d_hat);
  test::add_body(scene, "other", {Vec3d(-0.5, -0.01, 5 + 0.25 * d_hat), Vec3d(0.5, 0.01, 5 + 0.25 * d_hat)},
                 {}, d_hat);
  scene.surface_edges = {{0, 1}, {2, 3}};
  test::add_body(scene, "particle", {Vec3d(0, 0, 0.5 * d_hat)}, {}, d_hat);
  Obstacle plane;
  plane.name = "floor";
  scene.obstacles = {plane};
  Method method = test::fixed_method("cubic", 1);
  method.stiffness = std::make_unique<TwoKappas>();
  const RunConfig config = observed({"/passes/audit=false"});
  RunRecord record;
  Simulation simulation(scene, method, 1e-3, 1);
  Recorder recorder(config, scene, record, nullptr);
  const StepReport report = simulation.step(recorder);
  ASSERT_EQ(report.status, StepStatus::converged);
  ASSERT_EQ(report.contacts.mollified, 1U);
  ASSERT_EQ(report.contacts.obstacle, 1U);
  const StepRecord& step = record.steps.at(0);
  const double gap = contact_state(simulation.system().diagnosis().terms()).mollified.d.at(0);
  ASSERT_LT(gap, contact_state(simulation.system().diagnosis().terms()).rows.d.at(0));
  EXPECT_EQ(step.gap_min_m.value, gap);
  EXPECT_EQ(step.gap_min_rel.value, gap / d_hat);
  EXPECT_EQ(step.kappa_min_N_per_m.value, 10);
  EXPECT_EQ(step.kappa_max_N_per_m.value, 30);
}

TEST(Recorder, a_load_sum_counts_every_pair_of_one_feature) {
  Scene scene;
  const auto [vertices, triangles] = test::grid(2, 2, 1.0);
  test::add_body(scene, "plate", vertices, triangles, d_hat, true);
  test::add_body(scene, "particle", {Vec3d(1, 1, 0.5 * d_hat)}, {}, d_hat);
  Method method = test::fixed_method("cubic", kappa);
  Simulation simulation(scene, method, 1e-3, 1);
  StepObserver nobody;
  const StepReport report = simulation.step(nobody);
  ASSERT_EQ(contact_state(simulation.system().diagnosis().terms()).rows.size(), 6U);
  EXPECT_GT(report.contact_load_max_N.value, 0);
  EXPECT_NEAR(report.contact_load_sum_N.value, 6 * report.contact_load_max_N.value, 1e-12);
}

/// Hands everything on and keeps the iterations.
struct Both final : StepObserver {
  Both(Recorder& to, std::vector<IterationReport>& kept) : recorder(to), reports(kept) {}
  void on_matrix(StepSystem& system, int step, int iteration) override {
    recorder.on_matrix(system, step, iteration);
  }
  void on_iteration(const IterationReport& report) override {
    reports.push_back(report);
    recorder.on_iteration(report);
  }
  void on_step(StepSystem& system, const StepReport& report, const Positions& x) override {
    recorder.on_step(system, report, x);
  }
  Recorder& recorder;
  std::vector<IterationReport>& reports;
};

TEST(Recorder, a_trace_line_is_the_iteration_that_newton_reported) {
  const test::TemporaryFolder folder;
  Scene scene = test::particle_over_plane(mass, 0.9 * d_hat, d_hat);
  scene.v0(2, 0) = -1;
  Method method = test::fixed_method("cubic", kappa);
  const RunConfig config = observed({"/passes/audit=false", "/passes/diagnose=true", "/diagnose/pcg=false"});
  RunRecord record;
  std::vector<IterationReport> reports;
  {
    TraceWriter trace(folder);
    Recorder recorder(config, scene, record, &trace);
    Both both(recorder, reports);
    Simulation simulation(scene, method, dt, 2);
    simulation.step(both), simulation.step(both);
    trace.finish();
  }
  std::ifstream in(folder / "trace.jsonl");
  std::size_t n = 0;
  for (std::string line; std::getline(in, line); ++n) {
    const auto j = nlohmann::json::parse(line);
    const IterationReport& report = reports.at(n);
    EXPECT_EQ(j.at("iteration"), report.iteration);
    EXPECT_EQ(j.at("t_s"), dt * (report.step + 1));
    EXPECT_EQ(j.at("alpha"), report.alpha);
    EXPECT_EQ(j.at("alpha_ccd"), report.alpha_ccd);
    EXPECT_EQ(j.at("linear_solves"), 1);
    EXPECT_EQ(j.at("contacts").at("obstacle"), report.contacts.obstacle);
    EXPECT_GT(report.decrement_J, 0);
    EXPECT_EQ(j.at("decrement_J"), report.decrement_J);
    EXPECT_EQ(j.at("cond").size(), 3U);  // one stage of this scene, three scalings
  }
  EXPECT_GT(n, 3U);
  EXPECT_EQ(n, reports.size());
}

/// The config has PCG and the method a direct solver, which leaves no Ritz values to read.
TEST(Recorder, an_estimate_without_a_value_is_counted_and_is_no_condition_number) {
  const Scene scene = test::particle_over_plane(mass, 0.9 * d_hat, d_hat);
  Method method = test::fixed_method("cubic", kappa);
  const RunConfig config = observed(
      {"/passes/audit=false", "/passes/diagnose=true", "/diagnose/pcg=false", "/diagnose/estimator=ritz",
       R"(/linear_solver={"name": "pcg", "preconditioner": "block_jacobi", "forcing": "fixed"})"});
  RunRecord record;
  Recorder recorder(config, scene, record, nullptr);
  Simulation simulation(scene, method, dt, 1);
  simulation.step(recorder);
  recorder.finish();
  const Conditioning& cond = record.summary.cond.at("full/block_jacobi");
  EXPECT_EQ(cond.statuses.at("not_converged"), record.summary.newton_iterations);
  EXPECT_EQ(cond.log10_cond.n, 0U);
  EXPECT_EQ(cond.log10_lambda_min.n, 0U);
}

}  // namespace
}  // namespace bb::recorder_test
