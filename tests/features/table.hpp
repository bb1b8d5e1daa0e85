// The table feature x step solver x integrator: every cell that the program accepts, run.
#pragma once

#include "core/terms/registry.hpp"
#include "tests/features/feature.hpp"

namespace bb::features {

struct Cell {
  std::string feature, solver, integrator;
  enum class Kind { right, wrong, refused, no_case } kind = Kind::right;
  std::string says;  // what is wrong; the message of the refusal
};

/// Of the registries as they are. Cost: seconds.
std::vector<Cell> table();
/// As a page, docs/step_solver_features.md.
std::string page(const std::vector<Cell>& cells);

}  // namespace bb::features
