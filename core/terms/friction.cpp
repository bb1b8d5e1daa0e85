// Friction: mu load f0(slide) of every contact that a step begins with (docs/theory/friction.md). Normal, weights and load are
// those of the start of the step, so that E stays one function of x within a step; contacts that come later rub from the next step on.
// With refresh per_iteration they are those of the iterate, and E is one function within an iteration.
#include <algorithm>
#include <stdexcept>

#include "core/energy/friction_law.hpp"
#include "core/energy/friction_list.hpp"
#include "core/exec/sums/executor_sum.hpp"
#include "core/terms/friction_rows.hpp"
#include "core/terms/lagged_family_of.hpp"
#include "core/terms/registry.hpp"

namespace bb {
namespace {

/// The coefficients of a side: a body or an obstacle. One that has a coefficient of its own takes none of the run's.
constexpr auto sliding = [](const auto& side, const FrictionOptions& of) {
  return side.friction.value_or(of.mu);
};
constexpr auto at_rest = [](const auto& side, const FrictionOptions& of) {
  if (side.friction_static) return *side.friction_static;
  return side.friction ? *side.friction : of.mu_static.value_or(of.mu);
};

template <class Law>
class FrictionFamily final : public LaggedFamilyOf<FrictionRows<Law>> {
  using Base = LaggedFamilyOf<FrictionRows<Law>>;
  using Base::kind_, Base::place_, Base::rows_;

 public:
  FrictionFamily(const FamilyPlace& place, const Scene& scene, const FrictionOptions& options,
                 const int* body)
      : Base(place, body, options.combine, coefficients(scene.bodies, options, at_rest),
             coefficients(scene.obstacles, options, at_rest)),
        options_(options),
        obstacles_(scene.obstacles),
        turns_(std::any_of(obstacles_.begin(), obstacles_.end(),
                           [](const Obstacle& o) { return o.motion.most_turning() != 0; })),
        turn_(place.executor, "turns of obstacles"),
        spin_(place.executor, "lagged spins"),
        kinetic_of_body_(place.executor, "kinetic coefficients of bodies"),
        kinetic_of_obstacle_(place.executor, "kinetic coefficients of obstacles"),
        kinetic_(place.executor, "kinetic parts"),
        numbers_(place.executor) {
    if constexpr (Law::two_coefficients) {
      kinetic_of_body_.upload(coefficients(scene.bodies, options, sliding));
      kinetic_of_obstacle_.upload(coefficients(scene.obstacles, options, sliding));
    }
  }

  void change_step(const FamilyStep& step) override {
    take_step(step);
    find_spins();
  }
  bool take_secant(double share) override {
    if (options_.hessian != FrictionHessian::adaptive) return false;
    kind_.secant = share;
    return Base::size() > 0;
  }
  bool refreshes() override {
    return options_.refresh == FrictionRefresh::per_iteration && !adopted_ && take_at_end();
  }
  bool renews() override { return ++solved_ < options_.lag_iterations && take_at_end(); }

  void report_end(const double* x, StepNumbers& out) override {
    numbers_.clear();
    numbers_.add(Base::size(), FrictionOfRows<Law>{Base::of_kind(), x});
    const FrictionNumbers found = numbers_.get();
    out.friction_sticking += static_cast<int>(found.sticking);
    out.friction_sliding += static_cast<int>(found.sliding);
    out.friction_dissipation_J = found.work.value();
  }

