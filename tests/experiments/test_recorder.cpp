// What a recorder makes of a simulation: each number against the state it is said to be of.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/newton/simulation.hpp"
#include "core/record/writer.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/recorder.hpp"
#include "experiments/run/step_record.hpp"
#include "tests/contact/contact_scenes.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb {
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
    ASSERT_EQ(step.status, "converged");
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
    EXPECT_NEAR(step.contact_J.value, kappa * 2 / (3 * d_hat) * y * y * y, 1e-12);
    EXPECT_NEAR(step.kinetic_J.value, 0.5 * mass * v * v, 1e-12);
    EXPECT_NEAR(step.gravity_J.value, mass * 10 * z, 1e-12);
    EXPECT_EQ(step.kappa_min_N_per_m.value, kappa);
    EXPECT_EQ(step.kappa_max_N_per_m.value, kappa);
    EXPECT_NEAR(step.t_s, dt * static_cast<double>(i + 1), 1e-15);
  }
}

TEST(Recorder, a_step_that_did_not_converge_has_no_gap_of_its_own) {
  const RecordedFall run(1, 1);
  const StepRecord& step = run.record.steps.at(0);
  ASSERT_EQ(step.status, "iteration_cap");
  EXPECT_STREQ(step.gap_min_m.status, "not_converged");
  EXPECT_STREQ(step.gap_min_rel.status, "not_converged");
  EXPECT_TRUE(step.gap_min_iterates_m.finite());
  EXPECT_FALSE(run.record.summary.gap_min_m.finite());
  EXPECT_EQ(run.record.summary.gap_min_rel.n, 0U);
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
  int iterations = 0, trials = 0;
  double largest = 0, contacts = 0;
  for (const StepRecord& step : run.record.steps) {
    iterations += step.newton_iterations;
    trials += step.line_search_trials;
    contacts += static_cast<double>(step.contacts.total());
    if (step.contact_load_max_N.finite()) largest = std::max(largest, step.contact_load_max_N.value);
  }
  EXPECT_EQ(summary.steps, 8);
  EXPECT_EQ(summary.steps_capped, 0);
  EXPECT_EQ(summary.newton_iterations, iterations);
  EXPECT_EQ(summary.newton_per_step.sum.value, iterations);
  EXPECT_EQ(summary.line_search_trials, trials);
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
  const double gap = contact_state(simulation.system().terms()).mollified.d.at(0);
  ASSERT_LT(gap, contact_state(simulation.system().terms()).rows.d.at(0));
  EXPECT_EQ(step.gap_min_m.value, gap);
  EXPECT_EQ(step.gap_min_rel.value, gap / d_hat);
  EXPECT_EQ(step.kappa_min_N_per_m.value, 10);
  EXPECT_EQ(step.kappa_max_N_per_m.value, 30);
}

TEST(Recorder, a_load_sum_counts_every_pair_of_a_merged_row) {
  Scene scene;
  const auto [vertices, triangles] = test::grid(2, 2, 1.0);
  test::add_body(scene, "plate", vertices, triangles, d_hat, true);
  test::add_body(scene, "particle", {Vec3d(1, 1, 0.5 * d_hat)}, {}, d_hat);
  Method method = test::fixed_method("cubic", kappa);
  Simulation simulation(scene, method, 1e-3, 1);
  StepObserver nobody;
  const StepReport report = simulation.step(nobody);
  ASSERT_EQ(contact_state(simulation.system().terms()).rows.multiplicity.at(0), 6);
  const StepRecord step = step_record(simulation.system(), report);
  EXPECT_GT(step.contact_load_max_N.value, 0);
  EXPECT_NEAR(step.contact_load_sum_N.value, 6 * step.contact_load_max_N.value, 1e-12);
}

/// Every number of an iteration, with a value of its own.
IterationReport numbered_iteration() {
  IterationReport report;
  report.step = 0;
  report.iteration = 4;
  report.energy = 1.5;
  report.energy_change = -2.5;
  report.grad_inf = 3.5;
  report.dx_inf = 4.5;
  report.decrement = 11;
  report.alpha = 0.5;
  report.alpha_ccd = 0.625;
  report.alpha_limit = 0.75;
  report.line_search_trials = 6;
  report.linear.iterations = 7;
  report.linear.residual_true = 8.5;
  report.linear.residual_recurrence = 9.5;
  report.linear.ritz_min = 10.5;
  report.linear.ritz_max = 11.5;
  report.contacts.obstacle = 2;
  report.gap_min = 12.5;
  report.gap_min_rel = 13.5;
  report.kappa_min = 14.5;
  report.kappa_max = 15.5;
  report.kappa_change = 16.5;
  report.curvature_max = 17.5;
  report.force_max = 18.5;
  report.limit_tension = 19.5;
  report.n_free = 20;
  report.nnz = 21;
  report.max_stretch = 1.0625;
  return report;
}

