#include "experiments/validity/block.hpp"

#include <fmt/format.h>

#include <exception>

namespace bb {
namespace {

struct Entry {
  const char *name, *meaning;
  double bound;
  void (*run)(BlockCheck&);
};

constexpr Entry entries[] = {
    {"linear_solvers", "relative error of every solver and preconditioner on a matrix with a known solution",
     1e-7, check_solvers},
    {"condition_estimators", "relative error of cond of every estimator on a matrix with a known spectrum",
     1e-3, check_estimators},
    {"singular_matrices", "matrices that are singular or indefinite and are called ok", 0, check_singular},
    {"shape_derivatives", "b' and b'' of every shape against differences, relative to their largest", 1e-6,
     check_shape_derivatives},
    {"gradient", "gradient of E with active contacts against differences of E", 1e-6, check_gradient},
    {"hessian", "exact Hessian of E with active contacts against differences of the gradient", 1e-6,
     check_hessian},
    {"symmetry", "departure from symmetry of those differences, relative to the largest entry", 1e-6,
     check_symmetry},
    {"ccd", "pairs that pass through each other and are not stopped before", 0, check_ccd},
    {"predicates", "wrong signs of orient2d and orient3d on nearly degenerate points", 0, check_predicates},
    {"resting_block", "gap at rest of every shape against kappa |b'(d)| = load", 1e-6, check_resting_block},
    {"momentum", "change of momentum in a free impact, relative to that of one body", 1e-9, check_momentum},
    {"repetition",
     "runs whose final state differs from that of the same run, also with another number of threads", 0,
     check_repetition},
};

}  // namespace

void BlockCheck::judge(double found, const std::string& subject) {
  ++subjects;
  const bool beyond = !(found <= bound);
  if (beyond && detail.empty()) detail = fmt::format("{}: {:.3g}", subject, found);
  if (!value.finite() || found <= value.value) return;
  value = found;
}

std::vector<std::string> block_names() {
  std::vector<std::string> names;
  for (const Entry& entry : entries) names.push_back(entry.name);
  return names;
}

std::vector<BlockCheck> compute_block() {
  std::vector<BlockCheck> checks;
  for (const Entry& entry : entries) {
    BlockCheck check{entry.name, entry.meaning, entry.bound, 0.0, 0, ""};
    try {
      entry.run(check);
    } catch (const std::exception& error) {
      check.detail = error.what();
    }
    checks.push_back(std::move(check));
  }
  return checks;
}

}  // namespace bb
