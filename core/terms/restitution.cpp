// Restitution: every contact that a step begins with damps the speed at which its gap closes by load a, and that at which it opens
// by no more than the load (docs/design.md, Restitution). Load, normal and weights are those of the start of the step, a is that of
// the speed at which the pair met.
#include <fmt/format.h>

#include <algorithm>

#include "core/archive/archive.hpp"
#include "core/terms/contact_damping.hpp"
#include "core/terms/contact_sides.hpp"
#include "core/terms/lagged_contacts.hpp"
#include "core/terms/registry.hpp"

namespace bb {
namespace {

/// A pair that is in contact, and the speed at which it met.
struct Met {
  PairId pair;
  double speed;  // m/s
};

class Restitution final : public LaggedContacts {
 public:
  Restitution(const Scene& scene, const TermOptions& options, const TermList& before)
      : LaggedContacts(scene, options.precision, before) {
    for (const Body& body : scene.bodies) of_body_.push_back(damping_of(body));
    for (const Obstacle& obstacle : scene.obstacles) of_obstacle_.push_back(damping_of(obstacle));
  }
  std::string_view name() const override { return "restitution"; }

  void begin_step(const StepFrame& frame, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::contact_terms);
    begin_at(frame.x_n);
    change_frame(frame);
    take_rows(frame.x_n);
    remember();
  }
  void change_frame(const StepFrame& frame) override { dt_ = frame.dt; }
  void adopt_from(const Term& other) override {
    met_ = static_cast<const Restitution&>(other).met_;
    LaggedContacts::adopt_from(other);
  }
  void end_step(const PositionsView& x, PhaseClock&) override { speed_ = (x - lagged()) / dt_; }
  void keep(Archive& archive) override {
    std::vector<PairId> pairs;
    std::vector<double> speeds;
    for (const Met& met : met_) pairs.push_back(met.pair), speeds.push_back(met.speed);
    archive(speed_, pairs, speeds);
    if (!archive.reads()) return;
    met_.clear();
    for (std::size_t k = 0; k < pairs.size(); ++k) met_.push_back({pairs[k], speeds[k]});
  }

  void linearise(const PositionsView& x, const TermContext&) override {
    learn_loads();
    for_each_pass(precision(), [&]<class T>(PassParts parts) {
      store_motion_terms<T>(parts, [&](std::size_t e) {
        return damping_terms<T>(motion<T>(e, x), normal<T>(e), damping<T>(e));
      });
    });
  }
  void evaluate(const PositionsView& x) override {
    with_value_scalar(precision(), [&]<class T>() {
      store_trial(
          [&](std::size_t e) { return damping_value<T>(motion<T>(e, x), normal<T>(e), damping<T>(e)); });
    });
  }

  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock&) override {
    if (!loads_known()) return;
    double work = 0;
    for (std::size_t e = 0; e < size(); ++e)
      work += damping_work<double>(motion<double>(e, x), normal<double>(e), damping<double>(e));
    out.restitution_dissipation_J = work;
  }

 private:
  template <class T>
  ContactDamping<T> damping(std::size_t e) const {
    return {static_cast<T>(strength(e) / dt_), static_cast<T>(load(e))};
  }

  /// Of a body or an obstacle of the scene.
  struct Sides {
    const Restitution& term;
    double operator()(const Body& side) const {
      return term.of_body_[static_cast<std::size_t>(&side - term.scene().bodies.data())];
    }
    double operator()(const Obstacle& side) const {
      return term.of_obstacle_[static_cast<std::size_t>(&side - term.scene().obstacles.data())];
    }
  };
  /// The lesser restitution damps more.
  double coefficient(std::size_t r) const override {
    return combined_of_sides(scene(), contacts(), r, CombineRule::max, Sides{*this});
  }
  void loads_are_known(std::vector<double>& strength) override {
    for (std::size_t e = 0; e < strength.size(); ++e) {
      strength[e] /= speed_at_meeting(contacts().pair[contact(e)]);
    }
  }

  /// Pairs that were in contact keep the speed at which they met; those that are new meet now.
  void remember() {
    std::vector<Met> now;
    for (std::size_t e = 0; e < size(); ++e)
      now.push_back({contacts().pair[contact(e)], closing_speed(contact(e))});
    const auto by_pair = [](const Met& a, const Met& b) { return a.pair < b.pair; };
    std::sort(now.begin(), now.end(), by_pair);
    auto known = met_.begin();
    for (Met& met : now) {
      while (known != met_.end() && known->pair < met.pair) ++known;
      if (known != met_.end() && known->pair == met.pair) met.speed = known->speed;
    }
    met_ = std::move(now);
  }
  double speed_at_meeting(PairId pair) const {
    const auto met = std::lower_bound(met_.begin(), met_.end(), pair,
                                      [](const Met& a, PairId wanted) { return a.pair < wanted; });
    return std::max(met->speed, least_meeting_speed);
  }
  /// At the start of the step, m/s.
  double closing_speed(std::size_t r) const {
    const Positions& speed = speed_.cols() > 0 ? speed_ : scene().v0;
    Vec3d relative = Vec3d::Zero();
    for (std::size_t k = 4 * r; k < 4 * r + 4 && contacts().stencil[k] >= 0; ++k) {
      relative += contacts().weight[k] * speed.col(contacts().stencil[k]);
    }
    return -relative.dot(Vec3d::Map(&contacts().normal[3 * r]));
  }

  double dt_ = 0;                              // s
  Positions speed_;                            // m/s, of the step before
  std::vector<double> of_body_, of_obstacle_;  // damping_of each, 1
  std::vector<Met> met_;                       // pairs ascending
};

}  // namespace

PlanItem needs_restitution(const TermNeeds& needs) {
  const auto damps = [](const auto& one) { return one.restitution.value_or(1) < 1; };
  const auto& bodies = needs.scene.bodies;
  const auto& obstacles = needs.scene.obstacles;
  const bool some = std::any_of(bodies.begin(), bodies.end(), damps) ||
                    std::any_of(obstacles.begin(), obstacles.end(), damps);
  return plan_item(needs.contacts.any() && some, "speeds are kept in part",
                   needs.contacts.any() ? "no restitution is below 1" : "nothing can touch");
}

void make_restitution(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<Restitution>(inputs.scene, inputs.options, terms));
}

}  // namespace bb
