// What terms are made from, and what decides whether they are needed.
#pragma once

#include <cstdint>
#include <vector>

#include "core/exec/executor.hpp"
#include "core/model/scene/contact_plan.hpp"
#include "core/model/scene/scene.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

/// What a term decides from whether it is needed.
struct TermNeeds {
  const Scene& scene;
  const TermOptions& options;
  const ContactPlan& contacts;
};

/// What a term is made from. All of it outlives the term.
struct TermInputs {
  exec::Executor& executor;  // families are in its memory, which has to be the host's
  const Scene& scene;
  TermOptions& options;
  const ContactPlan& contacts;
  const std::vector<std::uint8_t>& fixed;  // [3 n] prescribed or locked degrees of freedom
};

}  // namespace bb
