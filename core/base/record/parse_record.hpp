// Records and lines of a trace from text that is in memory already; writer.hpp has the way from a file.
#pragma once

#include <optional>
#include <string>

#include "core/base/record/run_record.hpp"

namespace bb {

/// read_run (writer.hpp) of a text; `source` is used in messages. Same errors.
std::optional<RunRecord> parse_run(const std::string& text, const std::string& source);

/// One line of trace.jsonl of this program's own version. Errors: JsonError for what is no JSON, ConfigError at
/// a field that is missing or of another type; unknown fields are left out.
TraceRow parse_trace_row(const std::string& text, const std::string& source);

}  // namespace bb
