#include "core/linear/cost_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/linear/cholmod_factor.hpp"

namespace bb {
namespace {

std::vector<std::size_t> by_seconds(const std::vector<LinearCost>& costs, const LinearWork& work) {
  std::vector<std::size_t> order(costs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return costs[a].seconds(work) < costs[b].seconds(work);
  });
  return order;
}

}  // namespace

LinearWork linear_work(const ReducedSystem& pattern) {
  LinearWork work;
  work.unknowns = static_cast<double>(pattern.lower.rows());
  work.entries = static_cast<double>(pattern.lower.nonZeros());
  if (pattern.lower.rows() == 0) return work;
  CholmodFactor factor;
  try {
    factor.analyze(pattern);
    work.factor_entries = factor.factor_nonzeros();
    work.factor_flop = factor.factor_flops();
  } catch (const FactorTooLarge&) {  // no solver that factorises is a choice
    work.factor_entries = work.factor_flop = 1e30;
  }
  return work;
}

WorkTerms work_terms(const LinearWork& work) {
  return {1, work.entries, work.entries * std::sqrt(work.unknowns), work.factor_entries, work.factor_flop};
}

double LinearCost::seconds(const LinearWork& work) const {
  const WorkTerms terms = work_terms(work);
  return std::inner_product(terms.begin(), terms.end(), seconds_each.begin(), 0.0);
}

std::size_t cheapest(const std::vector<LinearCost>& costs, const LinearWork& work) {
  return by_seconds(costs, work).at(0);
}

std::string cost_text(const std::vector<LinearCost>& costs, const LinearWork& work) {
  std::string text;
  for (const std::size_t i : by_seconds(costs, work)) {
    const LinearCost& cost = costs[i];
    text +=
        fmt::format("{}{}{} {:.3g} s", text.empty() ? "" : ", ", cost.solver,
                    cost.preconditioner.empty() ? "" : " with " + cost.preconditioner, cost.seconds(work));
  }
  return text;
}

}  // namespace bb
