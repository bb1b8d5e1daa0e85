// What a strain limit decides, for triangles and tetrahedra on host executors of every order: when its stiffness is made anew, which
// state is measured, what bounds a motion, what is reported of two kinds of elements.
#include <gtest/gtest.h>

#include "core/barrier/launches.hpp"
#include "core/math/error.hpp"
#include "core/terms/strain_limit_state.hpp"
#include "tests/barriers/host_policy.hpp"
#include "tests/terms/all_terms.hpp"

namespace bb::strain_limit_state_test {
namespace {

/// A sheet and a block with limits.
Scene limited_scene() {
  SceneBuilder builder("limited", false, Vec3d(0, 0, -10), "test");
  BodySpec sheet;
  sheet.name = "sheet";
  sheet.mesh = grid_mesh(4, 4, 1.0, 1.0);
  sheet.d_hat = 0.01;
  sheet.material.density = 0.3;
  sheet.material.limit = StrainLimitSpec{0.01, 0.2};
  builder.add_body(sheet);
  BodySpec block;
  block.name = "block";
  block.mesh = solid_box_mesh({2, 1, 1}, Vec3d(0.6, 0.4, 0.3));
  block.mesh.vertices.colwise() += Vec3d(3, 0, 1);
  block.material.solid_density = 10;
  block.d_hat = 0.01;
  block.material.limit = StrainLimitSpec{0.01, 0.2, true};
  builder.add_body(block);
  return builder.finish();
}

struct Limited {
  exec::HostExecutor executor;
  Scene scene = limited_scene();
  TermOptions options = test::term_options();
  StrainLimitState state;
  Positions x_n = scene.x0, x;
  std::vector<double> energy, trial_energy;

