// Ordering and symbolic analysis by vertices: counts, solutions for vertices of every size, the choice of ordering, and
// no memory of earlier patterns.
#include <cholmod.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/linear/block_analysis.hpp"
#include "core/linear/cholmod_factor.hpp"
#include "core/math/at.hpp"
#include "tests/linear/systems.hpp"

namespace bb::block_analysis_test {
namespace {

/// Diagonally dominant, vertices of the given sizes, every coupled pair a full block.
ReducedSystem random_blocks(const std::vector<int>& sizes, int neighbours, unsigned seed) {
  std::mt19937_64 random(seed);
  ReducedSystem system;
  system.block_start.push_back(0);
  for (const int size : sizes) system.block_start.push_back(system.block_start.back() + size);
  const int n = system.block_start.back(), n_blocks = static_cast<int>(sizes.size());
  std::set<std::pair<int, int>> pairs;
  for (int v = 0; v < n_blocks; ++v) {
    pairs.insert({v, v});
    for (int k = 0; k < neighbours; ++k) {
      const int u = std::min(n_blocks - 1, v + 1 + static_cast<int>(random() % 12));
      pairs.insert({std::max(u, v), std::min(u, v)});
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [r, c] : pairs) {
    for (int i = system.block_start[at(r)]; i < system.block_start[at(r) + 1]; ++i) {
      for (int j = system.block_start[at(c)]; j < system.block_start[at(c) + 1]; ++j) {
        if (i >= j) entries.emplace_back(i, j, i == j ? 100.0 : static_cast<double>(random()) * 0x1p-63 - 1);
      }
    }
  }
  system.lower.resize(n, n);
  system.lower.setFromTriplets(entries.begin(), entries.end());
  return system;
}

/// Column lengths of the factor of the matrix in that order, by elimination of a dense pattern.
std::vector<double> column_lengths(const ReducedSystem& system, const int* order) {
  const Eigen::MatrixXd a = dense(system);
  const int n = static_cast<int>(a.rows());
  std::vector<std::vector<char>> full(at(n), std::vector<char>(at(n)));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) full[at(i)][at(j)] = a(order[i], order[j]) != 0;
  }
  std::vector<double> lengths;
  for (std::size_t k = 0; k < at(n); ++k) {
    std::vector<std::size_t> rows;
    for (std::size_t i = k + 1; i < at(n); ++i) {
      if (full[i][k]) rows.push_back(i);
    }
    lengths.push_back(1 + static_cast<double>(rows.size()));
    for (const std::size_t i : rows) {
      for (const std::size_t j : rows) full[i][j] = 1;
    }
  }
  return lengths;
}

struct Owner {
  cholmod_common common{};
  Owner() { cholmod_start(&common); }
  ~Owner() { cholmod_finish(&common); }
};

TEST(BlockAnalysis, CountsWhatEliminationFills) {
  for (const int size : {1, 2, 3}) {
    const ReducedSystem system =
        random_blocks(std::vector<int>(60, size), 3, 7 + static_cast<unsigned>(size));
    Owner owner;
    BlockAnalyzer analyzer;
    BlockAnalysis analysis = analyzer.analyze(system, owner.common);
    ASSERT_NE(analysis.factor, nullptr);
    double nonzeros = 0, flops = 0;
    for (const double length : column_lengths(system, static_cast<const int*>(analysis.factor->Perm))) {
      nonzeros += length;
      flops += length * length;
    }
    EXPECT_EQ(analysis.nonzeros, nonzeros) << size;
    EXPECT_EQ(analysis.flops, flops) << size;
    EXPECT_GT(nonzeros, static_cast<double>(system.lower.nonZeros()));  // there is fill
    EXPECT_FALSE(analysis.nested_dissection);
    cholmod_free_factor(&analysis.factor, &owner.common);
  }
}

TEST(BlockAnalysis, VerticesOfEverySizeAreSolved) {
  std::mt19937_64 random(3);
  for (const int n_blocks : {1, 2, 5, 40, 700}) {
    std::vector<int> sizes;
    for (int v = 0; v < n_blocks; ++v) sizes.push_back(1 + static_cast<int>(random() % 3));
    const ReducedSystem system = random_blocks(sizes, 4, 11);
    const VecXd x = random_vector(system.lower.rows(), 5);
    const VecXd b = system.lower.selfadjointView<Eigen::Lower>() * x;
    CholmodFactor factor;
    VecXd found;
    ASSERT_EQ(factor.factorize(system), LinearStatus::ok);
    factor.solve(b, found);
    EXPECT_LT((found - x).norm(), 1e-12 * x.norm()) << n_blocks;
    EXPECT_GE(factor.factor_nonzeros(), 0.95 * static_cast<double>(system.lower.nonZeros()));
  }
}

/// The Laplacian of an m x m x m grid, one unknown a vertex.
ReducedSystem cube(int m) {
  const int n = m * m * m;
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < n; ++v) {
    entries.emplace_back(v, v, 7);
    if ((v + 1) % m != 0) entries.emplace_back(v + 1, v, -1);
    if (v / m % m + 1 < m) entries.emplace_back(v + m, v, -1);
    if (v + m * m < n) entries.emplace_back(v + m * m, v, -1);
  }
  ReducedSystem system;
  for (int i = 0; i <= n; ++i) system.block_start.push_back(i);
  system.lower.resize(n, n);
  system.lower.setFromTriplets(entries.begin(), entries.end());
  return system;
}

