// The terms of E by name: what a scene needs of each, and how it is made.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/exec/executor.hpp"
#include "core/scene/contact_plan.hpp"
#include "core/scene/scene.hpp"
#include "core/terms/term.hpp"
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

/// One line of registry.inc; the file of that name defines needs_<name>() and make_<name>().
struct TermEntry {
  std::string_view name, doc;
  bool convex;  // no element's Hessian has a negative eigenvalue, at any state
  PlanItem (*needs)(const TermNeeds&);
  /// Adds the terms, one or more, behind those of the lines before, which they may read. Called when the plan says that they are
  /// needed.
  void (*make)(const TermInputs&, TermList&);
};

/// In the order of registry.inc.
std::span<const TermEntry> term_entries();

}  // namespace bb
