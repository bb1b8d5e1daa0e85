// Of what the stiffness of a strain limit is made: the triangle at the start of the step, the gap of the iterate, and
// when either is read anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/terms/strain_limit.hpp"
#include "tests/terms/all_terms.hpp"

namespace bb::limit_stiffness_test {
namespace {

constexpr double dt = 0.05, c = 0.25, diagonal = 7;  // s, 1, N/m of the elastic matrix

/// Two limited triangles and their limit term, with an elastic matrix that is a multiple of the identity.
struct Limited {
  Scene scene = two_triangles();
  TermOptions options = test::term_options();
  std::vector<std::uint8_t> fixed = std::vector<std::uint8_t>(12, 0);
  BlockSystem blocks{4, fixed};
  BlockSystem::Values elastic;
  Positions no_gradient = Positions::Zero(3, 4);
  PhaseClock clock;
  StepFrame frame;
  exec::HostExecutor executor;
  std::unique_ptr<StrainLimitTerm> term;

  explicit Limited(std::unique_ptr<StiffnessPolicy> policy) {
    options.limit_stiffness = std::move(policy);
    blocks.set_elements({});
    elastic.assign(9 * 4, 0.0);
    for (std::size_t i = 0; i < elastic.size(); i += 9)
      elastic[i] = elastic[i + 4] = elastic[i + 8] = diagonal;
    term = std::make_unique<StrainLimitTerm>(executor, scene, options, fixed, false);
    term->set_matrix(blocks, elastic);
  }
  static Scene two_triangles() {
    SceneBuilder builder("limited", false, Vec3d::Zero(), "test");
    BodySpec body;
    body.name = "cloth";
    body.mesh = grid_mesh(2, 2, 1.0, 0.7);
    body.material.density = 0.3;
    body.material.youngs = 20;
    body.material.limit = StrainLimitSpec{0.01, 0.2};
    body.d_hat = 0.001;
    builder.add_body(body);
    return builder.finish();
  }
  void begin(const Positions& x_n) {
    frame.x_n = frame.x_tilde = x_n;
    frame.dt = dt, frame.c = c;
    term->begin_step(frame, clock);
  }
  /// Energies of the elements at an iterate, J.
  std::vector<double> linearised(const Positions& x) {
    term->linearise(x, {no_gradient, Projection::psd, clock});
    return term->families()[0].local.energy;
  }
};

using Rule = ElasticityInclusive;
using test::elastic_limit;

Rule rule_of(MassTerm mass_term, bool elastic_term, Refresh refresh) {
  return {.mass_term = mass_term, .elastic_term = elastic_term, .refresh = refresh};
}

/// Smaller pseudo-gap of every element.
std::vector<double> gaps_at(const Scene& scene, const Positions& x) {
  exec::HostExecutor executor;
  return limited_triangles({executor}, scene.limit, scene.rest, false)->smallest_gaps(x.data());
}

/// kappa of every element by the formula: w of x_n, the gap of `x_gap`; and the energy at x that it makes.
std::vector<double> by_hand(const Rule& rule, const Positions& x_n, const Positions& x_gap,
                            const Positions& x) {
  Limited unit(test::fixed_limit(1));  // kappa is the area
  unit.begin(x);
  std::vector<double> out = unit.linearised(x);
  const std::vector<double> y = gaps_at(unit.scene, x_gap);
  const Scene& scene = unit.scene;
  for (std::size_t e = 0; e < out.size(); ++e) {
    const std::array<int, 3>& v = scene.limit.triangles[e];
    const Vec3d centre = (x_n.col(v[0]) + x_n.col(v[1]) + x_n.col(v[2])) / 3;
    double length_sq = 0, inertia = 0;
    for (const int i : v) {
      length_sq += (x_n.col(i) - centre).squaredNorm();
      inertia +=
          scene.mass[static_cast<std::size_t>(i)] * (x_n.col(i) - centre).squaredNorm() / (c * dt * dt);
    }
    double kappa = rule.elastic_term ? diagonal * length_sq : 0;
    const double width = scene.limit.width[e];
    if (rule.mass_term == MassTerm::paper) kappa += scene.limit.mass[e] / (y[e] * y[e]);
    if (rule.mass_term == MassTerm::inertia) kappa += inertia;
    if (rule.mass_term == MassTerm::scaled) kappa += inertia * width * width / (y[e] * y[e]);
    EXPECT_GT(out[e], 0) << "the element is slack";
    const auto rest = [&](int i) -> Vec3d { return scene.rest.col(i); };
    const double area = 0.5 * (rest(v[1]) - rest(v[0])).cross(rest(v[2]) - rest(v[0])).norm();
    out[e] *= kappa / area;
  }
  return out;
}

void expect_near(const std::vector<double>& found, const std::vector<double>& expected, const char* what) {
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_FALSE(found.empty());
  for (std::size_t e = 0; e < found.size(); ++e) {
    EXPECT_GT(expected[e], 0) << what;
    EXPECT_NEAR(found[e], expected[e], 1e-9 * expected[e]) << what << " of element " << e;
  }
}

Positions stretched(double along, double across) {
  Positions x = Limited::two_triangles().rest;
  x.row(0) *= along;
  x.row(1) *= across;
  return x;
}

std::vector<Rule> rules(Refresh refresh) {
  std::vector<Rule> out;
  for (const MassTerm term : {MassTerm::paper, MassTerm::inertia, MassTerm::scaled, MassTerm::none}) {
    for (const bool elastic : {true, false}) {
      if (elastic || term != MassTerm::none) out.push_back(rule_of(term, elastic, refresh));
    }
  }
  return out;
}

/// Else the stiffness would follow the stretch that it is to limit.
TEST(LimitStiffness, IsOfTheTriangleAtTheStartOfTheStepInEveryIteration) {
  const Positions x_n = stretched(0.6, 1.02), first = stretched(1.05, 1.03), second = stretched(1.12, 0.9);
  for (const Rule& rule : rules(Refresh::per_iteration)) {
    Limited limited(elastic_limit(rule));
    limited.begin(x_n);
    expect_near(limited.linearised(first), by_hand(rule, x_n, first, first), "the first iterate");
    expect_near(limited.linearised(second), by_hand(rule, x_n, second, second), "the second iterate");
    limited.begin(second);
    expect_near(limited.linearised(first), by_hand(rule, second, first, first), "the next step");
  }
}

TEST(LimitStiffness, OncePerStepIsAlsoOfTheGapOfTheFirstIterate) {
  const Positions x_n = stretched(0.6, 1.02), first = stretched(1.05, 1.03), second = stretched(1.12, 0.9);
  for (const Rule& rule : rules(Refresh::per_step)) {
    Limited limited(elastic_limit(rule));
    limited.begin(x_n);
    expect_near(limited.linearised(first), by_hand(rule, x_n, first, first), "the first iterate");
    expect_near(limited.linearised(second), by_hand(rule, x_n, first, second), "the second iterate");
    limited.begin(first);
    expect_near(limited.linearised(second), by_hand(rule, first, second, second), "the next step");
  }
}

/// The smaller of the two gaps of an element is used, but none below the floor.
TEST(LimitStiffness, IsAskedAtTheFloorWhereTheGapIsSmaller) {
  const Positions x_n = stretched(1, 1), near_limit = stretched(1.2, 1), far = stretched(1.03, 1);
  Rule rule = rule_of(MassTerm::paper, false, Refresh::per_iteration);
  rule.gap_floor = 0.5;
  const Scene scene = Limited::two_triangles();
  const double floor = 0.5 * scene.limit.width[0];
  ASSERT_LT(gaps_at(scene, near_limit)[0], floor);
  ASSERT_GT(gaps_at(scene, far)[0], floor);
  Limited limited(elastic_limit(rule));
  limited.begin(x_n);
  expect_near(limited.linearised(far), by_hand(rule, x_n, far, far), "above the floor");
  std::vector<double> expected = by_hand(rule, x_n, near_limit, near_limit);
  const std::vector<double> y = gaps_at(scene, near_limit);
  for (std::size_t e = 0; e < expected.size(); ++e) expected[e] *= y[e] * y[e] / (floor * floor);
  expect_near(limited.linearised(near_limit), expected, "below the floor");
}

TEST(LimitStiffness, TheMultiplierActsOnAllOfIt) {
  const Positions x_n = stretched(0.9, 1), x = stretched(1.05, 1.02);
  for (const Rule& rule : rules(Refresh::per_iteration)) {
    Limited limited(elastic_limit(rule, 3));
    limited.begin(x_n);
    std::vector<double> expected = by_hand(rule, x_n, x, x);
    for (double& energy : expected) energy *= 3;
    expect_near(limited.linearised(x), expected, "three times");
  }
}

}  // namespace
}  // namespace bb::limit_stiffness_test
