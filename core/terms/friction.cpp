// Friction: mu load f0(slide) of every contact that a step begins with (docs/design.md, Friction). Normal, weights and load are
// those of the start of the step, so that E stays one function of x within a step; contacts that come later rub from the next step on.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/contact/contact_loads.hpp"
#include "core/energy/element_loop.hpp"
#include "core/energy/friction.hpp"
#include "core/energy/friction_law.hpp"
#include "core/terms/contact_sides.hpp"
#include "core/terms/registry.hpp"

namespace bb {
namespace {

class Friction final : public Term {
 public:
  /// All arguments outlive the term. before: the terms whose contacts rub.
  Friction(const Scene& scene, const TermOptions& options, const TermList& before)
      : scene_(scene), options_(options) {
    for (const auto& term : before) before_.push_back(term.get());
    families_.resize(1);
  }
  std::string_view name() const override { return "friction"; }
  TermGroup group() const override { return TermGroup::friction; }
  Phase phase() const override { return Phase::contact_terms; }
  bool fixed_stencils() const override { return false; }

  void begin_step(const StepFrame& frame, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::contact_terms);
    x_n_ = frame.x_n;
    change_frame(frame);
    solved_ = 0;
    t_lag_ = frame.t_end - frame.dt;
    take_lag(x_n_);
  }
  void change_frame(const StepFrame& frame) override {
    eps_ = options_.friction.eps_v * frame.dt;
    t_end_ = frame.t_end;
    dt_ = frame.dt;
    find_spins();
  }
  void adopt_from(const Term& other) override {
    const auto& same = static_cast<const Friction&>(other);
    lagged_ = same.lagged_;
    t_lag_ = same.t_lag_;
    take_rows(same.contacts_);
    strength_ = same.strength_;
    loads_known_ = same.loads_known_;
  }
  bool renew_lag(const PositionsView& x) override {
    if (++solved_ >= options_.friction.lag_iterations) return false;
    const bool had_rows = size() > 0;
    t_lag_ = t_end_;
    take_lag(x);
    return had_rows || size() > 0;
  }

