// The strain limit of tetrahedra on an executor against the term of the CPU path, alone and beside limited triangles.
#include <cmath>

#include "core/model/mesh/solid_generators.hpp"
#include "tests/executor/limit_rules.hpp"
#include "tests/executor/on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec_solid_limit_test {
namespace {

using namespace bb::test;
// Of sums over elements, and of barriers whose logarithms are those of another library; singular values are the same bits.
constexpr double rounding = 1e-12;

/// A block whose limit acts where it is strained(), and a cloth beside it.
Scene limited_scene(bool with_cloth) {
  SceneBuilder builder("limited", false, Vec3d(0, 0, -10), "test");
  if (with_cloth) {
    BodySpec cloth;
    cloth.name = "cloth";
    cloth.mesh = grid_mesh(3, 3, 0.5, 0.5);
    cloth.mesh.vertices.row(2).array() += 3;
    cloth.material.density = 0.3;
    cloth.material.youngs = 20;
    cloth.material.limit = StrainLimitSpec{0.001, 0.2};
    cloth.d_hat = 0.01;
    builder.add_body(cloth);
  }
  BodySpec block;
  block.name = "block";
  block.mesh = solid_box_mesh({2, 3, 2}, Vec3d(0.4, 0.5, 0.3));
  block.material.solid_youngs = 200;
  block.material.solid_density = 3;
  block.material.limit = StrainLimitSpec{0.001, 0.5, true};
  block.d_hat = 0.01;
  builder.add_body(block);
  return builder.finish();
}

struct Both {
  Scene scene;
  TermOptions options;
  StepFrame frame;
  std::optional<CpuElements> cpu;
  test::TestedExecutor executor;
  std::optional<OnExecutor> resident;

