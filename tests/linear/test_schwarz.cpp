// The two-level Schwarz preconditioner: what its clusters hold, and what it saves where contacts are stiff.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/linear/linear_solver.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/linear/vertex_clusters.hpp"
#include "tests/linear/systems.hpp"

namespace bb::schwarz_test {
namespace {

int iterations(const ReducedSystem& system, const std::string& preconditioner) {
  LinearOptions options;
  options.name = "pcg";
  options.parameters = {{"preconditioner", preconditioner}, {"forcing", "fixed"}, {"tol_rel", 1e-6}};
  VecXd x;
  const LinearReport report =
      make_linear_solver(options)->solve(system, random_vector(system.lower.rows(), 4), x);
  EXPECT_EQ(report.status, LinearStatus::ok) << preconditioner;
  return report.iterations;
}

TEST(VertexClusters, HoldEveryVertexOnceAndAreConnected) {
  for (const int size : {1, 8, 32}) {
    SymmetricProduct rows;
    rows.update(grid_system(15, 0.1, 1));
    const VertexClusters clusters = cluster_vertices(rows, size);
    std::vector<int> members = clusters.member, all(225);
    std::sort(members.begin(), members.end());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(members, all);
    EXPECT_LE(clusters.size(), 225 / size * 2);
    for (int k = 0; k < clusters.size(); ++k) {
      const auto first = clusters.member.begin() + clusters.start[static_cast<std::size_t>(k)],
                 last = clusters.member.begin() + clusters.start[static_cast<std::size_t>(k) + 1];
      EXPECT_GT(last - first, 0);
      EXPECT_LE(last - first, size + size / 2);
      EXPECT_TRUE(std::is_sorted(first, last));
      for (auto v = first; v != last; ++v) EXPECT_EQ(clusters.of[static_cast<std::size_t>(*v)], k);
    }
  }
}

/// A stiff contact draws both its sides into one cluster.
TEST(VertexClusters, JoinWhatTouches) {
  SymmetricProduct rows;
  rows.update(folded_grid(12, 1e3));
  const VertexClusters clusters = cluster_vertices(rows, 16);
  int together = 0;
  for (std::size_t v = 0; v < 72; ++v) together += clusters.of[v] == clusters.of[143 - v] ? 1 : 0;
  EXPECT_GT(together, 65);
}

TEST(Schwarz, NeedsFewerIterationsThanBlockJacobiHoweverStiffContactsAre) {
  for (const double stiffness : {0.0, 1.0, 1e3, 1e6}) {
    const ReducedSystem system = folded_grid(24, stiffness);
    const int block_jacobi = iterations(system, "block_jacobi"), schwarz = iterations(system, "schwarz");
    EXPECT_GT(block_jacobi, 100) << stiffness;
    EXPECT_LT(2 * schwarz, block_jacobi) << stiffness;
  }
}

/// Vertices with two degrees of freedom have two translations.
TEST(Schwarz, TakesPlanarScenes) {
  ReducedSystem system = grid_system(8, 1e-2, 1);  // 192 degrees of freedom in pairs
  system.block_start.clear();
  for (int i = 0; i <= 192; i += 2) system.block_start.push_back(i);
  EXPECT_LT(iterations(system, "schwarz"), iterations(system, "none"));
}

}  // namespace
}  // namespace bb::schwarz_test