 private:
  template <class Sides, class Of>
  static std::vector<double> coefficients(const Sides& sides, const FrictionOptions& options, const Of& of) {
    std::vector<double> out(sides.size());
    std::transform(sides.begin(), sides.end(), out.begin(),
                   [&](const auto& side) { return of(side, options); });
    return out;
  }
  void take_step(const FamilyStep& step) {
    kind_.eps = whole_slide(options_, step.dt);
    kind_.reach = kinetic_slide(options_, step.dt);
    t_end_ = step.t_end;
    dt_ = step.dt;
  }
  /// Rows are taken next from where obstacles are at the end of the step.
  bool take_at_end() {
    t_lagged_ = t_end_;
    return true;
  }
  void step_begins(const FamilyStep& step) override {
    solved_ = 0;
    adopted_ = false;
    kind_.secant = options_.hessian == FrictionHessian::secant ? 1 : 0;
    take_step(step);
    t_lagged_ = step.t_end - step.dt;
  }
  void rows_changed() override {
    find_spins();
    find_kinetic_parts();
  }
  std::vector<double> kept() const override { return {t_lagged_, kind_.secant}; }
  void adopt_kept(const LaggedState& known) override {
    t_lagged_ = known.kept.at(0);
    kind_.secant = known.kept.at(1);
    adopted_ = true;
  }

  /// Of the rows as they are, in the step as it is.
  void find_spins() {
    if (!turns_) return;
    std::vector<ObstacleTurn> all;
    for (const Obstacle& o : obstacles_) {
      ObstacleTurn& turn = all.emplace_back();
      turn.kind = o.kind;
      turn.radius = o.radius;
      turn.turns = o.motion.most_turning() != 0;
      Vec3d::Map(turn.axis) = o.axis;
      Mat3d::Map(turn.lagged) = o.motion.turn(t_lagged_);
      Mat3d::Map(turn.begin) = o.motion.turn(t_end_ - dt_);
      Mat3d::Map(turn.end) = o.motion.turn(t_end_);
    }
    turn_.upload(all);
    spin_.fit(3 * Base::size());
    kind_.spin = spin_.data();
    place_.executor.each(Base::size(), FindSpins{Base::view(), rows_.pair.data(), turn_.data(),
                                                 Base::lagged().data(), spin_.data()});
  }

  void find_kinetic_parts() {
    if constexpr (Law::two_coefficients) {
      kinetic_.fit(Base::size());
      kind_.kinetic = kinetic_.data();
      place_.executor.each(
          Base::size(),
          KineticParts{Base::view(), Base::sides(), Base::sides_with(kinetic_of_body_, kinetic_of_obstacle_),
                       rows_.pair.data(), kinetic_.data()});
    }
  }

  const FrictionOptions options_;
  const std::vector<Obstacle>& obstacles_;
  bool turns_;  // some obstacle does
  exec::Buffer<ObstacleTurn> turn_;
  exec::Buffer<double> spin_;                                             // [3, n] m
  exec::Buffer<double> kinetic_of_body_, kinetic_of_obstacle_, kinetic_;  // of laws with two coefficients
  exec::ExecutorSums<FrictionNumbers> numbers_;
  double t_end_ = 0, dt_ = 0;  // s
  double t_lagged_ = 0;        // s, of lagged()
  int solved_ = 0;             // times that this step converged
  bool adopted_ = false;       // rows are those of another system
};

}  // namespace

std::unique_ptr<LaggedFamily> friction_family(const FamilyPlace& place, const Scene& scene,
                                              const TermOptions& options, const int* body) {
  const FrictionOptions& friction = options.friction;
  friction_laws_in<double>().require(friction.law, "/friction/law");
#define ENTRY(id, doc)     \
  if (friction.law == #id) \
    return std::make_unique<FrictionFamily<friction_laws::id>>(place, scene, friction, body);
#include "core/energy/friction_laws/registry.inc"
#undef ENTRY
  throw std::logic_error("a registered law of friction without rows");
}

PlanItem needs_friction(const TermNeeds& needs) {
  const FrictionOptions& options = needs.options.friction;
  const auto rubs = [&](const auto& one) { return at_rest(one, options) > 0; };
  const auto& bodies = needs.scene.bodies;
  const auto& obstacles = needs.scene.obstacles;
  const bool some =
      std::any_of(bodies.begin(), bodies.end(), rubs) ||
      (options.combine != CombineRule::min && std::any_of(obstacles.begin(), obstacles.end(), rubs));
  return plan_item(needs.contacts.any() && some, options.law,
                   needs.contacts.any() ? "no coefficient of friction is > 0" : "nothing can touch");
}

}  // namespace bb
