#include "core/step_solvers/position_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/math/error.hpp"
#include "core/newton/iteration.hpp"
#include "core/newton/newton_system.hpp"

namespace bb {
namespace {

// f(k, at): entry k of the gradient belongs to number `at` of the positions.
template <class F>
void for_each_number(const ConstraintBatch& batch, std::size_t e, const F& f) {
  const auto width = static_cast<std::size_t>(batch.width());
  for (std::size_t a = 0; a < width; ++a) {
    const int vertex = batch.vertices()[width * e + a];
    for (std::size_t k = 0; vertex >= 0 && k < 3; ++k)
      f(3 * a + k, 3 * Eigen::Index{vertex} + static_cast<Eigen::Index>(k));
  }
}

}  // namespace

void PositionSweeps::require(StepSystem& system, std::string_view solver) {
  require_on_host(system, solver);
  system.on_host().constraints().require_constraints();
}

StepReport PositionSweeps::sweep(StepSystem& system, const StepTask& task, Prediction& used,
                                 const ConstraintRule& rule, int sweeps) {
  StepReport step = start_step(system, task, used);
  ConstraintSystem& constraints = system.on_host().constraints();
  Positions given = task.history->x;
  task.pose(task.dt, given);
  state_ = constraints.free_motion(given);
  multipliers_.clear();
  last_ = {};
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const auto& batches = constraints.find(state_.x, Inequalities::rigid);
    carry_over(batches);
    last_ = {};
    for (std::size_t b = 0; b < batches.size(); ++b) {
      last_.correction_m = std::max(last_.correction_m, solve(*batches[b], rule, multipliers_[b]));
      last_.constraints += static_cast<double>(batches[b]->size());
    }
    if (!state_.x.allFinite()) break;
  }
  return step;
}

// Of constraints that come and go those of the ones that stay.
void PositionSweeps::carry_over(const std::vector<const ConstraintBatch*>& batches) {
  multipliers_.resize(batches.size());
  for (std::size_t b = 0; b < batches.size(); ++b) {
    before_.swap(multipliers_[b]);
    multipliers_[b].assign(batches[b]->size(), 0.0);
    for (std::size_t e = 0; e < multipliers_[b].size() && !before_.empty(); ++e) {
      const std::ptrdiff_t was = batches[b]->before(e);
      if (was >= 0) multipliers_[b][e] = before_[static_cast<std::size_t>(was)];
    }
  }
}

double PositionSweeps::solve(const ConstraintBatch& batch, const ConstraintRule& rule,
                             std::vector<double>& multipliers) {
  gradient_.resize(3 * static_cast<std::size_t>(batch.width()));
  double largest = 0;
  for (std::size_t e = 0; e < batch.size(); ++e) {
    const double value = batch.value(e, state_.x, gradient_.data()), compliance = batch.compliance()[e];
    double sum = rule.softness(compliance);
    for_each_number(batch, e, [&](std::size_t k, Eigen::Index at) {
      sum += state_.inverse.data()[at] * gradient_[k] * gradient_[k];
    });
    if (!(sum > 0) || std::isinf(compliance)) continue;  // nothing of it can move
    const double change = rule.change(batch.kind(), value, compliance, sum, multipliers[e]);
    for_each_number(batch, e, [&](std::size_t k, Eigen::Index at) {
      state_.x.data()[at] += state_.inverse.data()[at] * gradient_[k] * change;
    });
    largest = std::max(largest, std::abs(change) * sum);
  }
  return largest;
}

PositionSweeps::Left PositionSweeps::left(StepSystem& system) {
  Left out;
  if (!state_.x.allFinite()) return out;
  for (const ConstraintBatch* batch : system.on_host().constraints().find(state_.x, Inequalities::rigid)) {
    gradient_.resize(3 * static_cast<std::size_t>(batch->width()));
    for (std::size_t e = 0; e < batch->size(); ++e) {
      if (std::isinf(batch->compliance()[e])) continue;
      const double value = batch->value(e, state_.x, gradient_.data());
      if (batch->kind() == ConstraintKind::equality) {
        out.equality_m = std::max(out.equality_m, std::abs(value));
      } else {
        out.overlap_m = std::max(out.overlap_m, -value);
      }
    }
  }
  return out;
}

void PositionSweeps::end_there(StepSystem& system, StepReport& step, StepObserver& observer) {
  NewtonSystem& host = system.on_host();
  host.set_direction(state_.x - system.view().x());
  system.prepare_motion(MotionEnd::on_target, false);
  if (!system.try_feasible(1)) {
    step.status = StepStatus::non_finite;
    step.detail = "the state after the last sweep";
    return;
  }
  system.accept();
  show_motion(system, step.step, observer);
  step.status = StepStatus::converged;
}

}  // namespace bb
