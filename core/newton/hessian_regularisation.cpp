#include "core/newton/hessian_regularisation.hpp"

#include <algorithm>
#include <limits>

#include "core/math/lower_blocks.hpp"
#include "core/math/parallel.hpp"

namespace bb {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double first_t = 0.125;            // then 1/4, 1/2, 1
constexpr double smallest_threshold = 1e-3;  // of the largest force; below it every element is clamped

/// Clamped elements where a vertex has a force of at least the threshold, exact ones elsewhere.
void choose(const TermFamily& family, std::span<const double> force, double threshold,
            std::vector<double>& out) {
  const auto width = static_cast<std::size_t>(family.stencils.width);
  const std::size_t stride = n_lower_numbers(width);
  out.resize(family.local.hess.size());
  parallel_items(family.stencils.size(), block_items, [&](std::size_t e) {
    const auto vertices = family.stencils.vertices.subspan(width * e, width);
    const bool clamp = std::any_of(vertices.begin(), vertices.end(), [&](int vertex) {
      return vertex >= 0 && force[static_cast<std::size_t>(vertex)] >= threshold;
    });
    std::copy_n((clamp ? family.clamped.hess : family.local.hess).data() + stride * e, stride,
                out.data() + stride * e);
  });
}

}  // namespace

HessianRegularisation::HessianRegularisation(const std::vector<StepHessian>& choices) : choices_(choices) {
  reset();
}

void HessianRegularisation::reset() {
  t_ = 0;
  threshold_ = infinity;
}

bool HessianRegularisation::has(StepHessian choice) const {
  return std::find(choices_.begin(), choices_.end(), choice) != choices_.end();
}

void HessianRegularisation::raise(double residual) {
  // exact_or_clamped knows two levels only: where nothing blends, t goes all the way
  t_ = has(StepHessian::blend) ? std::min(1.0, t_ == 0 ? first_t : 2 * t_) : 1;
  threshold_ = threshold_ == infinity ? residual / 2 : threshold_ / 2;
  if (!(threshold_ >= smallest_threshold * residual)) threshold_ = 0;
}

void HessianRegularisation::lower(double residual) {
  t_ = has(StepHessian::blend) && t_ > first_t ? t_ / 2 : 0;
  threshold_ = 2 * std::max(threshold_, smallest_threshold * residual);
  if (threshold_ >= residual) threshold_ = infinity;
}

bool HessianRegularisation::exact() const { return t_ == 0 && threshold_ == infinity; }

bool HessianRegularisation::last() const {
  const bool to_blend = has(StepHessian::blend) || has(StepHessian::exact_or_clamped);
  return (!to_blend || t_ == 1) && (!has(StepHessian::progressive) || threshold_ == 0);
}

bool HessianRegularisation::all_clamped() const { return !has(StepHessian::absolute) && last(); }

bool needs_clamped(StepHessian choice, const HessianRegularisation& level) {
  if (choice == StepHessian::progressive) return level.threshold() < infinity;
  return (choice == StepHessian::blend || choice == StepHessian::exact_or_clamped) && level.t() > 0;
}

LocalHessians hessian_at(const TermFamily& family, StepHessian choice, const HessianRegularisation& level,
                         std::span<const double> force, std::vector<double>& buffer) {
  if (!needs_clamped(choice, level)) return family.local.hess;
  if (choice == StepHessian::progressive) {
    if (level.threshold() == 0) return family.clamped.hess;
    choose(family, force, level.threshold(), buffer);
    return buffer;
  }
  if (choice == StepHessian::exact_or_clamped || level.t() == 1) return family.clamped.hess;
  return {family.local.hess, family.clamped.hess, level.t()};
}

}  // namespace bb
