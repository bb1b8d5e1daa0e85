// Which launches of a counting executor are those of conjugate gradients.
#pragma once

#include "core/exec/metered_executor.hpp"

namespace bb::exec {

/// Launches outside graphs of conjugate gradients and their preconditioners: of the kernels of this module.
inline Index solver_launches(const ExecutionCounts& counts) {
  Index out = -counts.replayed;  // by_kernel has those of graphs too
  for (const auto& [name, of] : counts.by_kernel) {
    for (const char* part : {"::MultiplyDot", "::MagnitudeDot", "::SetResidual", "::FinishSum", "::BeginRun",
                             "::StepDirection", "BlockJacobi", "::FactorizeDiagonal", "::BlockNorms",
                             "::CoarseValues", "::UpdateResidual", "::AddLevels", "Clusters"}) {
      if (name.find(part) == std::string::npos) continue;
      out += of.launches;
      break;
    }
  }
  return out;
}

}  // namespace bb::exec