  explicit Both(bool with_cloth, const LimitRule& rule = {"cubic", std::nullopt, rounding})
      : scene(limited_scene(with_cloth)), options(element_options(rule.shape)), frame(step_frame(scene)) {
    options.limit_stiffness = rule.policy();
    options.solid_limit_stiffness = rule.elastic ? rule.policy() : fixed_limit(500);
    cpu.emplace(scene, options, frame);
    resident.emplace(executor, scene, options, frame);
  }
  std::vector<HostTerm*> limits() {
    std::vector<HostTerm*> out;
    for (std::size_t i = 0; i < cpu->terms.size(); ++i) {
      if (cpu->terms[i].name() == "strain_limit") out.push_back(&const_cast<HostTerm&>(cpu->terms[i]));
    }
    return out;
  }
};

/// As far as strained(), and larger in all directions, so that all three stretches of elements are limited.
Positions swollen(const Scene& scene) { return 1.07 * strained(scene, 0.006); }

// Three iterates of one step, so that kappa is refreshed or kept.
TEST(ExecutorSolidLimit, HasTheTermsOfTheCpuForEveryRule) {
  for (const bool with_cloth : {false, true}) {
    for (const LimitRule& rule : limit_rules()) {
      SCOPED_TRACE(std::string(rule.shape) + (with_cloth ? " beside cloth" : ""));
      Both both(with_cloth, rule);
      ASSERT_EQ(both.limits().size(), with_cloth ? 2U : 1U);
      const std::vector<Positions> states = {strained(both.scene, 0.004), strained(both.scene),
                                             swollen(both.scene)};
      for (std::size_t i = 0; i < states.size(); ++i) {
        const Positions& x = states[i];
        both.cpu->linearise(x, StepHessian::clamped);
        both.resident->linearise(x);
        IterateNumbers expected;
        double energy = 0;
        for (HostTerm* term : both.limits()) {
          term->report(x, expected, both.cpu->clock);
          for (const double e : term->families()[0].local.energy) energy += e;
        }
        const IterateNumbers found = both.resident->report();
        const double load = expected.solid_limit_load_max_Pa.value;
        ASSERT_GT(load, 0);
        ASSERT_GT(expected.limit_gap_min_rel.value, 0);
        EXPECT_NEAR(found.solid_limit_load_max_Pa.value, load, rounding * load);
        EXPECT_EQ(found.max_stretch.value, expected.max_stretch.value);
        EXPECT_EQ(found.limit_gap_min_rel.value, expected.limit_gap_min_rel.value);
        EXPECT_NEAR(found.limit_kappa_change_rel.value, expected.limit_kappa_change_rel.value, rounding);
        EXPECT_EQ(found.limit_load_max_N_per_m.finite(), with_cloth);
        if (with_cloth) {
          const double of_cloth = expected.limit_load_max_N_per_m.value;
          EXPECT_NEAR(found.limit_load_max_N_per_m.value, of_cloth, rounding * of_cloth);
        }
        const bool moves = rule.elastic && rule.elastic->refresh == Refresh::per_iteration && i > 0;
        EXPECT_EQ(found.limit_kappa_change_rel.value > 1e-6, moves);
        ASSERT_GT(energy, 0);
        EXPECT_NEAR(both.resident->energy(TermGroup::limit).value(), energy, rounding * energy);
        EXPECT_LE(largest(both.resident->gradient() - both.cpu->gradient),
                  rounding * largest(both.cpu->gradient));
        EXPECT_TRUE(both.resident->evaluate(x));
      }
    }
  }
}

TEST(ExecutorSolidLimit, HasTheMatrixOfTheCpu) {
  for (const StepHessian choice : {StepHessian::clamped, StepHessian::absolute, StepHessian::blend}) {
    Both both(true);
    const Positions x = swollen(both.scene);
    both.cpu->linearise(x, choice);
    both.resident->linearise(x);
    const HessianLevel level({choice});
    both.cpu->sum(TermGroup::limit, choice, level, {});
    both.resident->fill(TermGroup::limit,
                        exec::hessian_request(choice, level.t(), level.threshold(), nullptr));
    const Difference found = compare(*both.resident, *both.cpu);
    EXPECT_GT(found.n_nonzero, 100);
    EXPECT_LE(found.relative, rounding) << to_string(choice);
  }
}

TEST(ExecutorSolidLimit, BoundsAStepAsTheCpuDoes) {
  int n_below = 0, n_by_cloth = 0;
  for (const bool with_cloth : {false, true}) {
    Both both(with_cloth);
    const Positions x = strained(both.scene);
    both.cpu->linearise(x, StepHessian::clamped);
    both.resident->linearise(x);
    for (const double park : {0.0, 1e-4, 0.3}) {
      both.options.contact_options.ccd_park = park;
      for (const double size : {1e-4, 0.03, 0.1, 0.7, 20.0}) {
        const Positions dx = wave(both.scene, size), x1 = x + dx;
        IterateNumbers report;
        const double by_cloth =
            with_cloth ? bound(*both.limits()[0], {x, x1, dx}, report, both.cpu->clock) : 1;
        const double by_block = bound(*both.limits().back(), {x, x1, dx}, report, both.cpu->clock);
        const double expected = std::min(by_cloth, by_block);
        IterateNumbers said;
        const double found = both.resident->bound(dx, &said);
        EXPECT_EQ(said.alpha_strain, report.alpha_strain);
        n_by_cloth += with_cloth && by_cloth < by_block;
        EXPECT_EQ(found, expected) << size << " " << park;
        n_below += found > 0 && found < 1;
        EXPECT_TRUE(both.resident->evaluate(x + found * dx));
        EXPECT_EQ(both.resident->evaluate(x + 1.01 * found * dx) || found == 1 || park > 0,
                  found == 1 || park > 0);
      }
    }
  }
  EXPECT_GT(n_below, 10);
  EXPECT_GT(n_by_cloth, 2);
}

/// Literal barriers beyond the limit, and those of the squared gap.
TEST(ExecutorSolidLimit, LiteralAndSquaredGapAreThoseOfTheCpu) {
  for (const char* shape : {"log", "log_squared", "quadratic", "cubic", "two_stage", "exponential"}) {
    for (const bool literal : {false, true}) {
      SCOPED_TRACE(std::string(shape) + (literal ? " literal" : " squared gap"));
      Both both(false, {shape, std::nullopt, rounding});
      both.options.limit.literal = literal;
      if (!literal) both.options.limit.argument = Argument::squared_gap;
      Positions x = swollen(both.scene);
      if (literal) x *= 1.6;
      both.cpu->linearise(x, StepHessian::clamped);
      both.resident->linearise(x);
      const double scale = largest(both.cpu->gradient);
      ASSERT_TRUE(std::isfinite(scale));
      EXPECT_LE(largest(both.resident->gradient() - both.cpu->gradient), rounding * scale);
      const bool within = both.resident->evaluate(x);
      EXPECT_TRUE(within || literal);
      EXPECT_EQ(both.resident->evaluate(1.8 * x), literal);
      both.resident->evaluate(x);
      double energy = 0;
      both.limits()[0]->evaluate(x);
      for (const double e : both.limits()[0]->families()[0].trial_energy) energy += e;
      ASSERT_TRUE(std::isfinite(energy));
      EXPECT_NEAR(both.resident->energy(TermGroup::limit).value(), energy, rounding * std::abs(energy));
    }
  }
}

TEST(ExecutorSolidLimit, RefusesStatesBeyondIt) {
  Both both(false);
  both.resident->linearise(strained(both.scene));
  Positions beyond = both.scene.x0;
  beyond.row(2) *= 1.6;
  EXPECT_FALSE(both.resident->evaluate(beyond));
  beyond.row(2) *= -1;  // inverted: stretches are sizes
  EXPECT_FALSE(both.resident->evaluate(beyond));
  Positions nowhere = both.scene.x0;
  nowhere(1, 7) = std::nan("");
  EXPECT_FALSE(both.resident->evaluate(nowhere));
  EXPECT_TRUE(both.resident->evaluate(strained(both.scene)));
}

}  // namespace
}  // namespace bb::exec_solid_limit_test
