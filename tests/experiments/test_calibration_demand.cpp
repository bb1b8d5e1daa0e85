// What is required of a calibration run's contacts, on calibration runs that are written down: ties, sides of every threshold, first and last
// steps.
#include "experiments/run/calibration_demand.hpp"

#include <algorithm>

#include "core/base/record/phase_times.hpp"
#include "core/math/error.hpp"
#include "tests/experiments/calibrated.hpp"

namespace bb::calibration_demand_test {
namespace {

using namespace test;

constexpr double d_hat = 0.01;

/// A cloth of 3 x 3 vertices over a floor: its vertex v is at the height that each step gives it.
const std::string config_text = R"({"schema": "barrierbench.config/1",
  "scene": {"bodies": [{"name": "cloth", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}, "transform": {"translate_m": [0, 0, 1]}}],
            "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}]},
  "formulation": {"name": "log", "d_hat_m": 0.01, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 2}},
  "matching": {"rule": "as_given"}, "time": {"dt_s": 0.01, "steps": 1}})";

using Heights = std::vector<double>;  // of the vertices, in units of d_hat; 9 numbers

struct Written {
  RunConfig config = parsed(config_text.c_str(), {});
  Scene scene = build_scene(config);
  CalibrationRun calibration_run;

  explicit Written(const std::vector<Heights>& steps) {
    calibration_run.config = config;
    calibration_run.stiffness.kappa = 2;
    calibration_run.x.push_back(scene.x0);
    for (const Heights& heights : steps) {
      Positions x = scene.x0;
      for (int v = 0; v < 9; ++v) x(2, v) = heights.at(static_cast<std::size_t>(v)) * d_hat;
      calibration_run.x.push_back(x);
      calibration_run.c.push_back(1);
    }
    calibration_run.answers = AnswerSums(9, 0);
  }
  /// A force of the vertex that answers so.
  void answer(int vertex, double value, double force = 1) {
    ContactTable row;
    row.resize(1);
    row.vertex = {vertex, -1, -1, -1};
    row.weight = {1, 0, 0, 0};
    calibration_run.answers.add_contact(row, 0, force, value);
  }
  Demand ask(const MatchedStiffness& matched, const StiffnessPolicy* own = nullptr) const {
    return contact_demand(calibration_run, scene, matched, own, 0.1);
  }
};

const MatchedStiffness of_load = [](double load, double) { return load; };
const MatchedStiffness constant = [](double, double) { return 1.0; };

double load_at(double u) { return 2 * slope("log", u * d_hat, d_hat); }

/// All heights 1 (no row) but those that are named.
Heights only(std::initializer_list<std::pair<int, double>> set) {
  Heights out(9, 1.0);
  for (const auto& [vertex, height] : set) out.at(static_cast<std::size_t>(vertex)) = height;
  return out;
}

TEST(CalibrationDemand, IsNotAskedAnyMoreWhenTimeIsOver) {
  const Written written({only({{2, 0.6}}), only({{1, 0.3}})});
  const RunLimits over{nullptr, now_s(), 3}, in_time{nullptr, now_s() + 1000, 1000};
  EXPECT_EQ(contact_demand(written.calibration_run, written.scene, of_load, nullptr, 0.1, in_time).considered,
            2);
  try {
    contact_demand(written.calibration_run, written.scene, of_load, nullptr, 0.1, over);
    ADD_FAILURE() << "the loads are compared to the end";
  } catch (const TimeOver& time) {
    EXPECT_EQ(time.detail,
              "calibration run: the time limit of 3 s was reached while the loads of its step 0 of 2 were "
              "compared; there "
              "was no first step");
  }
}

