// Which forces of a calibration run are loads: those that stay when barriers get stiffer. Forces of pieces between prescribed bodies do
// not, and a match leaves them out.
#include "experiments/run/stiffness_answer.hpp"

#include <cmath>

#include "core/terms/contact.hpp"
#include "tests/experiments/state_at_rest.hpp"

namespace bb::stiffness_answer_test {
namespace {

using namespace test;

/// A piece of cloth between two given boxes, 0.6 mm from each where d_hat is 5 mm.
const std::string piece = R"(
  {"name": "lower", "kind": "rigid", "transform": {"translate_m": [3, 0, 0.9494]},
   "mesh": {"generator": "box", "n": 1, "size_x_m": 0.5, "size_y_m": 0.5, "size_z_m": 0.1}},
  {"name": "upper", "kind": "rigid", "transform": {"translate_m": [3, 0, 1.0506]},
   "mesh": {"generator": "box", "n": 1, "size_x_m": 0.5, "size_y_m": 0.5, "size_z_m": 0.1}},
  {"name": "piece", "limited": false, "transform": {"translate_m": [3, 0, 1]},
   "mesh": {"generator": "grid", "n_x": 2, "n_y": 2, "size_x_m": 0.2, "size_y_m": 0.2}})";

/// A sheet of n x n squares that falls 1 mm into the support of the floor's barrier, and comes to rest.
std::string sheet(int n) {
  return R"({"name": "resting", "limited": false, "transform": {"translate_m": [0, 0, 0.006]},
    "mesh": {"generator": "grid", "n_x": )" +
         std::to_string(n) + R"(, "n_y": )" + std::to_string(n) + "}}";
}

std::string scene_of(const std::string& bodies) {
  return R"({"schema": "barrierbench.config/1", "scene": {"bodies": [)" + bodies +
         R"(], "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}]},
    "formulation": {"name": "cubic", "d_hat_m": 0.005}, "matching": {"rule": "equal_force"},
    "time": {"dt_s": 0.01, "steps": 20}})";
}

TEST(StiffnessAnswer, AMatchTakesTheLoadOfTheSheetAndNotTheForceOfThePinch) {
  for (const int n : {3, 8}) {
    const Calibrated both = calibrated(scene_of(piece + "," + sheet(n)).c_str());
    const Calibrated alone = calibrated(scene_of(sheet(n)).c_str());
    EXPECT_NE(both.record.contact.find("resting["), std::string::npos) << both.record.contact;
    EXPECT_LT(std::abs(both.record.contact_answer.value), 0.05);
    EXPECT_NEAR(*both.calibration.kappa / *alone.calibration.kappa, 1, 0.05) << n;
    EXPECT_NEAR(both.record.load_N.value / alone.record.load_N.value, 1, 0.05) << n;
    EXPECT_GT(both.record.contacts_left_out, 100);
    EXPECT_GT(both.record.left_out_N.value, 1.2 * both.record.load_N.value);  // else it would decide nothing
    EXPECT_NE(both.record.left_out_contact.find("piece["), std::string::npos) << both.record.left_out_contact;
    EXPECT_NE(both.record.pilot_note.find("no loads"), std::string::npos) << both.record.pilot_note;
    EXPECT_EQ(alone.record.contacts_left_out, 0);
    EXPECT_EQ(alone.record.left_out_contact, "");
    EXPECT_FALSE(alone.record.left_out_N.finite());
    EXPECT_EQ(alone.record.pilot_note, "");
  }
}

TEST(StiffnessAnswer, WhereNoForceIsALoadTheStaticWeightStandsIn) {
  const Calibrated fixed = calibrated(scene_of(piece).c_str());
  EXPECT_EQ(fixed.record.load_source, "static_weight");
  EXPECT_EQ(fixed.record.contacts_considered, 0);
  EXPECT_GT(fixed.record.contacts_left_out, 100);
  EXPECT_EQ(fixed.record.contact, "");
  EXPECT_NEAR(*fixed.calibration.kappa * slope("cubic", 0.0005, 0.005) / fixed.record.load_N.value, 1, 1e-12);
  const Calibrated own = calibrated(
      scene_of(piece).c_str(),
      {R"(/formulation/stiffness_policy={"name": "elasticity_inclusive", "mass_term": "inertia"})"});
  EXPECT_EQ(own.calibration.scale, 1);
  EXPECT_FALSE(own.record.scale.finite());
  EXPECT_NE(own.record.pilot_note.find(
                "the contact policy stays as given: no force of the calibration run is a load"),
            std::string::npos)
      << own.record.pilot_note;
}