  Limited(bool of_solids, const ElasticityInclusive& rule, exec::Order order = exec::Order::threads)
      : executor(order), state(with_rule(rule), scene, options, of_solids, scene.mass.data()) {
    energy.resize(static_cast<std::size_t>(state.family().size()));
    trial_energy = energy;
    state.begin_step(x_n.data(), {0.05, 0.7});
  }
  exec::Executor& with_rule(const ElasticityInclusive& rule) {
    options.limit_stiffness = test::elastic_limit(rule);
    options.solid_limit_stiffness = test::elastic_limit(rule);
    return executor;
  }
  std::vector<double> kappa() { return state.family().kappa().download(); }
  void refresh(const Positions& at) {
    x = at;
    state.refresh(x.data(), {}, energy.data());
    state.family().values(x.data(), energy.data());
  }
  bool look_at(const Positions& trial) {
    state.look_at(trial.data(), trial_energy.data());
    return state.is_feasible();
  }
  IterateNumbers report() {
    IterateNumbers out;
    state.report(x.data(), energy.data(), out);
    return out;
  }
};

constexpr ElasticityInclusive every_iteration{.elastic_term = false};
constexpr ElasticityInclusive once{.elastic_term = false, .refresh = Refresh::per_step};
constexpr ElasticityInclusive folded{
    .elastic_term = false, .refresh = Refresh::per_step, .derivative = KappaDerivative::included};

struct ContactsAlone final : test::HostPolicy {
  const PolicyLaunches* launches() const override {
    static const PolicyLaunches none;
    return &none;
  }
};

/// f(of_solids, order) of both kinds and every order.
template <class F>
void for_each_kind(const F& f) {
  for (const bool of_solids : {false, true}) {
    for (const exec::Order order :
         {exec::Order::threads, exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
      SCOPED_TRACE(of_solids ? "tetrahedra" : "triangles");
      f(of_solids, order);
    }
  }
}

TEST(StrainLimitState, StiffnessIsMadeAnewWhenItsRuleSays) {
  for_each_kind([](bool of_solids, exec::Order order) {
    Limited anew(of_solids, every_iteration, order), kept(of_solids, once, order);
    const Positions first = 1.05 * anew.scene.x0, second = 1.1 * anew.scene.x0;
    for (Limited* one : {&anew, &kept}) {
      one->refresh(first);
      EXPECT_EQ(one->report().limit_kappa_change_rel.value, 0) << "the first iterate";
      ASSERT_GT(one->report().limit_gap_min_rel.value, 0);
      ASSERT_LT(one->report().limit_gap_min_rel.value, 1) << "the limit is not active";
    }
    const std::vector<double> kappa = anew.kappa();
    EXPECT_EQ(kept.kappa(), kappa);
    anew.refresh(second), kept.refresh(second);
    EXPECT_NE(anew.kappa(), kappa);
    EXPECT_EQ(kept.kappa(), kappa);
    // kappa is the mass over y^2: y of 0.16 became that of 0.11, all elements alike
    EXPECT_NEAR(anew.report().limit_kappa_change_rel.value, 0.16 * 0.16 / (0.11 * 0.11) - 1, 1e-9);
    EXPECT_EQ(kept.report().limit_kappa_change_rel.value, 0);
    EXPECT_NEAR(kept.report().max_stretch.value, 0.1, 1e-12);
    kept.state.begin_step(kept.x_n.data(), {0.05, 0.7});
    kept.refresh(second);
    EXPECT_EQ(kept.kappa(), anew.kappa()) << "the next step";
  });
}

/// An accepted trial is not measured again, a refused one is not taken for the iterate; energies are those of a state without a past.
TEST(StrainLimitState, MeasuresEachStateOnce) {
  for_each_kind([](bool of_solids, exec::Order order) {
    for (const ElasticityInclusive& rule : {every_iteration, once, folded}) {
      Limited limit(of_solids, rule, order);
      const Positions first = 1.05 * limit.scene.x0, second = 1.1 * limit.scene.x0,
                      beyond = 1.3 * limit.scene.x0;
      limit.refresh(first);
      const long long sweeps = limit.state.family().sweeps();
      const double stretch = limit.report().max_stretch.value;
      EXPECT_FALSE(limit.look_at(beyond));
      EXPECT_EQ(limit.report().max_stretch.value, stretch) << "of the iterate, which is measured again";
      EXPECT_TRUE(limit.look_at(second));
      limit.state.evaluate(second.data(), limit.trial_energy.data());
      EXPECT_EQ(limit.state.family().sweeps(), sweeps + 3);
      Limited fresh(of_solids, rule, order);
      fresh.refresh(first);
      fresh.state.evaluate(second.data(), fresh.trial_energy.data());
      EXPECT_EQ(limit.trial_energy, fresh.trial_energy) << "a trial that nobody looked at is measured";
      ASSERT_GT(limit.trial_energy[0], 0);
      limit.state.accept();
      limit.refresh(second);
      EXPECT_NEAR(limit.report().max_stretch.value, 0.1, 1e-12);
      EXPECT_EQ(limit.state.family().sweeps(), sweeps + 3);
      fresh.refresh(second);
      EXPECT_EQ(limit.energy, fresh.energy);
      EXPECT_EQ(limit.kappa(), fresh.kappa());
    }
  });
}

/// A trial that becomes the iterate after something was reported of the iterate before is measured as what it is.
TEST(StrainLimitState, AnAcceptedTrialIsNotTheStateThatWasReportedLast) {
  for_each_kind([](bool of_solids, exec::Order order) {
    Limited limit(of_solids, every_iteration, order);
    limit.refresh(1.05 * limit.scene.x0);
    const Positions trial = 1.1 * limit.scene.x0;
    EXPECT_TRUE(limit.look_at(trial));
    EXPECT_NEAR(limit.report().max_stretch.value, 0.05, 1e-12);
    limit.state.accept();
    limit.refresh(trial);
    EXPECT_NEAR(limit.report().max_stretch.value, 0.1, 1e-12);
    Limited fresh(of_solids, every_iteration, order);
    fresh.refresh(trial);
    EXPECT_EQ(limit.energy, fresh.energy);
    EXPECT_EQ(limit.kappa(), fresh.kappa());
  });
}

/// What was measured in the step before, or before kappa was made, is not taken for the first iterate of a step.
TEST(StrainLimitState, TheFirstIterateOfAStepIsWhatItsStiffnessMakesOfIt) {
  constexpr ElasticityInclusive of_time{.mass_term = MassTerm::scaled, .elastic_term = false};
  ElasticityInclusive frozen = of_time, with_potential = of_time;
  frozen.refresh = with_potential.refresh = Refresh::per_step;
  with_potential.derivative = KappaDerivative::included;
  for_each_kind([&](bool of_solids, exec::Order order) {
    for (const ElasticityInclusive& rule : {of_time, frozen, with_potential}) {
      Limited limit(of_solids, rule, order), fresh(of_solids, rule, order);
      const Positions last = 1.05 * limit.scene.x0, first = 1.1 * limit.scene.x0;
      const auto expect_fresh = [&](const StiffnessTime& time) {
        fresh.state.begin_step(fresh.x_n.data(), time);
        fresh.refresh(first);
        ASSERT_GT(fresh.energy[0], 0);
        EXPECT_EQ(limit.energy, fresh.energy);
        EXPECT_EQ(limit.kappa(), fresh.kappa());
        EXPECT_NEAR(limit.report().max_stretch.value, 0.1, 1e-12);
        EXPECT_EQ(limit.report().limit_kappa_change_rel.value, 0) << "the first iterate of a step";
      };
      limit.refresh(last);
      limit.state.begin_step(limit.x_n.data(), {0.04, 0.7});
      limit.x = first;
      EXPECT_NEAR(limit.report().max_stretch.value, 0.1, 1e-12) << "before it is refreshed";
      limit.refresh(first);
      expect_fresh({0.04, 0.7});
      limit.state.begin_step(limit.x_n.data(), {0.02, 0.7});
      EXPECT_TRUE(limit.look_at(first));  // which measures it with the kappa of before
      limit.state.accept();
      limit.refresh(first);
      expect_fresh({0.02, 0.7});
    }
  });
}

TEST(StrainLimitState, AdmitsWhatIsWithinTheLimitAndAnythingWhereTheArticleDoes) {
  for_each_kind([](bool of_solids, exec::Order order) {
    Limited limit(of_solids, once, order);
    limit.refresh(1.05 * limit.scene.x0);
    EXPECT_TRUE(limit.look_at(1.2099 * limit.scene.x0));
    EXPECT_FALSE(limit.look_at(1.2101 * limit.scene.x0));
    limit.options.limit.literal = true;  // is read at every call
    EXPECT_TRUE(limit.look_at(1.2101 * limit.scene.x0));
  });
}

/// Of triangles first, then of tetrahedra beside them.
TEST(StrainLimitState, TwoKindsOfElementsReportTogether) {
  Limited triangles(false, every_iteration), tetrahedra(true, every_iteration);
  EXPECT_FALSE(triangles.state.adds());
  EXPECT_TRUE(tetrahedra.state.adds());
  for (const double ratio : {0.5, 2.0}) {
    IterateNumbers out, alone;
    StepNumbers end;
    const Positions& x0 = triangles.scene.x0;
    const Positions dx = x0, larger = ratio * x0;
    for (Limited* one : {&triangles, &tetrahedra}) {
      one->state.begin_step(one->x_n.data(), {0.05, 0.7});
      one->refresh(1.02 * x0);
      one->refresh((1 + (one == &triangles ? 0.04 : 0.04 * ratio)) * x0);
      one->state.look_along(x0.data(), one == &triangles ? dx.data() : larger.data());
      one->state.bound(out);
      one->state.report(one->x.data(), one->energy.data(), out);
      one->state.report_end(one->x.data(), one->energy.data(), end);
    }
    const double most = 0.04 * std::max(1.0, ratio);
    EXPECT_NEAR(out.max_stretch.value, most, 1e-12);
    EXPECT_EQ(end.max_stretch.value, out.max_stretch.value);
    EXPECT_NEAR(out.limit_gap_min_rel.value, (0.21 - most) / 0.2, 1e-12);
    EXPECT_NEAR(out.limit_kappa_change_rel.value, 0.19 * 0.19 / ((0.21 - most) * (0.21 - most)) - 1, 1e-9);
    EXPECT_NEAR(out.alpha_strain, 0.21 / std::max(1.0, ratio), 1e-4);
    EXPECT_GT(out.limit_load_max_N_per_m.value, 0);
    EXPECT_GT(out.solid_limit_load_max_Pa.value, 0);
    EXPECT_EQ(end.solid_limit_load_max_Pa.value, out.solid_limit_load_max_Pa.value);
  }
}

/// A policy without kernels, as one of a plugin, and one whose kernels are those of contacts alone.
TEST(StrainLimitState, APolicyThatServesNoLimitIsRefusedByName) {
  Limited limit(false, once);
  const auto refused = [&](std::unique_ptr<StiffnessPolicy> policy) -> std::string {
    limit.options.limit_stiffness = std::move(policy);
    try {
      StrainLimitState(limit.executor, limit.scene, limit.options, false, limit.scene.mass.data());
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  for (const std::string& said :
       {refused(std::make_unique<test::HostPolicy>()), refused(std::make_unique<ContactsAlone>())}) {
    EXPECT_NE(said.find("host_only"), std::string::npos) << said;
    EXPECT_NE(said.find("serves a strain limit"), std::string::npos) << said;
  }
}

TEST(StrainLimitState, AKappaWithAPotentialNeedsABarrierWithOne) {
  Limited limit(false, once);
  limit.options.limit_stiffness = test::elastic_limit(folded);
  const auto make = [&] {
    StrainLimitState(limit.executor, limit.scene, limit.options, false, limit.scene.mass.data());
  };
  EXPECT_NO_THROW(make());
  limit.options.limit = {require_shape("log"), Argument::gap};
  EXPECT_THROW(make(), std::logic_error);
}

}  // namespace
}  // namespace bb::strain_limit_state_test
