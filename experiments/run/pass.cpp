#include "experiments/run/pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "core/base/record/provenance.hpp"
#include "core/exec/executor.hpp"
#include "core/math/stop_request.hpp"
#include "experiments/run/device_run.hpp"
#include "experiments/run/keep_record.hpp"

namespace bb {

void PassResult::StepTime::keep(Archive& archive) { archive(wall_s, phases); }

void PassResult::keep(Archive& archive) {
  archive.grown("steps", steps);
  archive(verdict.outcome, verdict.detail, whole, state_hash, wall_s, stiffness.kappa_start, stiffness.kappa,
          stiffness.doublings, stiffness.saturated);
}

Pass::Pass(const RunConfig& config, const Scene& scene, const Calibration& calibration, const Plan& plan,
           const RunOptions& options, const char* name, Recorder& recorder, int passes_after)
    : config_(config),
      options_(options),
      name_(name),
      recorder_(recorder),
      passes_after_(passes_after),
      method_(make_method(config, calibration)),
      simulation_(scene, method_, plan, config.time.dt, config.time.steps),
      t_end_(end_time(config.time) * (1 - 1e-9)) {}

void Pass::keep(Archive& archive) {
  archive.section("pass");
  archive(result_, simulation_, recorder_);
}

PassResult Pass::run(const std::function<void(Moment)>& save) {
  const int every = config_.output.checkpoint_every;
  start_s_ = now_s();
  t_begin_ = simulation_.time();
  begun_with_ = result_.steps.size();
  try {
    while (result_.verdict.outcome == Outcome::ok && simulation_.time() < t_end_) {
      if (should_stop()) {
        save(Moment::stop);
        stop();
        break;
      }
      if (can_lose_device(config_)) {
        simulation_.drop_caches();
        save(Moment::before_device);
      }
      step();
      const bool last = result_.verdict.outcome != Outcome::ok || !(simulation_.time() < t_end_);
      if (every == 0 || last || result_.steps.size() % static_cast<std::size_t>(every) != 0) continue;
      save(Moment::between);
    }
    result_.whole = result_.verdict.outcome != Outcome::timeout;
  } catch (const std::bad_alloc&) {
    cut(Outcome::oom, "memory ran out");
  } catch (const exec::OutOfMemory& error) {
    cut(Outcome::oom, error.what());
  } catch (const exec::ExecutionError& error) {
    cut(Outcome::kernel_failed, error.what());
  }
  result_.state_hash = state_hash(simulation_.history().x);
  result_.stiffness = method_.stiffness->state();
  return result_;
}

void Pass::cut(Outcome outcome, const char* what) {
  result_.verdict = {outcome, fmt::format("pass {}, step {}: {}", name_, result_.steps.size(), what)};
}

bool Pass::is_at_step_limit() const {
  return options_.step_limit > 0 &&
         result_.steps.size() >= begun_with_ + static_cast<std::size_t>(options_.step_limit);
}

bool Pass::should_stop() const {
  return is_at_step_limit() || (options_.interrupted && options_.interrupted->load()) ||
         (options_.deadline_s > 0 && now_s() >= options_.deadline_s);
}

void Pass::stop() {
  if (options_.interrupted && options_.interrupted->load()) throw Interrupted{};
  const std::string limit = is_at_step_limit() ? fmt::format("step limit of {}", options_.step_limit)
                                               : fmt::format("time limit of {:g} s", options_.time_limit_s);
  result_.verdict = {Outcome::timeout,
                     fmt::format("pass {}: the {} was reached before step {}, at {:.6g} of {:.6g} s", name_,
                                 limit, result_.steps.size(), simulation_.time(), end_time(config_.time))};
}

void Pass::step() {
  const StopDeferred until_its_end;
  const double start = now_s();
  const StepReport step = simulation_.step(recorder_);
  result_.steps.push_back({now_s() - start, step.time});
  result_.wall_s += result_.steps.back().wall_s;
  result_.verdict = judge_step(step);
  if (options_.progress) show(step);
}

void Pass::show(const StepReport& step) const {
  Progress progress;
  progress.label = options_.note;
  progress.pass = name_;
  progress.steps = config_.time.steps;
  progress.step = static_cast<int>(std::lround(step.t_s / config_.time.dt));
  progress.newton = step.newton_iterations;
  progress.contacts = step.contacts.total();
  progress.gap = step.gap_min_m;
  progress.elapsed_s = now_s() - start_s_;
  progress.t_s = simulation_.time();
  progress.t_end_s = end_time(config_.time);
  // accumulated_toi may have gone nowhere yet
  const double rate = progress.elapsed_s / std::max(progress.t_s - t_begin_, 1e-9 * progress.t_end_s);
  progress.eta_s = rate * (std::max(0.0, t_end_ - progress.t_s) + passes_after_ * progress.t_end_s);
  options_.progress(progress);
}

}  // namespace bb
