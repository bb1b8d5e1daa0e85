// Gives the program the linear solver cudss (core/linear/cudss.hpp).
#pragma once

namespace bb::cudss {

/// Before the first run. Where the build has no CUDA or no cudss.h the solver says so.
void provide();

}  // namespace bb::cudss