TEST(Recorder, a_trace_line_takes_every_number_from_its_own_field) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("barrierbench_trace_" + std::to_string(::getpid()));
  const Scene scene = test::particle_over_plane(mass, 0.5 * d_hat, d_hat);
  const RunConfig config = observed({"/passes/audit=false"});
  Method method = test::fixed_method("cubic", kappa);
  Simulation simulation(scene, method, dt, 1);
  StepObserver nobody;
  simulation.step(nobody);
  RunRecord record;
  {
    TraceWriter trace(folder);
    Recorder recorder(config, scene, record, &trace);
    recorder.on_iteration(numbered_iteration());
    StepReport report;
    report.t = 0.25;
    recorder.on_step(simulation.system(), report, scene.x0);
    trace.finish();
  }
  std::ifstream in(folder / "trace.jsonl");
  std::string line;
  ASSERT_TRUE(std::getline(in, line));
  const auto j = nlohmann::json::parse(line);
  std::filesystem::remove_all(folder);
  const std::vector<std::pair<const char*, double>> expected = {{"iteration", 4},
                                                                {"t_s", 0.25},
                                                                {"energy_J", 1.5},
                                                                {"energy_change_J", -2.5},
                                                                {"grad_inf_N", 3.5},
                                                                {"dx_inf_m", 4.5},
                                                                {"decrement_J", 5.5},
                                                                {"alpha", 0.5},
                                                                {"alpha_ccd", 0.625},
                                                                {"alpha_strain", 0.75},
                                                                {"line_search_trials", 6},
                                                                {"linear_iterations", 7},
                                                                {"residual_true", 8.5},
                                                                {"residual_recurrence", 9.5},
                                                                {"ritz_min", 10.5},
                                                                {"ritz_max", 11.5},
                                                                {"gap_min_iterates_m", 12.5},
                                                                {"gap_min_iterates_rel", 13.5},
                                                                {"kappa_min_N_per_m", 14.5},
                                                                {"kappa_max_N_per_m", 15.5},
                                                                {"kappa_change_rel", 16.5},
                                                                {"contact_curvature_max_N_per_m", 17.5},
                                                                {"contact_load_max_N", 18.5},
                                                                {"limit_load_max_N_per_m", 19.5},
                                                                {"n_free", 20},
                                                                {"nnz", 21},
                                                                {"max_stretch", 0.0625}};
  for (const auto& [key, value] : expected) EXPECT_EQ(j.at(key), value) << key;
  EXPECT_EQ(j.at("contacts").at("total"), 2);
}

/// Everything that is counted, with a number of its own.
StepReport counted_report() {
  StepReport report;
  report.step = 3;
  report.t = 0.25;
  report.status = StepStatus::step_collapse;
  report.detail = "held by a hair";
  report.iterations = 5;
  report.linear_iterations = 7;
  report.line_search_trials = 11;
  report.factorizations = 13;
  report.analyses = 17;
  report.accepted_by_rounding = 19;
  report.alpha_min = 0.125;
  report.alpha_ccd_min = 0.375;
  report.ccd_queries = 23;
  report.ccd_probes = 29;
  report.ccd_capped = 31;
  report.ccd_zero = 37;
  report.contacts.obstacle = 1;
  report.force_max = 41;
  report.limit_tension_max = 43;
  report.overload = 1.5;
  report.limit_overload = 2.5;
  report.max_stretch = 1.0625;
  report.kinetic_energy = 47;
  return report;
}

TEST(StepRecord, takes_every_number_from_its_own_field) {
  Scene scene = test::particle_over_plane(mass, 0.5 * d_hat, d_hat);
  Method method = test::fixed_method("cubic", kappa);
  Simulation simulation(scene, method, dt, 1);
  StepObserver nobody;
  simulation.step(nobody);
  const StepRecord step = step_record(simulation.system(), counted_report());
  EXPECT_EQ(step.step, 3);
  EXPECT_EQ(step.t_s, 0.25);
  EXPECT_EQ(step.status, "step_collapse");
  EXPECT_EQ(step.stop_reason, "held by a hair");
  EXPECT_EQ(step.newton_iterations, 5);
  EXPECT_EQ(step.linear_iterations, 7);
  EXPECT_EQ(step.linear_solves, 5);
  EXPECT_EQ(step.line_search_trials, 11);
  EXPECT_EQ(step.factorizations, 13);
  EXPECT_EQ(step.analyses, 17);
  EXPECT_EQ(step.rounding_accepts, 19);
  EXPECT_EQ(step.toi_min.value, 0.375);
  EXPECT_EQ(step.ccd_queries, 23);
  EXPECT_EQ(step.ccd_probes, 29);
  EXPECT_EQ(step.ccd_capped, 31);
  EXPECT_EQ(step.ccd_zero, 37);
  EXPECT_EQ(step.contacts.total(), 1U);
  EXPECT_EQ(step.contact_load_max_N.value, 41);
  EXPECT_EQ(step.contact_overload.value, 1.5);
  EXPECT_EQ(step.limit_overload.value, 2.5);
  EXPECT_EQ(step.max_stretch.value, 0.0625);
  EXPECT_STREQ(step.limit_load_max_N_per_m.status, "no_limit");  // this scene has none
  EXPECT_EQ(step.kinetic_J.value, 47);
}

TEST(StepRecord, says_why_an_overload_is_absent) {
  Scene scene = test::particle_over_plane(mass, 0.5 * d_hat, d_hat);
  Method method = test::fixed_method("cubic", kappa);
  Simulation simulation(scene, method, dt, 1);
  StepObserver nobody;
  simulation.step(nobody);
  StepReport report = counted_report();
  report.overload.reset();
  report.limit_overload.reset();
  const auto word = [&] {
    return std::string(step_record(simulation.system(), report).contact_overload.status);
  };
  EXPECT_EQ(word(), "not_measured");
  report.kappa_unsettled = 12;
  EXPECT_EQ(word(), "kappa_unsettled");
  report.status = StepStatus::converged;
  EXPECT_EQ(word(), "converged");
}

}  // namespace
}  // namespace bb
