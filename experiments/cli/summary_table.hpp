// The table of finished runs: `bench run` and `bench sweep` print a row a run.
#pragma once

#include <string>

#include "core/record/run_record.hpp"

namespace bb::cli {

/// A dash where there is no number.
std::string number_text(const Number& number, const char* format);

/// One row about a finished run, and what stands above it. A terminal that is too narrow has fewer columns and shorter labels.
std::string summary_row(const RunRecord& record);
std::string summary_header();

}  // namespace bb::cli
