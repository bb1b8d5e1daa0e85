// A StepSystem whose numbers a test writes down: the decisions of a step solver, each with a number on either side.
#pragma once

#include <functional>
#include <stdexcept>
#include <vector>

#include "core/newton/step_system.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::test {

using Change = std::optional<EnergyChange>;

/// What one iteration meets; all numbers but alpha in SI units.
struct ScriptedIteration {
  double dx = 1, residual = 0, rounding = 0;
  double slope = -1;
  double bound = 1;
  std::function<Change(double)> change =
      nullptr;  // of the direction, as it was found, at alpha; empty: as its quadratic model says
  EndProof end = EndProof::factor;
  // along negative curvature
  double escape_slope = 0, escape_curvature = -1, escape_bound = 1;
  std::function<Change(double)> escape_change = nullptr;  // empty: none is feasible
  bool at_target = true;
  double curvature = -1;       // that the check of the end finds at a saddle, N/m
  double corrected_bound = 0;  // of the direction round curved gaps; 0: there is none
  double t = 0;                // of the matrix that was solved, 0 exact to 1 clamped
  bool lengthens = false;      // scaling the direction changes what bound and change are of
  StepBound work = {};         // of every bound that is requested
};

/// What the system reports of itself in every iteration.
struct ScriptedState {
  Precision precision = Precision::full;
  Positions x = one_point(0, 0, 1);
  std::vector<std::uint8_t> fixed = {0, 0, 0};
  bool has_secant = false;  // take_secant() has a term that takes it
};

/// Runs through its iterations; the last one is repeated.
class ScriptedSystem final : public StepSystem, public StepView {
 public:
  explicit ScriptedSystem(std::vector<ScriptedIteration> script, ScriptedState state = {})
      : script_(std::move(script)), scene_(particle_over_plane(1, 1, 0.01)), state_(std::move(state)) {}

  std::vector<double> tried;           // every alpha whose energy was requested, in the order of trials
  std::vector<double> feasible_asked;  // those of which feasibility alone was
  std::vector<double> aimed;           // lengths of escapes
  std::vector<double> scaled;          // factors on the direction
  std::vector<double> secants;         // the share of the secant that each iteration was assembled with
  int accepted = 0, checks = 0;

  void begin_step(const Positions&, const Prediction&, double, double) override { place_ = -1; }
  bool take_secant(double share) override {
    secant_ = share;
    return state_.has_secant;
  }
  void restart_step(const Prediction&, double) override {}
  void end_step() override {}
  void set_target(const Positions&) override {}
  bool at_target() const override { return now().at_target; }
  void keep(Archive&) override {}
  void keep_solver(Archive&) override {}
  void drop_caches() override {}
  void assemble() override {
    secants.push_back(secant_);
    if (place_ + 1 < static_cast<int>(script_.size())) ++place_;
    escaping_ = corrected_ = false;
    length_ = 1;
  }
  double add_tikhonov(double, double) override { return 0; }
  SolveReport find_direction() override {
    SolveReport out;
    out.attempts = 1;
    out.linear.residual_true = now().residual;
    out.t = now().t;
    return out;
  }
  DirectionSize direction_size() override {
    const double slope = escaping_ ? now().escape_slope : now().slope;
    return {std::max(now().dx, now().rounding), now().dx, now().rounding, slope, now().dx};
  }
  void scale_direction(double factor) override {
    scaled.push_back(factor);
    if (now().lengthens) length_ *= factor;
  }
  double direction_curvature() override { return now().escape_curvature; }
  EndCheck check_end() override {
    ++checks;
    return {now().end, now().end == EndProof::saddle ? now().curvature : 0, 0, 0, 0, {}};
  }
  void aim_at_escape(double length) override {
    aimed.push_back(length);
    escaping_ = true;
  }
  void prepare_motion(MotionEnd, bool) override {}
  double bound_motion(IterationReport& report) override {
    report.bound = now().work;
    if (corrected_) return now().corrected_bound;
    return report.alpha_ccd = escaping_ ? now().escape_bound : std::min(1.0, now().bound / length_);
  }
  bool correct_curvature(double, SolveReport&) override { return corrected_ = now().corrected_bound > 0; }
  void restore_direction() override { escaping_ = corrected_ = false; }
  std::string describe_bound() const override { return "the script"; }
  bool try_feasible(double alpha) override {
    feasible_asked.push_back(alpha);
    return change_at(alpha).has_value();
  }
  Change try_motion(double alpha) override {
    tried.push_back(alpha);
    return change_at(alpha);
  }
  void accept() override {
    ++accepted;
    escaping_ = corrected_ = false;
  }

  const Scene& scene() const override { return scene_; }
  Precision precision() const override { return state_.precision; }
  PositionsView x() const override { return state_.x; }
  PositionsView x_before() const override { return state_.x; }
  PositionsView gradient() const override { return scene_.v0; }
  double grad_inf() const override { return 1; }
  double energy() const override { return 1; }
  double energy(TermGroup) const override { return 1; }
  bool pattern_changed() const override { return false; }
  int n_free() const override { return 3; }
  std::size_t nnz() const override { return 6; }
  const std::vector<std::uint8_t>& fixed() const override { return state_.fixed; }
  void report(IterateNumbers&) const override {}
  void report_end(StepNumbers&) const override {}
  void report_overload(bool, StepNumbers&) const override {}
  std::string describe_non_finite() const override { return {}; }
  const StepView& view() const override { return *this; }
  bool is_on_host() const override { return true; }
  NewtonSystem& on_host() override { throw std::logic_error("a script has no matrices"); }

 private:
  Change change_at(double alpha) const {
    const auto& change = escaping_ ? now().escape_change : now().change;
    if (change) return change(alpha * length_);
    if (escaping_) return std::nullopt;
    return EnergyChange{now().slope * alpha * (2 - alpha) / 2, 1e-3};
  }
  const ScriptedIteration& now() const { return script_[static_cast<std::size_t>(std::max(place_, 0))]; }

  std::vector<ScriptedIteration> script_;
  Scene scene_;
  ScriptedState state_;
  int place_ = -1;
  bool escaping_ = false, corrected_ = false;
  double length_ = 1, secant_ = 0;
};

/// A step of line_search on a script: what it reports of the step and of every iteration. Tolerance 1e-3 m.
struct ScriptedStep : private StepObserver {
  static constexpr double tolerance = 1e-3;

  explicit ScriptedStep(std::vector<ScriptedIteration> script, SaddleRule rule = SaddleRule::escape,
                        double armijo = 0.1, int max_iterations = 40, ScriptedState state = {})
      : system(std::move(script), std::move(state)) {
    StepSolverOptions options;
    options.max_iterations = max_iterations;
    options.tol_velocity = tolerance;
    options.saddle = rule;
    options.parameters["armijo"] = armijo;
    const auto integrator = make_integrator("implicit_euler");
    History history;
    history.x = history.x_prev = system.x();
    history.v = history.a = history.v_prev = Positions::Zero(3, system.x().cols());
    StepTask task{0, 1, 1, &history, integrator.get(), [](double, Positions&) {}};
    Prediction used;
    report = make_step_solver(options)->advance(system, task, used, *this);
  }
  ScriptedSystem system;
  StepReport report;
  std::vector<IterationReport> iterations;

 private:
  void on_iteration(const IterationReport& one) override { iterations.push_back(one); }
};

}  // namespace bb::test