TEST(CalibrationDemand, AmongEqualDemandsTheLargerLoadIsNamedAndOfEqualLoadsTheFirst) {
  const Written written({only({{2, 0.6}, {4, 0.6}}), only({{1, 0.3}, {3, 0.7}}), only({{0, 0.3}, {5, 0.3}})});
  for (const MatchedStiffness& matched : {constant, of_load}) {
    const Demand demand = written.ask(matched);
    EXPECT_EQ(demand.considered, 6);
    EXPECT_EQ(demand.step, 1);
    EXPECT_EQ(demand.where, "obstacle: floor, cloth[1]");
    EXPECT_NEAR(demand.load, load_at(0.3), 1e-12);
    EXPECT_EQ(demand.width, d_hat);
    EXPECT_NEAR(demand.largest, matched(load_at(0.3), d_hat), 1e-12);
  }
}

TEST(CalibrationDemand, TheLargestDemandIsFoundInTheFirstAndInTheLastStep) {
  for (const int step : {0, 1, 2}) {
    std::vector<Heights> steps(3, only({{4, 0.8}}));
    steps.at(static_cast<std::size_t>(step)) = only({{8, 0.2}});
    const Demand demand = Written(steps).ask(of_load);
    EXPECT_EQ(demand.step, step);
    EXPECT_EQ(demand.where, "obstacle: floor, cloth[8]");
  }
}

TEST(CalibrationDemand, AContactAtDHatHasNoLoadAndOneJustBelowItHas) {
  EXPECT_EQ(Written({only({})}).ask(of_load).considered, 0);
  EXPECT_EQ(Written({only({{3, 0.999}})}).ask(of_load).considered, 1);
  EXPECT_EQ(Written(std::vector<Heights>()).ask(of_load).considered, 0);
}

/// The force of vertex 1 is the largest, that of 2 the next.
TEST(CalibrationDemand, AForceIsALoadUpToAnAnswerOfOneHalf) {
  for (const double answer : {0.5, 0.501}) {
    Written written({only({{1, 0.2}, {2, 0.3}, {3, 0.9}}), only({{7, 0.25}, {3, 0.9}})});
    written.answer(1, answer);
    written.answer(2, -3);  // what falls with kappa is a load that others take over
    written.answer(7, answer);
    const Demand demand = written.ask(of_load);
    const bool load = answer == 0.5;
    EXPECT_EQ(demand.where, load ? "obstacle: floor, cloth[1]" : "obstacle: floor, cloth[2]");
    EXPECT_NEAR(demand.load, load_at(load ? 0.2 : 0.3), 1e-12);
    EXPECT_EQ(demand.answer, load ? 0.5 : -3);
    EXPECT_EQ(demand.considered, load ? 5 : 3);
    EXPECT_EQ(demand.left_out, load ? 0 : 2);
    if (load) continue;
    EXPECT_EQ(demand.left_out_where, "obstacle: floor, cloth[1]");
    EXPECT_EQ(demand.left_out_step, 0);
    EXPECT_NEAR(demand.left_out_load, load_at(0.2), 1e-12);
  }
}

/// The answers of a vertex count with its forces: many small ones that swing do not hide a large one, nor make one.
TEST(CalibrationDemand, TheAnswerOfAVertexIsThatOfTheSumOfItsForces) {
  for (const double force : {0.5, 1.01}) {
    Written written({only({{1, 0.2}})});
    written.answer(1, 1, force);
    written.answer(1, -1, 0.5);
    written.answer(1, 0.5, 0.5);
    written.answer(1, 0.25, 1 - 0.5);
    written.answer(1, 0.5, 1);
    const double sum = force + 0.5 + 0.5 + 0.5 + 1;
    const Demand demand = written.ask(of_load);
    EXPECT_EQ(demand.left_out, 0);
    EXPECT_NEAR(demand.answer, (force - 0.5 + 0.25 + 0.125 + 0.5) / sum, 1e-12);
    written.answer(1, 1, 10);
    EXPECT_EQ(written.ask(of_load).left_out, 1);
  }
}

