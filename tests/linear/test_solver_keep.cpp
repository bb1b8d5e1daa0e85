// What a solver keeps in an archive: one that reads it goes on, bit for bit, wherever the first one was.
#include <gtest/gtest.h>

#include "core/base/archive/archive.hpp"
#include "tests/linear/every_solver.hpp"
#include "tests/linear/systems.hpp"

namespace bb::solver_keep_test {
namespace {

/// Values and couplings change from matrix to matrix, the pattern now and then and back again: the ties of a folded
/// grid become stiff and soft, so that clusters of a later matrix would be others.
std::vector<ReducedSystem> matrices() {
  std::vector<ReducedSystem> out;
  const double stiffness[] = {1, 1e4, 1e-3, 1e2, 10, 1e5, 1, 1e3};
  for (int i = 0; i < 8; ++i) {
    const bool tied = i < 4 || i > 5;
    ReducedSystem system = tied ? folded_grid(8, stiffness[i]) : grid_system(8, 1 + 0.1 * i);
    for (Eigen::Index k = 0; k < system.lower.nonZeros(); ++k) system.lower.valuePtr()[k] *= 1 + 0.03 * i;
    system.pattern_id = tied ? 7 : 8;
    out.push_back(std::move(system));
  }
  return out;
}

struct Solved {
  VecXd x;
  LinearReport report;
};

/// Every second time another matrix is examined afterwards, whose factor may be what is left.
Solved solve(LinearSolver& solver, const ReducedSystem& system, unsigned seed) {
  solver.begin_step();
  Solved out;
  out.report = solver.solve(system, random_vector(system.lower.rows(), seed), out.x);
  if (seed % 2 == 0) return out;
  ReducedSystem other = system;
  for (Eigen::Index k = 0; k < other.lower.nonZeros(); ++k) other.lower.valuePtr()[k] *= 1.2;
  other.lower.coeffRef(0, 0) *= 3;
  const Definiteness found = solver.examine(other, [&system]() -> const ReducedSystem& { return system; });
  EXPECT_EQ(found.verdict, Definiteness::Verdict::positive);
  return out;
}

TEST(SolverKeep, OneThatReadsGoesOnToTheBit) {
  const std::vector<ReducedSystem> systems = matrices();
  int lagging = 0;
  for (const NamedSolver& one : every_solver()) {
    for (std::size_t stop = 0; stop <= systems.size() - 1; ++stop) {
      SCOPED_TRACE(one.name + ", stopped before solve " + std::to_string(stop));
      const auto whole = make_linear_solver(one.options), resumed = make_linear_solver(one.options);
      for (std::size_t i = 0; i < stop; ++i) solve(*whole, systems[i], static_cast<unsigned>(i));
      Archive written;
      whole->keep(written);
      Archive read(written.bytes());
      resumed->keep(read);
      EXPECT_TRUE(read.at_end());
      for (std::size_t i = stop; i < systems.size(); ++i) {
        const Solved a = solve(*whole, systems[i], static_cast<unsigned>(i)),
                     b = solve(*resumed, systems[i], static_cast<unsigned>(i));
        ASSERT_EQ(a.report.status, LinearStatus::ok);
        ASSERT_GT(a.x.norm(), 0);
        EXPECT_EQ(a.x, b.x) << i;
        EXPECT_EQ(a.report.iterations, b.report.iterations) << i;
        EXPECT_EQ(a.report.analyzed, b.report.analyzed) << i;
        EXPECT_EQ(a.report.factorized, b.report.factorized) << i;
        lagging += a.report.iterations > 1 && one.name == "lagged_cholesky" && !a.report.factorized;
      }
    }
  }
  EXPECT_GT(lagging, 0);
}

TEST(SolverKeep, AnArchiveOfTheSameMomentIsTheSame) {
  const std::vector<ReducedSystem> systems = matrices();
  for (const NamedSolver& one : every_solver()) {
    SCOPED_TRACE(one.name);
    const auto first = make_linear_solver(one.options), second = make_linear_solver(one.options);
    solve(*first, systems[1], 1);
    Archive written, again;
    first->keep(written);
    Archive read(written.bytes());
    second->keep(read);
    second->keep(again);
    EXPECT_EQ(again.bytes(), written.bytes());
  }
}

}  // namespace
}  // namespace bb::solver_keep_test
