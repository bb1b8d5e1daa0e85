// The terms of a scene with stencils that stay in the engine of the host, evaluated as OnExecutor is.
#pragma once

#include "core/newton/host_engine.hpp"
#include "tests/executor/term_cases.hpp"

namespace bb::test {

/// Without terms whose rows come and go.
inline Plan plan_of_fixed_stencils(const Scene& scene, const TermOptions& options) {
  Plan plan = make_plan(scene, options, {});
  for (std::size_t i = 0; i < plan.terms.size(); ++i) {
    for (const char* name : {"contact", "friction", "restitution"}) {
      if (term_entries()[i].name == name) plan.terms[i].needed = false;
    }
  }
  plan.linear_solver.needed = false;
  return plan;
}

class OnHost {
 public:
  /// choice: of every term.
  OnHost(const Scene& scene, Method given, const StepFrame& frame, StepHessian choice = StepHessian::clamped)
      : method_(with(std::move(given), choice)),
        plan_(plan_of_fixed_stencils(scene, method_)),
        fixed_(3 * scene.mass.size(), 0),
        engine_(scene, method_, plan_, fixed_, clock_) {
    for (Column* column : {&x_, &trial_, &dx_, &g_, &force_}) column->fit(scene.rest.size());
    begin_step(frame);
  }
  const Plan& plan() const { return plan_; }
  void begin_step(const StepFrame& frame) {
    frame_ = frame;
    engine_.begin_step(frame_);
  }
  void change_step(const StepFrame& frame) {
    frame_ = frame;
    engine_.change_step(frame_);
  }
  void end_step(const Positions& x) {
    put(x_, x);
    engine_.end_step(x_);
  }
  void linearise(const Positions& x) {
    put(x_, x);
    engine_.linearise(x_, g_);
  }
  Positions gradient() const { return points(g_); }
  double energy(TermSet set) { return engine_.energy(set, x_); }
  IterateNumbers report() {
    IterateNumbers out;
    engine_.report(x_, out);
    return out;
  }
  /// After linearise(). force: [n_vertices] N.
  Eigen::MatrixXd matrix(const HessianRegularisation& level, const std::vector<double>& force) {
    force_.upload(force);
    engine_.fill_matrix(x_, level, force_);
    const Eigen::Index n = x_.size();
    Eigen::MatrixXd out(n, n);
    Positions unit = Positions::Zero(3, n / 3);
    for (Eigen::Index j = 0; j < n; ++j) {
      unit.data()[j] = 1;
      put(dx_, unit);
      unit.data()[j] = 0;
      engine_.multiply(dx_, trial_);
      out.col(j) = VecXd::Map(trial_.data(), n);
    }
    return out;
  }
  double bound(const Positions& dx, IterationReport& report) {
    put(dx_, dx);
    put(trial_, points(x_) + dx);
    return engine_.bound(x_, trial_, dx_, report);
  }
  bool is_feasible(const Positions& to) {
    put(trial_, to);
    return engine_.is_feasible(x_, trial_);
  }
  /// Of the trial that was admitted last.
  EnergyChange change() { return engine_.change(x_, trial_); }
  void accept() {
    engine_.accept();
    x_.swap(trial_);
  }

 private:
  static Method with(Method method, StepHessian choice) {
    for (const TermEntry& term : term_entries()) method.step_hessian[std::string(term.name)] = choice;
    return method;
  }
  static void put(Column& to, const Positions& x) {
    to.upload({x.data(), static_cast<std::size_t>(x.size())});
  }

  Method method_;
  Plan plan_;
  std::vector<std::uint8_t> fixed_;
  PhaseClock clock_;
  HostEngine engine_;
  StepFrame frame_;
  Column x_{engine_.executor(), "x"}, trial_{engine_.executor(), "trial"}, dx_{engine_.executor(), "dx"},
      g_{engine_.executor(), "g"}, force_{engine_.executor(), "force"};
};

}  // namespace bb::test
