// Numbers that decide which forces of a calibration run are loads, and how large its static load is: the answer of a row between
// those of its vertices, the answer of a strain limit against the state at rest, the weight of one free vertex.
#include <algorithm>
#include <cmath>

#include "core/exec/host_executor.hpp"
#include "core/terms/contact.hpp"
#include "tests/experiments/state_at_rest.hpp"

namespace bb::answer_decisions_test {
namespace {

using namespace test;

ContactTable one_row(const std::vector<int>& vertices, const std::vector<double>& weights) {
  ContactTable row;
  row.resize(1);
  row.vertex = {-1, -1, -1, -1};
  row.weight = {0, 0, 0, 0};
  for (std::size_t i = 0; i < vertices.size(); ++i) row.vertex[i] = vertices[i], row.weight[i] = weights[i];
  return row;
}

/// Vertices 0 to 3 whose forces answer by 0.1, 0.4, 0.9 and -0.2.
AnswerSums four_vertices() {
  AnswerSums out(5, 0);
  const double answers[] = {0.1, 0.4, 0.9, -0.2};
  for (int v = 0; v < 4; ++v) out.add_contact(one_row({v}, {1}), 0, 3.0 + v, answers[v]);
  return out;
}

TEST(AnswerDecisions, ARowAnswersAsItsVerticesDoByTheirWeights) {
  const AnswerSums sums = four_vertices();
  EXPECT_DOUBLE_EQ(sums.of_contact(one_row({1}, {1}), 0), 0.4);
  EXPECT_DOUBLE_EQ(sums.of_contact(one_row({0, 2}, {1, -1}), 0), 0.5);
  EXPECT_DOUBLE_EQ(sums.of_contact(one_row({0, 1}, {-0.25, 0.75}), 0), 0.25 * 0.1 + 0.75 * 0.4);
  // a point on a triangle, all free: weights of 1 and of three thirds
  const double third = 1.0 / 3;
  EXPECT_DOUBLE_EQ(sums.of_contact(one_row({3, 0, 1, 2}, {1, -third, -third, -third}), 0),
                   (-0.2 + (0.1 + 0.4 + 0.9) / 3) / 2);
  // prescribed vertices are not in the row: the rest counts whole
  EXPECT_DOUBLE_EQ(sums.of_contact(one_row({2}, {0.2}), 0), 0.9);
  EXPECT_EQ(sums.of_contact(one_row({4}, {1}), 0), 0);  // no force was added
  EXPECT_EQ(sums.of_contact(one_row({}, {}), 0), 0);
}

TEST(AnswerDecisions, ARowOfEqualAnswersHasThatAnswerWhateverItsWeights) {
  for (const double answer : {0.3, 0.5, 1.0}) {
    AnswerSums sums(4, 0);
    for (int v = 0; v < 4; ++v) sums.add_contact(one_row({v}, {0.7}), 0, 1.0 + v, answer);
    for (const double w : {0.1, 0.5, 1.0, 1.7}) {
      EXPECT_NEAR(sums.of_contact(one_row({0, 1, 2, 3}, {1, w - 1, -w, 0.3}), 0), answer, 1e-15) << w;
      EXPECT_NEAR(sums.of_contact(one_row({2, 3}, {w, -w}), 0), answer, 1e-15) << w;
    }
  }
}

/// A force counts in the answer of each of its vertices by its weight there.
TEST(AnswerDecisions, AForceCountsAtItsVerticesByItsWeights) {
  AnswerSums sums(2, 0);
  sums.add_contact(one_row({0, 1}, {0.25, -0.75}), 0, 8, 1);  // 2 N and 6 N that follow
  sums.add_contact(one_row({0}, {1}), 0, 2, 0);               // loads of 2 N each
  sums.add_contact(one_row({1}, {-1}), 0, 2, 0);
  EXPECT_DOUBLE_EQ(sums.of_contact(one_row({0}, {1}), 0), 0.5);
  EXPECT_DOUBLE_EQ(sums.of_contact(one_row({1}, {1}), 0), 0.75);
}

/// A curtain that hangs by its upper edge, in its limit where it bears most: a soft limit follows its stiffness, since
/// the membrane takes over; a stiff one carries the weight whatever its stiffness.
std::string curtain(double k_s) {
  return R"({"schema": "barrierbench.config/1", "scene": {"bodies": [
      {"name": "curtain", "material": {"youngs_N_per_m": 60, "density_kg_per_m2": 0.3, "bending_J": 1e-3},
       "transform": {"axis": [1, 0, 0], "angle_deg": 90}, "mesh": {"generator": "grid", "n_x": 3, "n_y": 5},
       "pins": [{"box_m": [[-1, -1, 0.2], [1, 1, 1]]}]}]},
    "formulation": {"name": "log", "d_hat_m": 0.01, "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 1}},
    "strain_limit": {"limit": 0.04, "shape": "log", "stiffness_policy": {"name": "fixed", "k_s_N_per_m": )" +
         std::to_string(k_s) +
         R"(}}, "integrator": {"name": "quasi_static"}, "matching": {"rule": "as_given"},
    "time": {"dt_s": 0.01, "steps": 1}, "step_solver": {"tol_velocity_m_per_s": 1e-8}})";
}

