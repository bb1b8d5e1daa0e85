// Friction on an executor, one class a law.
#include "core/resident/system/lagged_term.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/math/error.hpp"

namespace bb::resident {

KnownLag known_lag(std::string_view term, const ResidentLag::Columns& columns, const Column& lagged,
                   double t) {
  KnownLag out;
  out.term = term;
  out.lagged.resize(3, lagged.size() / 3);
  lagged.download({out.lagged.data(), static_cast<std::size_t>(out.lagged.size())});
  out.t = t;
  out.strength = columns.strength;
  const std::size_t n = columns.pair.size();
  ContactLoads& contacts = out.contacts;
  contacts.pair = columns.pair;
  contacts.load = columns.load;
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t k = 0; k < 4; ++k) {
      contacts.stencil.push_back(columns.vertex[k * n + r]);
      contacts.weight.push_back(columns.weight[k * n + r]);
    }
    for (std::size_t c = 0; c < 3; ++c) contacts.normal.push_back(columns.normal[c * n + r]);
    contacts.obstacle.push_back(pair_obstacle(columns.pair[r]));
  }
  return out;
}

ResidentContact& contact_of(ResidentTermList& terms) {
  ResidentContact* contact = terms.find<ResidentContact>();
  if (!contact) throw std::logic_error("a term on contacts without contact");
  return *contact;
}

namespace {

template <class Law>
class FrictionTerm final : public LaggedTerm<RubbingRows<Law>> {
  using Base = LaggedTerm<RubbingRows<Law>>;
  using Base::executor_, Base::lag_, Base::rows_, Base::size, Base::t_lag_, Base::take;

 public:
  FrictionTerm(const ResidentInputs& inputs, ResidentContact& contact, std::span<const double> of_body,
               std::span<const double> of_obstacle)
      : Base(inputs, contact, inputs.options.friction.combine, of_body, of_obstacle),
        options_(inputs.options.friction),
        obstacles_(inputs.scene.obstacles),
        turn_(executor_, "turns of obstacles"),
        spin_(executor_, "lagged spins"),
        numbers_(executor_) {}
  std::string_view name() const override { return "friction"; }

  void begin_step(const ResidentFrame& frame) override {
    solved_ = 0;
    t_lag_ = frame.t_end - frame.dt;
    Base::begin_step(frame);
  }
  void change_frame(const ResidentFrame& frame) override {
    rows_.eps = options_.eps_v * frame.dt;
    t_end_ = frame.t_end;
    dt_ = frame.dt;
    find_spins();
  }
  bool renew_lag(const Column& x) override {
    if (++solved_ >= options_.lag_iterations) return false;
    const bool had_rows = size() > 0;
    t_lag_ = t_end_;
    take(x);
    find_spins();
    return had_rows || size() > 0;
  }

  void report_end(const Column& x, StepNumbers& out) override {
    if (!lag_.known()) return;  // the step ended where a lag was taken anew
    numbers_.clear();
    numbers_.add(size(), FrictionOfRows<Law>{Base::rows(), x.data()});
    const FrictionNumbers found = numbers_.get();
    out.friction_sticking += static_cast<int>(found.sticking);
    out.friction_sliding += static_cast<int>(found.sliding);
    out.friction_dissipation_J = found.work.value();
  }

 private:
  bool turns() const {
    return std::any_of(obstacles_.begin(), obstacles_.end(),
                       [](const Obstacle& o) { return o.motion.most_turning() != 0; });
  }
  /// Of the rows that were taken, in the step as it is.
  void find_spins() {
    if (!turns()) return;
    std::vector<ObstacleTurn> all;
    for (const Obstacle& o : obstacles_) {
      ObstacleTurn& turn = all.emplace_back();
      turn.turns = o.motion.most_turning() != 0;
      Mat3d::Map(turn.lag) = o.motion.turn(t_lag_);
      Mat3d::Map(turn.begin) = o.motion.turn(t_end_ - dt_);
      Mat3d::Map(turn.end) = o.motion.turn(t_end_);
    }
    turn_.upload(all);
    spin_.fit(3 * size());
    rows_.spin = spin_.data();
    executor_.each(size(),
                   FindSpins{lag_.view(rows_.x_n), lag_.pairs(), Base::contact_.surface().view().obstacles,
                             turn_.data(), Base::lagged_.data(), spin_.data()});
  }

  const FrictionOptions& options_;
  const std::vector<Obstacle>& obstacles_;
  Buffer<ObstacleTurn> turn_;
  Buffer<double> spin_;  // [3, n] m
  ResidentSums<FrictionNumbers> numbers_;
  double t_end_ = 0, dt_ = 0;  // s
  int solved_ = 0;             // times that this step converged
};

template <class Sides>
std::vector<double> coefficients_of(const Sides& sides, double otherwise) {
  std::vector<double> out;
  for (const auto& side : sides) out.push_back(side.friction.value_or(otherwise));
  return out;
}

}  // namespace

void make_resident_friction(const ResidentInputs& inputs, ResidentTermList& terms) {
  const FrictionOptions& options = inputs.options.friction;
  ResidentContact& contact = contact_of(terms);
  const std::vector<double> of_body = coefficients_of(inputs.scene.bodies, options.mu),
                            of_obstacle = coefficients_of(inputs.scene.obstacles, options.mu);
#define ENTRY(id, doc)    \
  if (options.law == #id) \
    return terms.add(     \
        std::make_unique<FrictionTerm<friction_laws::id>>(inputs, contact, of_body, of_obstacle));
#include "core/energy/friction_laws/registry.inc"
#undef ENTRY
  throw ConfigError("/friction/law", options.law, "a law of core/energy/friction_laws/registry.inc");
}

}  // namespace bb::resident
