#include "tests/features/table.hpp"
#include "core/step_solvers/registry.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/math/error.hpp"

namespace bb::features {
namespace {

Cell cell_of(const Feature& feature, const Method& method) {
  Cell out{feature.name, method.solver.name, method.entry.name, Cell::Kind::right, ""};
  if (feature.needs_inertia && method.still()) {
    out.kind = Cell::Kind::no_case;
    return out;
  }
  const auto wrong = [&out](std::string says) {
    out.kind = Cell::Kind::wrong;
    out.says = std::move(says);
    return out;
  };
  try {
    const Outcome run = run_case(feature.config(method));
    if (!run.failed.empty()) return wrong(run.failed);
    for (const std::string_view term : feature.terms) {
      if (std::count(run.terms.begin(), run.terms.end(), term) == 0)
        return wrong(fmt::format("the case has no term {}", term));
    }
    if (std::string says = feature.wrong(method, run.track); !says.empty()) return wrong(std::move(says));
  } catch (const ConfigError& error) {
    out.kind = Cell::Kind::refused;
    out.says = error.what();
  }
  return out;
}

/// The first of its reasons, whatever the step solver and the integrator are called.
std::string reason(const Cell& cell) {
  std::string out = cell.says.substr(0, cell.says.find('\n'));
  if (out.starts_with("case#")) out.erase(0, 5);
  for (const auto& [name, word] :
       {std::pair(cell.solver, "SOLVER"), std::pair(cell.integrator, "INTEGRATOR")}) {
    for (std::size_t at = out.find(name); at != std::string::npos; at = out.find(name, at + 1)) {
      const char next = at + name.size() < out.size() ? out[at + name.size()] : ' ';
      if (next != '_' && next != ',') out.replace(at, name.size(), word);
    }
  }
  return out;
}

/// A row a feature, a column a step solver, a letter an integrator.
std::string rows_of(const std::vector<Cell>& cells) {
  std::string out = "| feature |", rule = "|---|";
  for (const StepSolverEntry& solver : step_solvers()) {
    out += " " + solver.name + " |";
    rule += "---|";
  }
  out += "\n" + rule + "\n";
  for (const Feature& feature : features()) {
    out += "| " + feature.name + " |";
    for (const StepSolverEntry& solver : step_solvers()) {
      std::string right;
      char letter = 'A';
      for (const IntegratorEntry& entry : integrators()) {
        const auto is = [&](const Cell& cell) {
          return cell.feature == feature.name && cell.solver == solver.name &&
                 cell.integrator == entry.name && cell.kind == Cell::Kind::right;
        };
        right += std::any_of(cells.begin(), cells.end(), is) ? letter : '.';
        ++letter;
      }
      out += " " + right + " |";
    }
    out += "\n";
  }
  return out;
}

std::string legend() {
  std::vector<std::string> out;
  for (const IntegratorEntry& entry : integrators())
    out.push_back(fmt::format("{} {}", static_cast<char>('A' + out.size()), entry.name));
  return fmt::format("{}", fmt::join(out, ", "));
}

std::string answers() {
  std::string out;
  for (const Feature& feature : features()) out += "- " + feature.name + ": " + feature.answer + ".\n";
  return out;
}

std::string refusals(const std::vector<Cell>& cells) {
  std::map<std::string, std::set<std::string>> solvers;
  for (const Cell& cell : cells) {
    if (cell.kind == Cell::Kind::refused) solvers[reason(cell)].insert(cell.solver);
  }
  std::string out;
  for (const auto& [says, who] : solvers) out += fmt::format("- {}: `{}`\n", fmt::join(who, ", "), says);
  return out;
}

std::string failures(const std::vector<Cell>& cells) {
  std::string out;
  for (const Cell& cell : cells) {
    if (cell.kind == Cell::Kind::wrong)
      out += fmt::format("- {}, {}, {}: {}\n", cell.feature, cell.solver, cell.integrator, cell.says);
  }
  return out.empty() ? out : "\n## What is wrong\n\n" + out;
}

}  // namespace

std::vector<Cell> table() {
  std::vector<Cell> out;
  for (const Feature& feature : features()) {
    for (const StepSolverEntry& solver : step_solvers()) {
      for (const IntegratorEntry& entry : integrators()) {
        out.push_back(cell_of(feature, {solver, entry, make_integrator(entry.name)}));
      }
    }
  }
  return out;
}

std::string page(const std::vector<Cell>& cells) {
  return "# Features, step solvers, integrators\n\n"
         "Each letter is a run of a small case whose answer is known, and that answer: " +
         legend() +
         ". A dot: the program refuses the combination by name, or the case needs inertia and the integrator "
         "has none. "
         "`build/release/tests/features/feature_table` writes this page; the test `features` runs every cell "
         "again and "
         "compares.\n\n" +
         rows_of(cells) + "\n## What is known of the cases\n\n" + answers() + "\n## What is refused\n\n" +
         refusals(cells) + failures(cells);
}

}  // namespace bb::features
