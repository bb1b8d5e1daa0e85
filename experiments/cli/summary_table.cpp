#include "experiments/cli/summary_table.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "core/base/input/names.hpp"
#include "experiments/cli/terminal.hpp"

namespace bb::cli {

std::string number_text(const Number& number, const char* format) {
  return number.finite() ? fmt::format(fmt::runtime(format), number.value) : "-";
}

namespace {

std::string cond_text(const RunRecord& record, const std::string& key) {
  const auto found = record.summary.cond.find(key);
  if (found == record.summary.cond.end() || !found->second.log10_cond.max.finite()) return "-";
  const double largest = found->second.log10_cond.max.value;
  if (largest >= 14) return ">1e14";  // the largest that is claimed, and what a singular matrix counts with
  return fmt::format("{}1e{:.2f}", found->second.statuses.contains("lower_bound") ? ">" : "", largest);
}

struct SummaryColumn {
  const char* title;
  std::size_t width;
  bool is_needed;  // others are left out, the last one first, where the terminal is too narrow for all
  std::string (*cell)(const RunRecord&);
};

std::string crossings_text(const RunRecord& record) {
  return record.audit.enabled ? fmt::format("{}", record.audit.crossings + record.audit.violations) : "-";
}

constexpr std::size_t reason_indent = 4;
constexpr std::size_t label_width = 44, least_label_width = 24;
const SummaryColumn summary_columns[] = {
    {"outcome", 18, true, [](const RunRecord& r) { return std::string(to_string(r.status.outcome)); }},
    {"steps", 6, true, [](const RunRecord& r) { return fmt::format("{}", r.summary.steps); }},
    {"newton", 7, true, [](const RunRecord& r) { return fmt::format("{}", r.summary.newton_iterations); }},
    {"cond max", 9, false, [](const RunRecord& r) { return cond_text(r, "full/none"); }},
    {"cond bj", 9, false, [](const RunRecord& r) { return cond_text(r, "full/block_jacobi"); }},
    {"gap/d_hat", 9, false,
     [](const RunRecord& r) { return number_text(r.summary.gap_min_rel.min, "{:.3g}"); }},
    {"stretch", 9, false, [](const RunRecord& r) { return number_text(r.summary.max_stretch, "{:.4f}"); }},
    {"crossings", 9, true, crossings_text},
    {"time s", 8, true, [](const RunRecord& r) { return number_text(r.summary.wall_s, "{:.2f}"); }},
};

/// A line of the table: what stands in each of the columns that fit on the terminal.
std::string summary_line(const std::string& label,
                         const std::function<std::string(const SummaryColumn&)>& cell) {
  const std::size_t columns = terminal_columns(STDOUT_FILENO);
  std::vector<const SummaryColumn*> shown;
  std::size_t width = 0;
  const auto has_room = [&](std::size_t more) {
    return columns == 0 || least_label_width + width + more <= columns;
  };
  for (const SummaryColumn& column : summary_columns) width += column.is_needed ? column.width + 1 : 0;
  for (const SummaryColumn& column : summary_columns) {
    if (!column.is_needed && !has_room(column.width + 1)) continue;
    width += column.is_needed ? 0 : column.width + 1;
    shown.push_back(&column);
  }
  const std::size_t room = has_room(label_width - least_label_width) ? label_width
                           : columns > width + least_label_width     ? columns - width
                                                                     : least_label_width;
  std::string out = fmt::format("{:<{}}", columns == 0 ? label : shortened_to(label, room), room);
  for (const SummaryColumn* column : shown) {
    out += column == &summary_columns[0] ? fmt::format(" {:<{}}", cell(*column), column->width)
                                         : fmt::format(" {:>{}}", cell(*column), column->width);
  }
  return out;
}

}  // namespace

std::string summary_header() {
  return summary_line("run", [](const SummaryColumn& column) { return std::string(column.title); });
}

std::string summary_row(const RunRecord& record) {
  return summary_line(printable(record.labels.note),
                      [&](const SummaryColumn& column) { return column.cell(record); });
}

std::string comparability_table(std::vector<ComparedRow> rows, std::size_t columns) {
  rows.insert(rows.begin(), {"run", "outcome", "comparability", ""});
  std::size_t outcome = 0, verdict = 0, run = 0;
  for (ComparedRow& row : rows) {
    row.run = printable(row.run);
    outcome = std::max(outcome, row.outcome.size());
    verdict = std::max(verdict, row.verdict.size());
  }
  const std::size_t others = outcome + verdict + 4;  // two blanks before each
  const auto fits = [&](const std::string& text) {
    return columns == 0 || characters(text) + others <= columns;
  };
  for (const ComparedRow& row : rows) {
    if (fits(row.run)) run = std::max(run, characters(row.run));
  }
  std::string out;
  const auto add = [&](const std::string& line) { out += wrapped(line, columns, reason_indent) + '\n'; };
  for (const ComparedRow& row : rows) {
    const bool is_beside = fits(row.run);
    if (!is_beside) add(row.run);
    const std::string name = is_beside ? row.run : "";
    out += name + std::string(run - characters(name), ' ') +
           fmt::format("  {:<{}}  {}\n", row.outcome, outcome, row.verdict);
    if (!row.why.empty()) add(std::string(reason_indent, ' ') + row.why);
  }
  return out;
}

}  // namespace bb::cli
