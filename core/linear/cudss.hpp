// The linear solver cudss, whose code is in a room above this one (core/cudss): a program that has it gives it here.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/linear/linear_solver.hpp"

namespace bb {

struct CudssBackend {
  /// What this build or this machine lacks, and what to do; empty: nothing.
  std::string (*missing)() = nullptr;
  /// Called where nothing is missing.
  std::unique_ptr<LinearSolver> (*make)() = nullptr;
};

/// Before the first run.
void set_cudss(CudssBackend backend);

/// What this build or this machine lacks to run a linear solver; empty for those that run everywhere, and for unknown
/// names. Cost: with cudss a library is loaded and a kernel is run.
std::string missing_for(std::string_view solver);

/// Errors: ConfigError at /linear_solver/name with what is missing.
void require_usable(const std::string& solver);

}  // namespace bb