/// What the world makes is left alone: weight, impact, a bounce.
TEST(StiffnessAnswer, NothingIsLeftOutWhereBodiesFallAndRest) {
  for (const char* text : {block, falling, two_masses}) {
    const Calibrated c = calibrated(text);
    EXPECT_GT(c.record.contacts_considered, 10);
    EXPECT_EQ(c.record.contacts_left_out, 0) << c.record.left_out_contact;
    EXPECT_LT(std::abs(c.record.contact_answer.value), 0.1);
  }
}

/// A cloth, two sides of which are held at 0.6 d_hat over a floor, so stiff that it sags by less than that: where kappa is
/// small its tension carries it, and its forces follow kappa; where kappa is large they are its weight.
std::string held(double kappa) {
  return R"({"schema": "barrierbench.config/1", "scene": {"bodies": [
      {"name": "cloth", "limited": false, "material": {"youngs_N_per_m": 1e6},
       "transform": {"translate_m": [0, 0, 0.006]}, "mesh": {"generator": "grid", "n_x": 6, "n_y": 6},
       "pins": [{"box_m": [[-1, -1, -1], [-0.49, 1, 1]]}, {"box_m": [[0.49, -1, -1], [1, 1, 1]]}]}],
      "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}]},
    "formulation": {"name": "log", "d_hat_m": 0.01, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": )" +
         std::to_string(kappa) +
         R"(}}, "integrator": {"name": "quasi_static"}, "matching": {"rule": "as_given"},
    "time": {"dt_s": 0.01, "steps": 1}, "step_solver": {"tol_velocity_m_per_s": 1e-8}})";
}

struct ContactsAtRest {
  std::vector<double> force, answer;  // N, 1: of every contact
  std::vector<ContactKey> key;
};

ContactsAtRest contacts_at_rest(double kappa) {
  ContactsAtRest out;
  at_rest(held(kappa), [&](const Scene&, const Positions&, NewtonSystem& system, double dt) {
    const StiffnessAnswers answers = answers_to_stiffness(system.diagnosis(), nullptr, log_barrier(), dt);
    EXPECT_TRUE(answers.known);
    const ContactTable& rows = contact_state(system.diagnosis().terms()).rows;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      out.force.push_back(-rows.kappa[r] * rows.db[r]);
      out.answer.push_back(answers.contact[r]);
      out.key.push_back(rows.key(r));
    }
  });
  return out;
}

/// The answers against what they stand for: the same state at rest with 1 % more and less stiffness.
TEST(StiffnessAnswer, IsTheDerivativeOfTheForceAtRest) {
  double smallest = 1, largest = 0;
  std::size_t compared = 0;
  for (const double kappa : {0.01, 0.3, 10.0, 300.0}) {
    const ContactsAtRest here = contacts_at_rest(kappa), less = contacts_at_rest(0.99 * kappa),
                         more = contacts_at_rest(1.01 * kappa);
    ASSERT_EQ(less.key, here.key);
    ASSERT_EQ(more.key, here.key);
    for (std::size_t r = 0; r < here.key.size(); ++r) {
      const double slope = std::log(more.force[r] / less.force[r]) / std::log(1.01 / 0.99);
      EXPECT_NEAR(here.answer[r], slope, 0.01) << kappa << " " << r;
      smallest = std::min(smallest, here.answer[r]), largest = std::max(largest, here.answer[r]);
      ++compared;
    }
  }
  EXPECT_GT(compared, 40U);
  EXPECT_LT(smallest, 0.2);  // both sides of the decision
  EXPECT_GT(largest, 0.8);
}

}  // namespace
}  // namespace bb::stiffness_answer_test