/// Another number for each row by its gap, so that the place of evaluation shows.
class Soft final : public StiffnessPolicy {
 public:
  Soft(double at_d_hat, double below) : at_d_hat_(at_d_hat), below_(below) {}
  std::string_view name() const override { return "soft"; }
  Refresh refresh() const override { return Refresh::per_iteration; }
  void fill(const StiffnessBatch& rows, double* kappa) const override {
    for (std::size_t r = 0; r < rows.n; ++r)
      kappa[r] = rows.d[r] < 0.999 * rows.d_hat[r] ? below_ : at_d_hat_;
  }

 private:
  double at_d_hat_, below_;
};

TEST(CalibrationDemand, APolicyIsAskedAtDHatAndBelowAndTheSofterCounts) {
  const Written written({only({{1, 0.5}})});
  const Soft falling_off(4, 2), growing(2, 4);
  EXPECT_DOUBLE_EQ(written.ask(constant, &falling_off).largest, 0.5);
  EXPECT_DOUBLE_EQ(written.ask(constant, &growing).largest, 0.5);
}

TEST(CalibrationDemand, APolicyThatIsSofterThanABillionthGivesNoStiffness) {
  const Written written({only({{1, 0.5}})});
  const Soft enough(1.001e-9, 1), none(0.999e-9, 1), zero(0, 0);
  EXPECT_NEAR(written.ask(constant, &enough).largest, 1e9 / 1.001, 1);
  EXPECT_THROW(written.ask(constant, &none), ConfigError);
  EXPECT_THROW(written.ask(constant, &zero), ConfigError);
  try {
    written.ask(constant, &none);
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("cloth[1], which carries a load in step 0"), std::string::npos)
        << error.what();
  }
}

/// A contact that is left out is not evaluated for a stiffness of its own either.
TEST(CalibrationDemand, APolicyIsNotAskedForAForceThatIsNoLoad) {
  Written written({only({{1, 0.5}})});
  written.answer(1, 0.9);
  const Soft none(0, 0);
  EXPECT_EQ(written.ask(constant, &none).considered, 0);
  EXPECT_EQ(written.ask(constant, &none).left_out, 1);
}

/// A config with retries is matched by the calibration run without: it ends where a step fails.
TEST(CalibrationRun, DoesNotRetryAStepThatFails) {
  const std::string cubic = R"(/formulation={"name": "cubic", "d_hat_m": 0.01})";
  const std::string later = "/scene/bodies/1/transform/translate_m=[3, 0, 0.08]",
                    capped = "/step_solver/max_iterations=4";
  const Calibrated once = calibrated(two_masses, {cubic, later, capped});
  const Calibrated retried = calibrated(two_masses, {cubic, later, capped, "/step_solver/retries=4"});
  EXPECT_NE(once.record.pilot_note.find("iteration_cap"), std::string::npos) << once.record.pilot_note;
  EXPECT_EQ(retried.record.pilot_note, once.record.pilot_note);
  EXPECT_GT(retried.record.contacts_considered, 0);
  EXPECT_EQ(retried.record.contacts_considered, once.record.contacts_considered);
  EXPECT_EQ(*retried.calibration.kappa, *once.calibration.kappa);
}

TEST(CalibrationRun, WhoseFirstStepFailsLeavesTheStaticWeight) {
  const Calibrated c = calibrated(
      two_masses, {R"(/formulation={"name": "cubic", "d_hat_m": 0.01})",
                   "/scene/bodies/0/transform/translate_m=[0, 0, 0.009]", "/step_solver/max_iterations=1"});
  EXPECT_NE(c.record.pilot_note.find("the calibration run stopped at step 0"), std::string::npos)
      << c.record.pilot_note;
  EXPECT_EQ(c.record.contacts_considered, 0);
  EXPECT_EQ(c.record.load_source, "static_weight");
  EXPECT_GT(c.record.load_N.value, 0);
}

}  // namespace
}  // namespace bb::calibration_demand_test
