// The validity block of a build: checks with known answers, made once before any number of this program is believed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/record/number.hpp"

namespace bb {

/// One check of the block. It passes when it judged something and everything it judged keeps the bound.
struct BlockCheck {
  std::string name, meaning;
  double bound = 0;    // on the largest `value`
  Number value = 0.0;  // the largest found
  long long subjects = 0;
  std::string detail;  // of the first subject beyond the bound, or of an error
  bool pass() const { return subjects > 0 && value.finite() && value.value <= bound && detail.empty(); }

  /// Judges one subject: `found` beyond the bound, or not finite, is a failure with the name of the subject.
  void judge(double found, const std::string& subject);
};

/// All checks, in the order of block.cpp. A check that throws fails with its message.
/// Errors: none.   Cost: about a second.
std::vector<BlockCheck> compute_block();
/// Their names.
std::vector<std::string> block_names();

// --- the checks, one file each group
void check_solvers(BlockCheck& check);            // linear_checks.cpp
void check_estimators(BlockCheck& check);         // linear_checks.cpp
void check_singular(BlockCheck& check);           // linear_checks.cpp
void check_shape_derivatives(BlockCheck& check);  // barrier_checks.cpp
void check_gradient(BlockCheck& check);           // assembly_checks.cpp
void check_hessian(BlockCheck& check);            // assembly_checks.cpp
void check_symmetry(BlockCheck& check);           // assembly_checks.cpp
void check_ccd(BlockCheck& check);                // geometry_checks.cpp
void check_predicates(BlockCheck& check);         // geometry_checks.cpp
void check_resting_block(BlockCheck& check);      // run_checks.cpp
void check_momentum(BlockCheck& check);           // run_checks.cpp
void check_repetition(BlockCheck& check);         // run_checks.cpp

}  // namespace bb