TEST(BlockAnalysis, NestedDissectionIsTakenWhereItSavesMoreThanItTakes) {
  Owner owner;
  BlockAnalyzer analyzer;
  const auto analyze = [&](const ReducedSystem& system) {
    BlockAnalysis analysis = analyzer.analyze(system, owner.common);
    EXPECT_NE(analysis.factor, nullptr);
    cholmod_free_factor(&analysis.factor, &owner.common);
    return analysis;
  };
  const BlockAnalysis flat = analyze(grid_system(60, 0.1)), thick = analyze(cube(22));
  EXPECT_EQ(flat.orderings, 1);
  EXPECT_EQ(thick.orderings, 2);
  EXPECT_FALSE(flat.nested_dissection);
  EXPECT_LT(flat.flops / 27 / (60 * 60), 2e4);
  EXPECT_TRUE(thick.nested_dissection);
  cholmod_factor* by_degree = nullptr;
  {
    cholmod_common& c = owner.common;
    const ReducedSystem system = cube(22);
    cholmod_sparse a{};
    a.nrow = a.ncol = static_cast<std::size_t>(system.lower.rows());
    a.nzmax = static_cast<std::size_t>(system.lower.nonZeros());
    a.p = const_cast<int*>(system.lower.outerIndexPtr());
    a.i = const_cast<int*>(system.lower.innerIndexPtr());
    a.stype = -1;
    a.itype = CHOLMOD_INT;
    a.xtype = CHOLMOD_PATTERN;
    a.sorted = a.packed = 1;
    c.nmethods = 1;
    c.method[0].ordering = CHOLMOD_AMD;
    by_degree = cholmod_analyze(&a, &c);
    EXPECT_GT(c.fl / static_cast<double>(a.nrow), 2e4);
    EXPECT_LT(thick.flops, c.fl);
    cholmod_free_factor(&by_degree, &c);
  }
}

TEST(BlockAnalysis, RemembersNoEarlierPattern) {
  ReducedSystem one = grid_system(14, 0.3, 1), other = folded_grid(14, 1e3);
  other.pattern_id = 2;
  const VecXd b = random_vector(one.lower.rows(), 2);
  CholmodFactor used, fresh;
  VecXd from_used, from_fresh;
  for (const ReducedSystem* system : {&one, &other, &one})
    ASSERT_EQ(used.factorize(*system), LinearStatus::ok);
  EXPECT_TRUE(used.analyzed_last());
  used.solve(b, from_used);
  ASSERT_EQ(fresh.factorize(one), LinearStatus::ok);
  fresh.solve(b, from_fresh);
  EXPECT_GT(from_fresh.norm(), 0);
  EXPECT_EQ(from_used, from_fresh);
}

}  // namespace
}  // namespace bb::block_analysis_test
