// The terms of E by name: what a scene needs of each, and how it is made.
#pragma once

#include <span>
#include <string_view>

#include "core/terms/host_term.hpp"
#include "core/terms/term_inputs.hpp"

namespace bb {

/// One line of registry.inc; the file of that name defines needs_<name>() and make_<name>().
struct TermEntry {
  std::string_view name, doc;
  bool convex;  // no element's Hessian has a negative eigenvalue, at any state
  PlanItem (*needs)(const TermNeeds&);
  /// Adds the terms, one or more, behind those of the lines before, which they may read. Called when the plan states that they are
  /// needed.
  void (*make)(const TermInputs&, TermList&);
};

/// In the order of registry.inc.
std::span<const TermEntry> term_entries();

}  // namespace bb
