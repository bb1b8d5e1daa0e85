#include "core/terms/step_hessian.hpp"

#include <stdexcept>

#include "core/terms/registry.hpp"
#include "core/terms/term_options.hpp"

namespace bb {
namespace {

std::vector<HessianChoice> choices() {
  std::vector<std::string> allowed;
  for (const StepHessian each : all_step_hessians) allowed.emplace_back(to_string(each));
  std::vector<HessianChoice> out;
  for (const TermEntry& entry : term_entries()) {
    if (entry.convex) continue;
    const std::string name(entry.name);
    out.push_back({name,
                   {{name,
                     computed(word(allowed),
                              "blend with step solvers line_search, penalty, augmented_lagrangian and "
                              "al_barrier, else clamped"),
                     no_default, "Hessian in the Newton matrix; " + std::string(entry.doc) + "."}}});
  }
  return out;
}

}  // namespace

std::string_view to_string(StepHessian hessian) {
  constexpr std::string_view words[] = {"clamped", "absolute", "exact_or_clamped", "progressive", "blend"};
  return words[static_cast<std::size_t>(hessian)];
}

StepHessian step_hessian_of(std::string_view word) {
  for (const StepHessian each : all_step_hessians) {
    if (word == to_string(each)) return each;
  }
  throw std::logic_error("no Hessian of a step is called " + std::string(word));
}

bool knows_exact_hessian(std::string_view term, const TermOptions& options) {
  return term != "contact" || options.hessian_mode != HessianMode::gauss_newton;
}

const std::vector<HessianChoice>& hessian_choices() {
  static const std::vector<HessianChoice> all = choices();
  return all;
}

}  // namespace bb