  void linearise(const PositionsView& x, const TermContext&) override {
    if (!loads_known_) learn_loads();
    for_each_pass(options_.precision, [&]<class T>(PassParts parts) {
      const Law<T> law = this->law<T>();
      for_each_element(size(), [&](std::size_t e) {
        const Row<T> row(*this, e);
        const Vec<T, 3> slide = row.slide(x, x_n_);
        const T y = slide.norm();
        const auto terms = friction_terms<T>(slide, y, row.normal, row.strength, law(y));
        store_terms<T, 12>(motion_in_points<T, 4>(terms, row.weight), e, parts, families_[0].local);
      });
    });
  }
  void evaluate(const PositionsView& x) override {
    with_value_scalar(options_.precision, [&]<class T>() {
      const Law<T> law = this->law<T>();
      for_each_element(size(), [&](std::size_t e) {
        const Row<T> row(*this, e);
        families_[0].trial_energy[e] = row.strength * law(row.slide(x, x_n_).norm()).f0;
      });
    });
  }
  void change(const PositionsView&, const PositionsView&, EnergyParts& out) const override {
    compare_elements(families_[0], out);  // the rows of a step stay
  }

  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock&) override {
    if (!loads_known_) return;  // the step ended where a lag was taken anew
    const Law<double> law = this->law<double>();
    double work = 0;
    for (std::size_t e = 0; e < size(); ++e) {
      if (!(strength_[e] > 0)) continue;
      const double y = Row<double>(*this, e).slide(x, x_n_).norm();
      work += strength_[e] * law(y).f1_over_y * y * y;
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
    return {friction_laws_in<T>().require(options_.friction.law, "/friction/law").eval, static_cast<T>(eps_)};
  }

  /// Element e in the scalar T.
  template <class T>
  struct Row {
    const int* vertex;
    Vec<T, 4> weight;
    Vec<T, 3> normal, spin;
    T strength;  // mu times load, N
    Row(const Friction& of, std::size_t e)
        : vertex(&of.vertices_[4 * e]),
          weight(Vec<double, 4>::Map(&of.contacts_.weight[4 * of.row_[e]]).template cast<T>()),
          normal(Vec3d::Map(&of.contacts_.normal[3 * of.row_[e]]).template cast<T>()),
          spin(of.spin_[e].template cast<T>()),
          strength(static_cast<T>(of.strength_[e])) {}
    Vec<T, 3> slide(const PositionsView& x, const PositionsView& x_n) const {
      Vec<T, 3> motion = Vec<T, 3>::Zero();
      for (int k = 0; k < 4 && vertex[k] >= 0; ++k) {
        motion += weight[k] * (x.col(vertex[k]) - x_n.col(vertex[k])).template cast<T>();
      }
      motion -= spin;
      return slide_of<T>(motion, normal);
    }
  };

  ContactLoads contacts_now() const {
    ContactLoads out;
    for (const Term* term : before_) term->add_loads(lagged_, out);
    return out;
  }

  /// Rows of the iterate x; their loads are known once the terms before have been linearised there.
  void take_lag(const PositionsView& x) {
    lagged_ = x;
    take_rows(contacts_now());
    loads_known_ = false;
  }

  /// Those with friction become elements.
  void take_rows(ContactLoads contacts) {
    contacts_ = std::move(contacts);
    row_.clear();
    mu_.clear();
    vertices_.clear();
    for (std::size_t r = 0; r < contacts_.size(); ++r) {
      const double mu = coefficient(r);
      if (mu == 0) continue;
      row_.push_back(r);
      mu_.push_back(mu);
      vertices_.insert(vertices_.end(), &contacts_.stencil[4 * r], &contacts_.stencil[4 * r] + 4);
    }
    strength_.assign(row_.size(), 0.0);
    find_spins();
    families_[0].stencils = {4, vertices_};
    families_[0].local.resize(row_.size(), 4);
    families_[0].trial_energy.resize(row_.size());
  }

  /// What the turn of an obstacle takes its surface along by in this step where each element is, beside the way of its
  /// point.
  void find_spins() {
    spin_.assign(row_.size(), Vec3d::Zero());
    for (std::size_t e = 0; e < row_.size(); ++e) {
      const int obstacle = contacts_.obstacle[row_[e]];
      if (obstacle < 0) continue;
      const Obstacle& o = scene_.obstacles[static_cast<std::size_t>(obstacle)];
      if (o.motion.most_turning() == 0) continue;
      const Vec3d arm = arm_of(row_[e], o);
      const Vec3d unturned = o.motion.turn(t_lag_).transpose() * arm;
      spin_[e] = o.motion.turn(t_end_) * unturned - o.motion.turn(t_end_ - dt_) * unturned;
    }
  }
  /// From the point of an obstacle that moves to its surface at a row, m.
  Vec3d arm_of(std::size_t r, const Obstacle& o) const {
    Vec3d arm = Vec3d::Zero();  // to the other side of the row
    for (std::size_t k = 4 * r; k < 4 * r + 4 && contacts_.stencil[k] >= 0; ++k) {
      arm += contacts_.weight[k] * lagged_.col(contacts_.stencil[k]);
    }
    if (o.kind == ObstacleKind::plane) return arm - o.axis.dot(arm) * o.axis;
    const Vec3d along =
        o.kind == ObstacleKind::cylinder ? Vec3d(o.axis.dot(arm) * o.axis) : Vec3d(Vec3d::Zero());
    return along + o.radius * (arm - along).normalized();
  }

  double coefficient(std::size_t r) const {
    const auto of = [this](const auto& side) { return side.friction.value_or(options_.friction.mu); };
    return combined_of_sides(scene_, contacts_, r, options_.friction.combine, of);
  }

  // The terms before have been linearised where the rows are of.
  void learn_loads() {
    const ContactLoads now = contacts_now();
    if (now.stencil != contacts_.stencil)
      throw std::logic_error("the rows of a lag changed before their loads");
    for (std::size_t e = 0; e < row_.size(); ++e) strength_[e] = mu_[e] * now.load[row_[e]];
    loads_known_ = true;
  }

  const Scene& scene_;
  const TermOptions& options_;
  std::vector<const Term*> before_;
  double eps_ = 0;                     // m
  double t_end_ = 0, dt_ = 0;          // s
  double t_lag_ = 0;                   // s, of lagged_
  Positions x_n_, lagged_;             // m, where slides begin, and where the rows are of
  ContactLoads contacts_;              // there
  std::vector<std::size_t> row_;       // [n] the contact of each element
  std::vector<double> mu_, strength_;  // [n] 1; mu times load, N
  std::vector<Vec3d> spin_;            // [n] m
  std::vector<int> vertices_;          // [4 n]
  bool loads_known_ = false;
  int solved_ = 0;  // times that this step converged
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
