// Every linear solver that runs without a card, with each of its preconditioners.
#pragma once

#include <string>
#include <vector>

#include "core/linear/preconditioner.hpp"
#include "core/linear/solvers/linear_solvers.hpp"

namespace bb {

struct NamedSolver {
  std::string name;
  LinearOptions options;
};

inline std::vector<NamedSolver> every_solver() {
  std::vector<NamedSolver> out;
  for (const std::string& name : linear_solvers().names()) {
    if (name == "cudss") continue;
    if (name == "pcg") {
      for (const std::string& with : preconditioners().names())
        out.push_back({name + " " + with, {name, {{"preconditioner", with}}}});
    } else if (name == "pcg_resident") {
      for (const char* with : {"block_jacobi", "multilevel_schwarz"})
        out.push_back({name + " " + with, {name, {{"resident_preconditioner", with}}}});
    } else {
      out.push_back({name, {name, {}}});
    }
  }
  return out;
}

}  // namespace bb
