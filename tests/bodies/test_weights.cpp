// Weight groups of a body: which vertices pins take, stiffnesses of pulls over time, factors on stiffnesses, and what is refused.
#include <gtest/gtest.h>

#include "core/energy/families/families.hpp"
#include "tests/bodies/bodies.hpp"
#include "tests/energy/host_family.hpp"

namespace bb::weights_test {
namespace {

using namespace test;

/// 12 vertices; a rises with the number of the vertex, b is 1 at the last four.
BodySpec weighted(const std::string& name = "cloth") {
  BodySpec body = cloth(name);
  std::vector<double> a, b;
  for (int v = 0; v < body.mesh.n_vertices(); ++v) a.push_back(v / 16.0), b.push_back(v >= 8);
  body.weights = {{"a", a}, {"b", b}};
  return body;
}

PinSpec pin_of(std::vector<WeightShare> mix) {
  PinSpec pin;
  pin.mix = std::move(mix);
  return pin;
}

std::string refusal(const std::function<void(BodySpec&)>& change) {
  BodySpec body = weighted();
  change(body);
  return complaint({body});
}

void expect_refusal(const std::function<void(BodySpec&)>& change, const std::string& found,
                    const std::string& allowed) {
  const std::string said = refusal(change);
  EXPECT_NE(said.find(found), std::string::npos) << said;
  EXPECT_NE(said.find(allowed), std::string::npos) << said;
}

TEST(Weights, select_the_vertices_of_a_pin_from_a_threshold_on) {
  BodySpec body = weighted();
  body.pins = {pin_of({{"a", 1, {}}})};
  ASSERT_EQ(body.mesh.n_vertices(), 12);
  body.pins[0].threshold = 0.5;
  body.pins[0].indices = {3};
  const Scene scene = scene_of({cloth("before", 1), body});
  const int first = scene.bodies[1].first_vertex;
  std::vector<int> found;
  for (const Pin& pin : scene.pins) found.push_back(pin.vertex - first);
  EXPECT_EQ(found, (std::vector<int>{3, 8, 9, 10, 11}));  // 8/16 is the threshold
}

TEST(Weights, multiply_the_stiffness_of_each_pulled_vertex_over_time) {
  BodySpec body = weighted();
  body.pins = {pin_of({{"a", 0.5, {}}, {"b", 1, {{0, 0}, {4, 1}}}})};
  body.pins[0].pull = 40;
  body.pins[0].pull_factors = {{0, 1}, {4, 0.5}};
  const Scene scene = scene_of({cloth("before", 1), body});
  ASSERT_EQ(scene.pulls.size(), 1U);
  const int first = scene.bodies[1].first_vertex;
  ASSERT_EQ(scene.pulls[0].vertices.size(), 11U);  // vertex 0 is in no group
  HostFamily family([&](const FamilyPlace& place) { return pull_family(place, scene); });
  Positions x = scene.x0;
  x.row(0).array() += 0.1;
  for (const double t : {0.0, 1.0, 3.0}) {
    family->change_step({.dt = 0.01, .t_end = t});
    const std::vector<double> energy = family.values(x);
    for (int v = 1; v < 12; ++v) {
      const double weight = std::min(0.5 * v / 16 + (v >= 8 ? t / 4 : 0), 1.0);
      EXPECT_NEAR(energy[static_cast<std::size_t>(v - 1)], 40 * (1 - t / 8) * weight * 0.01 / 2, 1e-15)
          << t << v;
      EXPECT_EQ(scene.pulls[0].vertices[static_cast<std::size_t>(v - 1)], first + v);
    }
  }
}

TEST(Weights, of_a_pull_select_nothing_where_something_else_does) {
  BodySpec body = weighted();
  body.pins = {pin_of({{"b", 1, {}}})};
  body.pins[0].pull = 40;
  body.pins[0].indices = {2, 9};
  const Scene scene = scene_of({body});
  EXPECT_EQ(scene.pulls[0].vertices, (std::vector<int>{2, 9}));
  EXPECT_EQ(scene.pulls[0].weights.at(0), (std::vector<double>{0, 1}));
}

/// Of a body with every kind of stiffness, element by element.
TEST(Weights, are_factors_on_stiffnesses_of_elements) {
  BodySpec plain = weighted();
  plain.material.bending = 2, plain.material.bending_exponential = 3, plain.material.springs = 5;
  plain.material.cloth_tension = 7, plain.material.cloth_compression = 11, plain.material.cloth_shear = 13;
  BodySpec body = plain;
  body.stiffness_weights = {{StiffnessKind::membrane, {{"a", 1, {}}}, 0.5, 4},
                            {StiffnessKind::hinges, {{"a", 1, {}}}, 0, 2},
                            {StiffnessKind::springs, {{"a", 1, {}}}, 1, 0.25}};
  const Scene before = scene_of({plain}), after = scene_of({body});
  std::size_t compared = 0;
  const auto expect = [&](const auto& elements, const std::vector<double>& was, const std::vector<double>& is,
                          double low, double high) {
    ASSERT_EQ(was.size(), elements.size());
    ASSERT_EQ(is.size(), elements.size());
    for (std::size_t e = 0; e < elements.size(); ++e) {
      double mean = 0;
      for (const int v : elements[e]) mean += v / 16.0 / static_cast<double>(elements[e].size());
      EXPECT_NEAR(is[e], was[e] * (low + (high - low) * mean), 1e-13 * was[e]);
      compared += is[e] != was[e];
    }
  };
  const MembranePart &was = before.membranes[0], &is = after.membranes[0];
  expect(is.triangles, was.lame_mu, is.lame_mu, 0.5, 4);
  expect(is.triangles, was.lame_lambda, is.lame_lambda, 0.5, 4);
  expect(after.hinges.hinges, before.hinges.stiffness, after.hinges.stiffness, 0, 2);
  expect(after.hinges.hinges, before.hinges.exponential, after.hinges.exponential, 0, 2);
  expect(after.springs.edges, before.springs.stiffness, after.springs.stiffness, 1, 0.25);
  const ClothSpringPart &sides = before.cloth_springs, &scaled = after.cloth_springs;
  expect(scaled.pairs, sides.tension, scaled.tension, 1, 0.25);
  expect(scaled.pairs, sides.compression, scaled.compression, 1, 0.25);
  EXPECT_GT(compared, 50U);
}

TEST(Weights, refuse_what_they_cannot_mean) {
  EXPECT_EQ(refusal([](BodySpec&) {}), "");
  expect_refusal([](BodySpec& b) { b.weights[0].weight[7] = 1.5; }, "1.5 of vertex 7", "a number in [0, 1]");
  expect_refusal([](BodySpec& b) { b.weights[1].weight.pop_back(); }, "11 numbers", "12, one a vertex");
  expect_refusal([](BodySpec& b) { b.weights[1].name = "a"; }, "a name used twice", "one group a name");
  expect_refusal([](BodySpec& b) { b.pins = {pin_of({{"c", 1, {}}})}; }, "the weight group \"c\"", "a, b");
  expect_refusal(
      [](BodySpec& b) {
        b.pins = {pin_of({{"a", 1, {}}})};
      },
      "weights of vertices that are prescribed", "threshold");
  expect_refusal(
      [](BodySpec& b) {
        b.pins = {pin_of({{"a", 1, {{0, 0}}}})}, b.pins[0].threshold = 0.5;
      },
      "influences that change", "constant ones");
  expect_refusal(
      [](BodySpec& b) {
        b.pins = {pin_of({{"a", 1, {}}})}, b.pins[0].threshold = 0;
      },
      "/pins/threshold", "a number in (0, 1]");
  expect_refusal([](BodySpec& b) { b.pins = {pin_of({})}, b.pins[0].all = true, b.pins[0].threshold = 1; },
                 "a threshold of no weights", "mix");
  expect_refusal([](BodySpec& b) { b.pins = {pin_of({{"a", 2, {}}})}; }, "/pins/mix/influence", "[-1, 1]");
  expect_refusal(
      [](BodySpec& b) {
        b.pins = {pin_of({{"a", 1, {{1, 0}, {1, 1}}}})}, b.pins[0].pull = 1;
      },
      "time 1 after 1", "times that increase");
  expect_refusal(
      [](BodySpec& b) {
        b.pressure_mix = {{"a", 1, {}}};
      },
      "weights of no pressure", "pressure_Pa");
  const auto stiffness = [](StiffnessKind of, std::vector<WeightShare> mix, double low = 0) {
    return [=](BodySpec& b) { b.stiffness_weights.push_back({of, mix, low, 1}); };
  };
  expect_refusal(stiffness(StiffnessKind::hinges, {{"a", 1, {}}}), "a stiffness that the material has not",
                 "not 0");
  expect_refusal(stiffness(StiffnessKind::membrane, {}), "no group", "at least one");
  expect_refusal(stiffness(StiffnessKind::membrane, {{"a", 1, {}}}, -1), "-1", "factors >= 0");
  expect_refusal(stiffness(StiffnessKind::membrane, {{"a", 1, {{0, 1}}}}), "influences that change",
                 "stiffnesses stay");
}

/// Plasticity is a rate, and has something that it is of.
TEST(Plasticity, leaves_its_share_after_its_step_whatever_the_steps_are) {
  Material m;
  EXPECT_EQ(m.creep_rate(0), 0);
  EXPECT_EQ(m.creep_rate(3), 3);
  m.plasticity = 0.25, m.plasticity_step = 0.04;
  EXPECT_NEAR(std::exp(-m.creep_rate(0) * 0.04), 0.75, 1e-15);
  EXPECT_NEAR(std::exp(-m.creep_rate(0) * 0.08), 0.75 * 0.75, 1e-15);
  m.plasticity = 1;
  EXPECT_EQ(std::exp(-m.creep_rate(0) * 1e-9), 0);
}

TEST(Plasticity, is_a_rate_of_triangles_hinges_and_springs_of_cloth) {
  BodySpec body = cloth("cloth");
  body.material.plasticity = 0.5, body.material.plasticity_step = 0.1;
  body.material.membrane_yield = 0.01, body.material.bending = 1, body.material.bending_yield = 0.2;
  body.material.cloth_tension = 1, body.material.cloth_yield = 0.02;
  const Scene scene = scene_of({body});
  const double rate = std::log(2.0) / 0.1;
  for (const auto* creep : {&scene.membranes[0].creep, &scene.hinges.creep, &scene.cloth_springs.creep}) {
    ASSERT_FALSE(creep->empty());
    for (const double r : *creep) EXPECT_NEAR(r, rate, 1e-14 * rate);
  }
  EXPECT_EQ(scene.membranes[0].yield[0], 0.01);
}

TEST(Plasticity, is_refused_beside_creep_and_where_nothing_follows) {
  const auto plastic = [](const std::function<void(Material&)>& change) {
    return [change](BodySpec& b) { b.material.plasticity = 0.5, change(b.material); };
  };
  expect_refusal(plastic([](Material& m) { m.membrane_creep = 1; }), "/material/plasticity",
                 "membrane_creep_per_s");
  expect_refusal(plastic([](Material& m) { m.bending = 1, m.bending_creep = 1; }), "/material/plasticity",
                 "bending_creep_per_s");
  expect_refusal(plastic([](Material& m) { m.cloth_tension = 1, m.cloth_creep = 1; }), "/material/plasticity",
                 "cloth_creep_per_s");
  expect_refusal(plastic([](Material& m) { m.model = "none", m.springs = 1; }), "/material/plasticity",
                 "no rest shape follows");
  expect_refusal([](BodySpec& b) { b.material.plasticity_step = 1; }, "/material/plasticity_step_s",
                 "nothing without plasticity");
  expect_refusal([](BodySpec& b) { b.material.membrane_yield = 1; }, "/material/membrane_yield",
                 "or plasticity");
}

}  // namespace
}  // namespace bb::weights_test
