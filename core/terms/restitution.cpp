// Restitution: every contact that a step begins with damps the speed at which its gap closes by load a (docs/design.md,
// Restitution). Load, normal and weights are those of the start of the step, a is that of the speed at which the pair met.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/archive/archive.hpp"
#include "core/energy/element_loop.hpp"
#include "core/energy/friction.hpp"
#include "core/energy/restitution.hpp"
#include "core/terms/contact_sides.hpp"
#include "core/terms/registry.hpp"

namespace bb {
namespace {

constexpr double least_speed = 1e-2;  // m/s; pairs that meet slower are damped as those that meet with it

/// What a side asks for, in units of 1 over the speed at which a pair met.
template <class Side>
double damping_of(const Side& side) {
  return restitution_damping(side.restitution.value_or(1));
}

/// A pair that is in contact, and the speed at which it met.
struct Met {
  PairId pair;
  double speed;  // m/s
};

class Restitution final : public Term {
 public:
  /// All arguments outlive the term. before: the terms whose contacts are damped.
  Restitution(const Scene& scene, const TermOptions& options, const TermList& before)
      : scene_(scene), precision_(options.precision) {
    for (const auto& term : before) before_.push_back(term.get());
    for (const Body& body : scene.bodies) of_body_.push_back(damping_of(body));
    for (const Obstacle& obstacle : scene.obstacles) of_obstacle_.push_back(damping_of(obstacle));
    families_.resize(1);
  }
  std::string_view name() const override { return "restitution"; }
  TermGroup group() const override { return TermGroup::friction; }
  Phase phase() const override { return Phase::contact_terms; }
  bool fixed_stencils() const override { return false; }

  void begin_step(const StepFrame& frame, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::contact_terms);
    x_n_ = frame.x_n;
    change_frame(frame);
    take_rows(contacts_now());
    remember();
  }
  void change_frame(const StepFrame& frame) override { dt_ = frame.dt; }
  void adopt_from(const Term& other) override {
    const auto& same = static_cast<const Restitution&>(other);
    take_rows(same.contacts_);
    met_ = same.met_;
    damping_ = same.damping_;
    loads_known_ = same.loads_known_;
  }
  void end_step(const PositionsView& x, PhaseClock&) override { speed_ = (x - x_n_) / dt_; }
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
    if (!loads_known_) learn_loads();
    for_each_pass(precision_, [&]<class T>(PassParts parts) {
      for_each_element(size(), [&](std::size_t e) {
        const Vec<T, 3> normal = Vec3d::Map(&contacts_.normal[3 * row_[e]]).template cast<T>();
        const T k = static_cast<T>(damping_[e] / dt_), way = way_of<T>(e, x);
        MotionTerms<T> terms{k / T(2) * way * way, k * way * normal, k * normal * normal.transpose()};
        mirror_lower<T, 3>(terms.hess);
        const Vec<T, 4> weight = Vec<double, 4>::Map(&contacts_.weight[4 * row_[e]]).template cast<T>();
        store_terms<T, 12>(motion_in_points<T, 4>(terms, weight), e, parts, families_[0].local);
      });
    });
  }
  void evaluate(const PositionsView& x) override {
    with_value_scalar(precision_, [&]<class T>() {
      for_each_element(size(), [&](std::size_t e) {
        const T way = way_of<T>(e, x);
        families_[0].trial_energy[e] = static_cast<T>(damping_[e] / dt_) / T(2) * way * way;
      });
    });
  }
  void change(const PositionsView&, const PositionsView&, EnergyParts& out) const override {
    compare_elements(families_[0], out);  // the rows of a step stay
  }

 private:
  /// Of a body or an obstacle of the scene.
  struct Sides {
    const Restitution& term;
    double operator()(const Body& side) const {
      return term.of_body_[static_cast<std::size_t>(&side - term.scene_.bodies.data())];
    }
    double operator()(const Obstacle& side) const {
      return term.of_obstacle_[static_cast<std::size_t>(&side - term.scene_.obstacles.data())];
    }
  };

  ContactLoads contacts_now() const {
    ContactLoads out;
    for (const Term* term : before_) term->add_loads(x_n_, out);
    return out;
  }

  /// Those that are damped become elements.
  void take_rows(ContactLoads contacts) {
    contacts_ = std::move(contacts);
    row_.clear(), vertices_.clear(), asked_.clear();
    const Sides sides{*this};
    for (std::size_t r = 0; r < contacts_.size(); ++r) {
      // the lesser restitution damps more
      const double asked = combined_of_sides(scene_, contacts_, r, CombineRule::max, sides);
      if (asked == 0) continue;
      row_.push_back(r);
      asked_.push_back(asked);
      vertices_.insert(vertices_.end(), &contacts_.stencil[4 * r], &contacts_.stencil[4 * r] + 4);
    }
    damping_.assign(row_.size(), 0.0);
    loads_known_ = false;
    families_[0].stencils = {4, vertices_};
    families_[0].local.resize(row_.size(), 4);
    families_[0].trial_energy.resize(row_.size());
  }

  /// Pairs that were in contact keep the speed at which they met; those that are new meet now.
  void remember() {
    std::vector<Met> now;
    for (const std::size_t r : row_) now.push_back({contacts_.pair[r], closing_speed(r)});
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
    return std::max(met->speed, least_speed);
  }
  /// At the start of the step, m/s.
  double closing_speed(std::size_t r) const {
    const Positions& speed = speed_.cols() > 0 ? speed_ : scene_.v0;
    Vec3d relative = Vec3d::Zero();
    for (std::size_t k = 4 * r; k < 4 * r + 4 && contacts_.stencil[k] >= 0; ++k) {
      relative += contacts_.weight[k] * speed.col(contacts_.stencil[k]);
    }
    return -relative.dot(Vec3d::Map(&contacts_.normal[3 * r]));
  }

  // The terms before have been linearised where the rows are of.
  void learn_loads() {
    const ContactLoads now = contacts_now();
    if (now.stencil != contacts_.stencil)
      throw std::logic_error("the rows of a step changed before their loads");
    for (std::size_t e = 0; e < row_.size(); ++e) {
      const std::size_t r = row_[e];
      damping_[e] = now.load[r] * asked_[e] / speed_at_meeting(contacts_.pair[r]);
    }
    loads_known_ = true;
  }

  /// By how much the gap of element e has opened since the start of the step, to first order, m.
  template <class T>
  T way_of(std::size_t e, const PositionsView& x) const {
    const std::size_t r = row_[e];
    Vec<T, 3> motion = Vec<T, 3>::Zero();
    for (std::size_t k = 4 * r; k < 4 * r + 4 && contacts_.stencil[k] >= 0; ++k) {
      const int v = contacts_.stencil[k];
      motion += static_cast<T>(contacts_.weight[k]) * (x.col(v) - x_n_.col(v)).template cast<T>();
    }
    return motion.dot(Vec3d::Map(&contacts_.normal[3 * r]).template cast<T>());
  }

  const Scene& scene_;
  Precision precision_;
  std::vector<const Term*> before_;
  double dt_ = 0;                              // s
  Positions x_n_, speed_;                      // m at the start of the step, m/s of the step before
  ContactLoads contacts_;                      // at x_n
  std::vector<std::size_t> row_;               // [n] the contact of each element
  std::vector<double> asked_;                  // [n] 1: damping_of its sides
  std::vector<double> of_body_, of_obstacle_;  // the same of each, 1
  std::vector<double> damping_;                // [n] N s/m
  std::vector<int> vertices_;                  // [4 n]
  std::vector<Met> met_;                       // pairs ascending
  bool loads_known_ = false;
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
