#include "python/src/python_step.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/math/precision.hpp"

namespace bb::python {
namespace {

Positions poses_of(const StepTask& task) {
  Positions target = task.history->x;
  task.pose(task.dt, target);
  return target;
}

}  // namespace

PythonStep::PythonStep(NewtonSystem& system, const StepTask& task, const StepSolverOptions& options,
                       const Prediction& used, StepReport& report, StepObserver& observer)
    : system_(&system),
      report_(&report),
      observer_(&observer),
      saddle_(options.saddle),
      index_(task.step),
      max_iterations_(options.max_iterations),
      h_(task.dt),
      tolerance_(options.tol_velocity * task.dt),
      x_(system.view().x()),
      x_start_(task.history->x),
      x_tilde_(used.x_tilde),
      target_(poses_of(task)),
      gradient_(Positions::Zero(3, x_.cols())),
      fixed_(system.view().fixed()) {}

// An error of the run or of its observer ends the step, also where Python catches it.
template <class F>
auto PythonStep::call(const F& f) {
  require_open();
  try {
    return f();
  } catch (const std::exception& error) {
    fault_ = error.what();
    throw;
  }
}

void PythonStep::require_sound(const std::string& solver) const {
  if (fault_.empty()) return;
  throw std::runtime_error("step solver " + solver +
                           ": advance went on after an error inside its step: " + fault_);
}

void PythonStep::require_open() const {
  if (!system_) throw std::runtime_error("the step is over: nothing of it may be called after advance");
  if (!fault_.empty()) throw std::runtime_error("the step has failed: " + fault_);
}

void PythonStep::require_iteration() const {
  require_open();
  if (!iteration_) throw std::runtime_error("no iteration is under way: for _ in step.iterations()");
}

void PythonStep::require_direction() const {
  require_iteration();
  if (!directed_) {
    throw std::runtime_error("the iteration has no direction: step.solve(), or step.direction = ...");
  }
}

void PythonStep::require_motion() const {
  require_direction();
  if (moved_) throw std::runtime_error("the iteration has moved: begin the next one");
}

double PythonStep::energy() {
  require_iteration();
  return call([&] { return system_->view().energy(); });
}

bool PythonStep::at_target() {
  return call([&] { return system_->view().at_target(); });
}

bool PythonStep::next() {
  return call([&] {
    finish_iteration();
    if (begun_ == max_iterations_) return false;
    set_up_ = directed_ = prepared_ = moved_ = small_ = false;
    bound_.reset();
    change_.reset();
    tried_ = 0;
    end_ = {};
    iteration_ = begin_iteration(*system_, index_, begun_++);
    gradient_ = system_->view().gradient();
    return true;
  });
}

void PythonStep::set_up() {
  if (!set_up_) level_ = system_->set_up_system();
  set_up_ = true;
}

PythonStep::System PythonStep::system() {
  require_iteration();
  if (directed_) throw std::runtime_error("the iteration has a direction: request its matrix first");
  return call([&] {
    set_up();
    const Eigen::SparseMatrix<double>& lower = system_->diagnosis().solved().lower;
    const VecXd& b = system_->diagnosis().rhs();
    const auto n = lower.nonZeros();
    return System{{lower.outerIndexPtr(), lower.outerIndexPtr() + lower.cols() + 1},
                  {lower.innerIndexPtr(), lower.innerIndexPtr() + n},
                  {lower.valuePtr(), lower.valuePtr() + n},
                  {b.data(), b.data() + b.size()}};
  });
}

std::optional<std::string> PythonStep::solve() {
  require_iteration();
  if (directed_) throw std::runtime_error("the iteration has a direction already: begin the next one");
  return call([&]() -> std::optional<std::string> {
    find_direction(*system_, *iteration_, *observer_);
    take_direction();
    const auto failed = direction_failure(*iteration_, system_->view().at_target() && !small_);
    if (!failed) return std::nullopt;
    return std::string(to_string(*failed));
  });
}

void PythonStep::set_direction(const double* free, std::size_t n) {
  require_iteration();
  if (directed_) throw std::runtime_error("the iteration has a direction already: begin the next one");
  const auto n_free = static_cast<std::size_t>(std::count(fixed_.begin(), fixed_.end(), 0));
  if (n != n_free) {
    throw std::invalid_argument("direction: found " + std::to_string(n) +
                                " numbers; allowed: " + std::to_string(n_free) + ", one a free coordinate");
  }
  const Eigen::Map<const VecXd> dx_free(free, static_cast<Eigen::Index>(n));
  call([&] {
    set_up();
    Positions dx = system_->diagnosis().direction();  // prescribed vertices
    for (Eigen::Index i = 0, k = 0; i < dx.size(); ++i) {
      if (fixed_[static_cast<std::size_t>(i)] == 0) dx.data()[i] = dx_free[k++];
    }
    const auto& lower = system_->diagnosis().solved().lower;
    const VecXd& b = system_->diagnosis().rhs();
    const double left = (b - lower.selfadjointView<Eigen::Lower>() * dx_free).norm(), whole = b.norm();
    system_->set_direction(dx);
    iteration_->solve.linear.residual_true = whole > 0 ? left / whole : 0;
    iteration_->solve.t = level_;
    report_direction(*system_, *iteration_, *observer_);
    take_direction();
  });
}

// What is estimated of x + dx. Where that is within the tolerance the iterate is looked at, as the config requires.
void PythonStep::take_direction() {
  IterationReport& report = *iteration_;
  directed_ = true;
  error_.add(report.dx_beyond_m, report.solve.linear.residual_true, report.dx_rounding_m);
  report.contraction = error_.contraction();
  report.error_estimate_m = error_.error();
  small_ = error_.error() < tolerance_ && system_->view().at_target();
  if (small_ && !direction_failure(report, false)) end_ = check_end(*system_, saddle_, *report_, report);
}

Positions PythonStep::direction() {
  require_direction();
  return call([&]() -> Positions { return system_->diagnosis().direction(); });
}

double PythonStep::slope() {
  require_direction();
  return -2 * iteration_->decrement_J;
}

double PythonStep::error() {
  require_direction();
  return iteration_->error_estimate_m.value;
}

double PythonStep::bound() {
  require_motion();
  return call([&] {
    if (!bound_) {
      system_->prepare_motion(MotionEnd::on_target, true);
      bound_ = system_->bound_motion(*iteration_);
      prepared_ = true;
      change_.reset();  // a trial of before does not know of it
      tried_ = 0;
    }
    return *bound_;
  });
}

// A motion whose bound was requested is looked at up to there alone.
void PythonStep::prepare(double alpha) {
  require_motion();
  if (!(alpha > 0 && alpha <= bound_.value_or(1))) {
    throw std::invalid_argument("alpha = " + std::to_string(alpha) + ": allowed are numbers in (0, " +
                                std::to_string(bound_.value_or(1)) + "]");
  }
  call([&] {
    if (!prepared_) system_->prepare_motion(MotionEnd::on_target, false);
    prepared_ = true;
    ++iteration_->line_search_trials;
    change_.reset();
    tried_ = 0;
  });
}

std::optional<std::pair<double, double>> PythonStep::trial(double alpha) {
  prepare(alpha);
  return call([&]() -> std::optional<std::pair<double, double>> {
    change_ = system_->try_motion(alpha);
    if (!change_) return std::nullopt;
    tried_ = alpha;
    return std::pair(change_->change, rounding_of(*change_, system_->view().precision()));
  });
}

bool PythonStep::feasible(double alpha) {
  prepare(alpha);
  return call([&] {
    const bool feasible = system_->try_feasible(alpha);
    if (feasible) tried_ = alpha;
    return feasible;
  });
}

void PythonStep::accept() {
  require_motion();
  if (!(tried_ > 0)) throw std::runtime_error("the last trial was not feasible, or there was none");
  call([&] {
    IterationReport& report = *iteration_;
    report.alpha = tried_;
    report.energy_change_J = change_ ? Number(change_->change) : Number::missing(no_energies_compared);
    report.rounding_accepts =
        change_ && change_->change > 0 && within_rounding(*change_, system_->view().precision());
    system_->accept();
    moved_ = true;
    x_ = system_->view().x();
  });
}

// As line_search has it, but that a rate of convergence has to be known.
bool PythonStep::converged() {
  require_direction();
  return call([&] {
    const IterationReport& report = *iteration_;
    if (!small_ || (!report.contraction.finite() && report.dx_beyond_m > 0)) return false;
    if (moved_ && tried_ < 1 && report.dx_inf_m >= tolerance_) return false;
    return moved_ || report.dx_beyond_m == 0;
  });
}

void PythonStep::finish_iteration() {
  if (!iteration_) return;
  if (!directed_) {
    system_->set_direction(Positions::Zero(3, x_.cols()));
    report_direction(*system_, *iteration_, *observer_);
  } else {
    error_.took(iteration_->alpha);
  }
  bb::finish_iteration(*system_, *report_, *iteration_, *observer_);
  if (moved_) show_motion(*system_, index_, *observer_);
  last_ = *iteration_;
  iteration_.reset();
}

void PythonStep::finish(StepStatus status, const std::string& detail) {
  if (begun_ == 0) throw std::runtime_error("advance returned before its first iteration");
  call([&] {
    finish_iteration();
    if (status == StepStatus::converged) {
      end_converged(*report_, end_, last_.error_estimate_m, tolerance_);
    } else {
      fail_step(*system_, *report_, status, last_);
    }
    if (!detail.empty()) report_->detail = detail;
  });
}

}  // namespace bb::python
