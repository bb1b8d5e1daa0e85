// Which word a run ends with, from its last step and the audit.
#pragma once

#include <optional>
#include <string>

#include "core/base/record/outcome.hpp"
#include "core/newton/report.hpp"

namespace bb {

struct Verdict {
  Outcome outcome = Outcome::ok;
  std::string detail;
};

/// A step that did not converge; ok for one that did.
Verdict judge_step(const StepReport& step);

}  // namespace bb
