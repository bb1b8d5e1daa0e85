// NVIDIA's cuDSS as a linear solver. No header of the library: without it, or without CUDA, absent.cpp answers.
#pragma once

#include <memory>
#include <string>

#include "core/linear/linear_solver.hpp"

namespace bb::cudss {

/// What this build or this machine lacks, and what to do; empty: nothing. Cost: a library is loaded and a kernel is run.
std::string missing();

/// Called where nothing is missing.
std::unique_ptr<LinearSolver> make_solver();

}  // namespace bb::cudss
