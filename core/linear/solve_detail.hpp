// What a message needs beside the status of an iterative solve.
#pragma once

#include <string>

#include "core/linear/linear_solver.hpp"

namespace bb {

/// Numbers of the report in words; empty for a status that says all.
std::string solve_detail(const LinearReport& report);

}  // namespace bb
