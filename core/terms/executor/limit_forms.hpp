// Which strain limits have kernels.
#pragma once

#include "core/terms/term_options.hpp"

namespace bb::exec {

/// Errors: ConfigError for a barrier shape that is not in barriers/shapes (a plugin's has no kernel) and for a policy
/// without kernel; places are those below /strain_limit.
void require_limit_kernels(const TermOptions& options);

}  // namespace bb::exec
