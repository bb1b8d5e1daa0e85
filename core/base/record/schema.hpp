// What the lists of fields report of run.json and trace.jsonl, for tools and readers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/record/solver_counts.hpp"

namespace bb {

/// JSON Schema (2020-12) of run.json and of a line of trace.jsonl. counters: those of all step solvers.
std::string run_schema(const std::vector<SolverCounter>& counters);
std::string trace_schema();

/// Data dictionary: every field of run.json and trace.jsonl with place, unit, meaning, allowed words and why
/// it may be absent. One line a field.
std::string run_dictionary(const std::vector<SolverCounter>& counters);
std::string trace_dictionary();

/// The unit that the end of a field's name says ("_N_per_m": "N/m"); "" for none.
std::string_view unit_of(std::string_view name);

}  // namespace bb