struct LimitAtRest {
  std::vector<double> force, answer;  // |dS/dsigma| over k_s, 1; 0 where the element is slack
};

LimitAtRest limit_at_rest(double k_s) {
  LimitAtRest out;
  at_rest(curtain(k_s), [&](const Scene& scene, const Positions& x, NewtonSystem& system, double dt) {
    const StrainLimitPart& part = scene.limit;
    exec::HostExecutor executor;
    const auto limit = limited_triangles({executor}, part, scene.rest, false);
    const StiffnessAnswers answers = answers_to_stiffness(system.diagnosis(), limit.get(), log_barrier(), dt);
    EXPECT_TRUE(answers.known);
    limit->measure(x.data());
    out.answer = answers.limit;
    for (std::size_t e = 0; e < part.width.size(); ++e) {
      const double y = limit->smallest_gap(e), width = part.width[e];
      out.force.push_back(y < width ? -k_s * log_barrier().eval(y, width).db : 0);
    }
  });
  return out;
}

/// The answers against what they stand for: the same curtain with 1 % more and less stiffness.
TEST(AnswerDecisions, ALimitAnswersByTheDerivativeOfItsForceAtRest) {
  double smallest = 1, largest = 0;
  int compared = 0;
  for (const double k_s : {0.1, 0.5, 2.0, 10.0, 50.0, 300.0}) {
    const LimitAtRest here = limit_at_rest(k_s), less = limit_at_rest(0.99 * k_s),
                      more = limit_at_rest(1.01 * k_s);
    ASSERT_EQ(here.answer.size(), here.force.size());
    for (std::size_t e = 0; e < here.force.size(); ++e) {
      EXPECT_TRUE(here.force[e] > 0 || here.answer[e] == 0) << "of a slack element";
      if (here.force[e] == 0 || less.force[e] == 0 || more.force[e] == 0) continue;
      const double slope = std::log(more.force[e] / less.force[e]) / std::log(1.01 / 0.99);
      EXPECT_NEAR(here.answer[e], slope, 0.02) << k_s << " " << e;
      smallest = std::min(smallest, here.answer[e]), largest = std::max(largest, here.answer[e]);
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
  EXPECT_LT(smallest, 0.2);  // both sides of the decision
  EXPECT_GT(largest, 0.6);
}

/// The weight over the free vertices: those of prescribed bodies carry none of it, however many there are.
TEST(AnswerDecisions, TheStaticLoadIsTheWeightOverTheFreeVertices) {
  const auto load = [](const std::string& given) {
    const std::string text = R"({"schema": "barrierbench.config/1", "scene": {"bodies": [
        {"name": "cloth", "limited": false, "mesh": {"generator": "grid", "n_x": 3, "n_y": 3},
         "material": {"density_kg_per_m2": 0.9}, "transform": {"translate_m": [0, 0, 1]})" +
                             given + R"(]},
      "formulation": {"name": "cubic", "d_hat_m": 0.01}, "matching": {"rule": "equal_force"},
      "time": {"dt_s": 0.01, "steps": 1}})";
    const RunConfig config = parsed(text.c_str(), {});
    const Scene scene = build_scene(config);
    const double contact = run_calibration(config, scene, {})->rest.contact;
    double mass = 0;
    int n_free = 0;
    for (int v = 0; v < scene.n_vertices(); ++v) {
      const bool prescribed_vertex =
          std::any_of(scene.pins.begin(), scene.pins.end(), [v](const Pin& pin) { return pin.vertex == v; });
      mass += prescribed_vertex ? 0 : scene.mass[static_cast<std::size_t>(v)];
      n_free += !prescribed_vertex;
    }
    EXPECT_NEAR(contact, mass * scene.gravity.norm() / n_free, 1e-12 * contact) << given;
    return contact;
  };
  const double alone = load("}");
  EXPECT_GT(alone, 0);
  for (const char* level : {"0", "2"}) {
    EXPECT_EQ(
        load(std::string(
                 R"(}, {"name": "ball", "kind": "rigid", "mesh": {"generator": "icosphere", "level": )") +
             level + R"(, "radius_m": 0.3}})"),
        alone)
        << level;
  }
  EXPECT_NE(load(R"(, "pins": [{"box_m": [[-1, -1, 0], [-0.49, 1, 2]]}]})"), alone);
}

}  // namespace
}  // namespace bb::answer_decisions_test
