// Friction: mu load f0(slide) of every contact that a step begins with (docs/design.md, Friction). Normal, weights and load are
// those of the start of the step, so that E stays one function of x within a step; contacts that come later rub from the next step on.
#include <fmt/format.h>

#include <algorithm>

#include "core/contact/obstacle_arm.hpp"
#include "core/energy/friction_law.hpp"
#include "core/terms/contact_sides.hpp"
#include "core/terms/lagged_contacts.hpp"
#include "core/terms/registry.hpp"

namespace bb {
namespace {

class Friction final : public LaggedContacts {
 public:
  Friction(const Scene& scene, const TermOptions& options, const TermList& before)
      : LaggedContacts(scene, options.precision, before), options_(options.friction) {}
  std::string_view name() const override { return "friction"; }

  void begin_step(const StepFrame& frame, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::contact_terms);
    begin_at(frame.x_n);
    take_frame(frame);
    solved_ = 0;
    t_lag_ = frame.t_end - frame.dt;
    take_rows(frame.x_n);
    find_spins();
  }
  void change_frame(const StepFrame& frame) override {
    take_frame(frame);
    find_spins();
  }
  void adopt_from(const Term& other) override {
    t_lag_ = static_cast<const Friction&>(other).t_lag_;
    LaggedContacts::adopt_from(other);
    find_spins();
  }
  bool renew_lag(const PositionsView& x) override {
    if (++solved_ >= options_.lag_iterations) return false;
    const bool had_rows = size() > 0;
    t_lag_ = t_end_;
    take_rows(x);
    find_spins();
    return had_rows || size() > 0;
  }

  void linearise(const PositionsView& x, const TermContext&) override {
    learn_loads();
    for_each_pass(precision(), [&]<class T>(PassParts parts) {
      const Law<T> law = this->law<T>();
      store_motion_terms<T>(parts, [&](std::size_t e) {
        return friction_of_slide<T>(slide<T>(e, x), normal<T>(e), static_cast<T>(strength(e)), law);
      });
    });
  }
  void evaluate(const PositionsView& x) override {
    with_value_scalar(precision(), [&]<class T>() {
      const Law<T> law = this->law<T>();
      store_trial(
          [&](std::size_t e) { return friction_value<T>(slide<T>(e, x), static_cast<T>(strength(e)), law); });
    });
  }

  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock&) override {
    if (!loads_known()) return;  // the step ended where a lag was taken anew
    const Law<double> law = this->law<double>();
    double work = 0;
    for (std::size_t e = 0; e < size(); ++e) {
      if (!(strength(e) > 0)) continue;
      const double y = slide<double>(e, x).norm();
      work += friction_work(y, strength(e), law);
      ++(y < eps_ ? out.friction_sticking : out.friction_sliding);
    }
    out.friction_dissipation_J = work;
  }

 private:
  template <class T>
  struct Law {
    FrictionProfile<T> (*eval)(T y, T eps);
    T eps;
    FrictionProfile<T> operator()(T y) const { return eval(y, eps); }
  };
  template <class T>
  Law<T> law() const {
    return {friction_laws_in<T>().require(options_.law, "/friction/law").eval, static_cast<T>(eps_)};
  }

  void take_frame(const StepFrame& frame) {
    eps_ = options_.eps_v * frame.dt;
    t_end_ = frame.t_end;
    dt_ = frame.dt;
  }

  template <class T>
  Vec<T, 3> slide(std::size_t e, const PositionsView& x) const {
    return slide_of<T>(motion<T>(e, x) - spin_[e].template cast<T>(), normal<T>(e));
  }

  /// What the turn of an obstacle takes its surface along by in this step where each element is, beside the way of its
  /// point.
  void find_spins() {
    spin_.assign(size(), Vec3d::Zero());
    for (std::size_t e = 0; e < size(); ++e) {
      const int obstacle = contacts().obstacle[contact(e)];
      if (obstacle < 0) continue;
      const Obstacle& o = scene().obstacles[static_cast<std::size_t>(obstacle)];
      if (o.motion.most_turning() == 0) continue;
      spin_[e] = way_of_turn<double>(arm_of(contact(e), o), o.motion.turn(t_lag_),
                                     o.motion.turn(t_end_ - dt_), o.motion.turn(t_end_));
    }
  }
  /// From the point of an obstacle that moves to its surface at a contact, m.
  Vec3d arm_of(std::size_t r, const Obstacle& o) const {
    Vec3d arm = Vec3d::Zero();  // to the other side of the contact
    for (std::size_t k = 4 * r; k < 4 * r + 4 && contacts().stencil[k] >= 0; ++k) {
      arm += contacts().weight[k] * lagged().col(contacts().stencil[k]);
    }
    return arm_to_surface<double>(analytic_surface<double>(o), arm);
  }

  void lag_is_adopted(double t) override {
    t_lag_ = t;
    find_spins();
  }

  double coefficient(std::size_t r) const override {
    const auto of = [this](const auto& side) { return side.friction.value_or(options_.mu); };
    return combined_of_sides(scene(), contacts(), r, options_.combine, of);
  }

  const FrictionOptions& options_;
  double eps_ = 0;             // m
  double t_end_ = 0, dt_ = 0;  // s
  double t_lag_ = 0;           // s, of lagged()
  std::vector<Vec3d> spin_;    // [n] m
  int solved_ = 0;             // times that this step converged
};

}  // namespace

PlanItem needs_friction(const TermNeeds& needs) {
  const FrictionOptions& options = needs.options.friction;
  const auto rubs = [&](const auto& one) { return one.friction.value_or(options.mu) > 0; };
  const auto& bodies = needs.scene.bodies;
  const auto& obstacles = needs.scene.obstacles;
  const bool some =
      std::any_of(bodies.begin(), bodies.end(), rubs) ||
      (options.combine != CombineRule::min && std::any_of(obstacles.begin(), obstacles.end(), rubs));
  return plan_item(needs.contacts.any() && some, options.law,
                   needs.contacts.any() ? "no coefficient of friction is > 0" : "nothing can touch");
}

void make_friction(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<Friction>(inputs.scene, inputs.options, terms));
}

}  // namespace bb
