// Every feature with every step solver and every integrator, on a case whose answer is known: it is right, or refused by name.
#include <gtest/gtest.h>

#include <set>

#include "core/step_solvers/registry.hpp"
#include "tests/features/table.hpp"
#include "tests/folders.hpp"

namespace bb::features_test {
namespace {

using features::Cell;

const std::vector<Cell>& cells() {
  static const std::vector<Cell> all = features::table();
  return all;
}

std::string name_of(const Cell& cell) { return cell.feature + ", " + cell.solver + ", " + cell.integrator; }

TEST(Features, AreRightWithEveryStepSolverAndIntegratorThatTakesThem) {
  std::set<std::string> used;
  for (const Cell& cell : cells()) {
    EXPECT_NE(cell.kind, Cell::Kind::wrong) << name_of(cell) << ": " << cell.says;
    if (cell.kind == Cell::Kind::right) used.insert({cell.feature, cell.solver, cell.integrator});
  }
  for (const auto& feature : features::features()) {
    EXPECT_TRUE(used.contains(feature.name)) << feature.name;
  }
  for (const auto& each : integrators()) {
    EXPECT_TRUE(used.contains(each.name)) << each.name;
  }
  for (const auto& each : step_solvers()) {
    const bool taken = each.settings.protocol.empty();  // others have scenes of their own
    EXPECT_EQ(used.contains(each.name), taken) << each.name;
  }
}

TEST(Features, AreRefusedByTheNameOfTheStepSolverOrTheIntegrator) {
  std::size_t refused = 0;
  for (const Cell& cell : cells()) {
    if (cell.kind != Cell::Kind::refused) continue;
    ++refused;
    const auto names = [&cell](const std::string& name) { return cell.says.find(name) != std::string::npos; };
    EXPECT_TRUE(names(cell.solver) || names(cell.integrator)) << name_of(cell) << ": " << cell.says;
  }
  EXPECT_GT(refused, 100u);
}

// A term of E that no case has is a feature without a row.
TEST(Features, HaveEveryTermOfTheEnergy) {
  std::set<std::string_view> had;
  for (const auto& feature : features::features()) had.insert(feature.terms.begin(), feature.terms.end());
  for (const TermEntry& term : term_entries()) {
    EXPECT_TRUE(had.contains(term.name)) << term.name;
  }
}

TEST(Features, AreThoseOfThePage) {
  std::ifstream file(BB_SOURCE_DIR "/docs/step_solver_features.md");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(page, features::page(cells())) << "feature_table > docs/step_solver_features.md writes the page";
}

}  // namespace
}  // namespace bb::features_test
