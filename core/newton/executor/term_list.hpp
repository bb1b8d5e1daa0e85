// The terms of E on an executor, from the list that has those of the host (core/terms/registry.inc).
#pragma once

#include "core/terms/executor/term_inputs.hpp"
#include "core/terms/plan.hpp"

namespace bb::exec {

/// The terms that the plan needs, in the order of registry.inc. Errors: ConfigError at /device for a term whose line states
/// host_only, and those of each term; OutOfMemory.
ExecutorTerms make_terms_on_executor(const Plan& plan, const ExecutorInputs& inputs);

}  // namespace bb::exec
