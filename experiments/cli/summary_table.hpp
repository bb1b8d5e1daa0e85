// The table of finished runs: `bench run` and `bench sweep` print a row a run.
#pragma once

#include <string>
#include <vector>

#include "core/base/record/run_record.hpp"

namespace bb::cli {

/// A dash where the number is missing.
std::string number_text(const Number& number, const char* format);

/// One row about a finished run, and what stands above it. A terminal that is too narrow has fewer columns and shorter labels.
std::string summary_row(const RunRecord& record);
std::string summary_header();

/// What is reported of a run of a sweep when all are over.
struct ComparedRow {
  std::string run, outcome, verdict, why;  // why: empty of a comparable run
};
/// The runs with their verdicts, a heading above them; the reason stands in lines of its own below its run, and a run whose name
/// leaves no space for the other columns in a line of its own above them. No line is longer than so many characters but for a word
/// or a verdict that is, and every word is there; 0: lines of any length.
std::string comparability_table(std::vector<ComparedRow> rows, std::size_t columns);

}  // namespace bb::cli
