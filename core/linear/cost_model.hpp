// What a linear solve is expected to take on one machine, for each solver: a sum of work terms, each with a
// coefficient in seconds that was fitted to measured runs (./bench fit-linear).
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/linear/linear_solver.hpp"

namespace bb {

/// What a pattern asks of a solver, whatever the values.
struct LinearWork {
  double unknowns = 0, entries = 0;            // degrees of freedom; entries of the lower triangle
  double factor_entries = 0, factor_flop = 0;  // of a Cholesky factor, ordered as CholmodFactor does
};

/// Cost: an ordering and a symbolic analysis. Errors: those of CholmodFactor::analyze.
LinearWork linear_work(const ReducedSystem& pattern);

/// A solve; its matrix; conjugate gradients, whose iterations on a mesh in the plane grow like the root of its
/// vertices; triangular solves; factorisation.
inline constexpr std::array<std::string_view, 5> work_term_names = {"solve", "entry", "entry_sqrt_unknown",
                                                                    "factor_entry", "factor_flop"};
using WorkTerms = std::array<double, work_term_names.size()>;
WorkTerms work_terms(const LinearWork& work);

/// One solver of a model.
struct LinearCost {
  std::string solver, preconditioner;  // names; preconditioner empty for a solver without
  WorkTerms seconds_each{};            // coefficients, >= 0
  double seconds(const LinearWork& work) const;
};

/// The index of the cheapest, of several the first. Requires one.
std::size_t cheapest(const std::vector<LinearCost>& costs, const LinearWork& work);

/// "lagged_cholesky 0.0123 s, cholmod 0.0234 s, pcg with ic0 0.2 s", the cheapest first.
std::string cost_text(const std::vector<LinearCost>& costs, const LinearWork& work);

}  // namespace bb
