// Multilevel additive Schwarz against its formula on dense matrices, and what it saves.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/linear/mas_level.hpp"
#include "core/linear/node_blocks.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/solvers/linear_solvers.hpp"
#include "core/math/at.hpp"
#include "tests/linear/systems.hpp"

namespace bb::mas_test {
namespace {

std::unique_ptr<Preconditioner> mas(const std::string& blocks, int vertices) {
  return make_preconditioner("mas", {{"mas_blocks", blocks}, {"block_vertices", vertices}});
}

/// M^-1, column by column.
Eigen::MatrixXd inverse_of(const ReducedSystem& system, const std::string& blocks, int vertices) {
  SymmetricProduct rows;
  rows.update(system);
  const auto m = mas(blocks, vertices);
  EXPECT_EQ(m->setup(system, rows), LinearStatus::ok) << m->detail();
  const Eigen::Index n = system.lower.rows();
  Eigen::MatrixXd out(n, n);
  VecXd z;
  for (Eigen::Index j = 0; j < n; ++j) {
    m->apply(VecXd::Unit(n, j), z);
    out.col(j) = z;
  }
  return out;
}

/// The connected components of A within blocks, by block and first member: the dense twin of a level.
std::vector<int> components(const Eigen::MatrixXd& a, const std::vector<int>& node_of_dof,
                            const VertexClusters& blocks, int& n_found) {
  const int n = static_cast<int>(blocks.of.size());
  Eigen::MatrixXi joined = Eigen::MatrixXi::Zero(n, n);
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j < a.cols(); ++j) {
      if (a(i, j) != 0) joined(node_of_dof[at(i)], node_of_dof[at(j)]) = 1;
    }
  }
  std::vector<int> found(at(n), -1);
  n_found = 0;
  for (const int seed : blocks.member) {
    if (found[at(seed)] >= 0) continue;
    found[at(seed)] = n_found;
    for (bool grew = true; grew;) {
      grew = false;
      for (int u = 0; u < n; ++u) {
        for (int v = 0; v < n && found[at(u)] < 0; ++v) {
          if (found[at(v)] != n_found || !joined(u, v) || blocks.of[at(u)] != blocks.of[at(v)]) continue;
          found[at(u)] = n_found;
          grew = true;
        }
      }
    }
    ++n_found;
  }
  return found;
}

struct Dense {
  Eigen::MatrixXd sum;
  int n_levels = 0;
};

/// sum_l C_l (sum_k R_k^T (R_k A_l R_k^T)^-1 R_k) C_l^T, A_l = C_l^T A C_l, with every matrix written out; nodes have
/// three degrees of freedom.
Dense explicit_sum(const Eigen::MatrixXd& a, VertexClusters blocks, int vertices) {
  Dense out{Eigen::MatrixXd::Zero(a.rows(), a.cols())};
  Eigen::MatrixXd c = Eigen::MatrixXd::Identity(a.rows(), a.cols());
  for (;;) {
    ++out.n_levels;
    const Eigen::MatrixXd level = c.transpose() * a * c;
    std::vector<int> node(at(level.rows()));
    for (std::size_t i = 0; i < node.size(); ++i) node[i] = static_cast<int>(i) / 3;
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(level.rows(), level.cols());
    for (int k = 0; k < blocks.size(); ++k) {
      std::vector<int> dofs;
      for (int m = blocks.start[at(k)]; m < blocks.start[at(k) + 1]; ++m) {
        for (int i = 0; i < 3; ++i) dofs.push_back(3 * blocks.member[at(m)] + i);
      }
      const auto n = static_cast<Eigen::Index>(dofs.size());
      Eigen::MatrixXd pick = Eigen::MatrixXd::Zero(n, level.cols());  // R_k
      for (Eigen::Index i = 0; i < n; ++i) pick(i, dofs[at(i)]) = 1;
      const Eigen::MatrixXd of_block = pick * level * pick.transpose();
      inverse += pick.transpose() * Eigen::LLT<Eigen::MatrixXd>(of_block).solve(pick);
    }
    out.sum += c * inverse * c.transpose();
    int n_found = 0;
    const std::vector<int> found = components(level, node, blocks, n_found);
    const bool coarsens = n_found < static_cast<int>(found.size());
    if (blocks.size() == 1 || !coarsens || out.n_levels == 6) return out;
    Eigen::MatrixXd up = Eigen::MatrixXd::Zero(level.rows(), 3 * n_found);
    for (Eigen::Index i = 0; i < up.rows(); ++i) up(i, 3 * found[at(i / 3)] + i % 3) = 1;
    c = (c * up).eval();
    blocks = consecutive_blocks(n_found, vertices);
  }
}

/// A grid with stiff ties and the places of its vertices: two sheets on top of each other.
ReducedSystem sheets(int m, double stiffness, std::uint64_t id = 0) {
  ReducedSystem system = folded_grid(m, stiffness);
  auto mesh = std::make_shared<BlockMesh>();
  const ReducedSystem without = folded_grid(m, 0);
  mesh->row_start.push_back(0);
  const Eigen::MatrixXd a = dense(without);
  for (int v = 0; v < m * m; ++v) {
    const bool upper = 2 * v >= m * m;
    const int w = upper ? m * m - 1 - v : v;
    mesh->point.emplace_back(w % m, w / m, upper ? 0.01 : 0);
    for (int u = 0; u < m * m; ++u) {
      if (u != v && !a.block(3 * v, 3 * u, 3, 3).isZero(0)) mesh->neighbour.push_back(u);
    }
    mesh->row_start.push_back(static_cast<int>(mesh->neighbour.size()));
  }
  system.mesh = std::move(mesh);
  system.pattern_id = id;
  return system;
}

/// Two triangles on a square, of which a corner is prescribed altogether and another one in part.
TEST(BlockMesh, HasFreeVerticesAndWhatElementsJoin) {
  std::vector<std::uint8_t> fixed(15, 0);
  fixed[3] = fixed[4] = fixed[5] = 1;  // vertex 1
  fixed[6] = 1;                        // vertex 2, x
  BlockSystem blocks(5, fixed);
  const std::vector<int> triangles = {0, 1, 2, 0, 2, 3}, contact = {3, 4};
  blocks.set_elements({{3, triangles}});
  blocks.set_contacts({{2, contact}});
  EXPECT_EQ(blocks.reduce(blocks.values()).mesh, nullptr);  // no solver requested it
  Positions x(3, 5);
  x << 0, 1, 1, 0, 7, 0, 0, 1, 1, 7, 0, 0, 0, 0, 7;
  blocks.set_mesh(x);
  const ReducedSystem& system = blocks.reduce(blocks.values());
  ASSERT_NE(system.mesh, nullptr);
  EXPECT_EQ(system.block_vertex, (std::vector<int>{0, 2, 3, 4}));
  EXPECT_EQ(system.mesh->row_start, (std::vector<int>{0, 2, 4, 6, 6}));
  EXPECT_EQ(system.mesh->neighbour, (std::vector<int>{1, 2, 0, 2, 0, 1}));  // no contact
  ASSERT_EQ(system.mesh->point.size(), 4u);
  EXPECT_EQ(system.mesh->point[1], Vec3d(1, 1, 0));
}

TEST(Mas, IsTheSumOfItsFormula) {
  for (const double stiffness : {0.0, 1e3}) {
    ReducedSystem system = sheets(12, stiffness);
    system.lower.prune(0.0);  // ties of no stiffness are none
    const Eigen::MatrixXd a = dense(system);
    const BlockMesh& mesh = *system.mesh;
    const Dense by_curve = explicit_sum(a, morton_blocks(mesh.point, 4), 4);
    const Dense by_parts = explicit_sum(a, partitioned_blocks(mesh.row_start, mesh.neighbour, 5), 5);
    EXPECT_GE(by_curve.n_levels, 3);
    EXPECT_GE(by_parts.n_levels, 3);
    EXPECT_LT((inverse_of(system, "morton", 4) - by_curve.sum).norm(), 1e-9 * by_curve.sum.norm());
    EXPECT_LT((inverse_of(system, "metis", 5) - by_parts.sum).norm(), 1e-9 * by_parts.sum.norm());
    EXPECT_GT((by_curve.sum - by_parts.sum).norm(), 0.01 * by_curve.sum.norm());  // two operators
  }
}

bool positive_definite(const Eigen::MatrixXd& m) {
  return Eigen::LLT<Eigen::MatrixXd>(m).info() == Eigen::Success;
}

TEST(Mas, IsSymmetricAndPositiveDefinite) {
  for (const std::string blocks : {"morton", "metis"}) {
    const Eigen::MatrixXd m = inverse_of(sheets(10, 1e2), blocks, 8);
    EXPECT_LT((m - m.transpose()).norm(), 1e-13 * m.norm()) << blocks;
    EXPECT_TRUE(positive_definite(m)) << blocks;
  }
}

/// One block that holds everything is a factorisation.
TEST(Mas, OneBlockIsTheInverse) {
  const ReducedSystem system = sheets(4, 1);
  const Eigen::MatrixXd a = dense(system);
  EXPECT_LT((inverse_of(system, "morton", 32) * a - Eigen::MatrixXd::Identity(48, 48)).norm(), 1e-10);
}

/// Vertices with two degrees of freedom, and some with one, have that many translations.
TEST(Mas, TakesFewerDegreesOfFreedomAVertex) {
  ReducedSystem system = grid_system(8, 1e-2);  // 192 degrees of freedom
  system.block_start.clear();
  for (int i = 0; i <= 192;) {
    system.block_start.push_back(i);
    i += i < 96 ? 2 : 1;
  }
  const Eigen::MatrixXd m = inverse_of(system, "morton", 8);
  EXPECT_TRUE(positive_definite(m));
}

LinearReport solve(const ReducedSystem& system, const ParameterMap& more, VecXd& x) {
  LinearOptions options;
  options.name = "pcg";
  options.parameters = more;
  options.parameters.insert({{"forcing", "fixed"}, {"tol_rel", 1e-8}});
  const LinearReport report =
      make_linear_solver(options)->solve(system, random_vector(system.lower.rows(), 4), x);
  EXPECT_EQ(report.status, LinearStatus::ok);
  return report;
}

TEST(Mas, SavesIterationsAndEndsAtTheSameSolution) {
  const ReducedSystem system = sheets(24, 10);
  VecXd truth, x;
  solve(system, {{"preconditioner", "block_jacobi"}, {"tol_rel", 1e-12}}, truth);
  const int jacobi = solve(system, {{"preconditioner", "block_jacobi"}}, x).iterations;
  EXPECT_GT(jacobi, 100);
  EXPECT_LT((x - truth).norm(), 1e-5 * truth.norm());
  for (const std::string blocks : {"morton", "metis"}) {
    const LinearReport report =
        solve(system, {{"preconditioner", "mas"}, {"mas_blocks", blocks}, {"block_vertices", 16}}, x);
    EXPECT_LT(report.iterations, 0.6 * jacobi) << blocks;
    EXPECT_LT((x - truth).norm(), 1e-5 * truth.norm()) << blocks;
  }
}

TEST(Mas, ThreadsDoNotChangeABit) {
  const ReducedSystem system = sheets(24, 1e3);
  std::vector<VecXd> solutions;
  for (const std::size_t threads : {1u, 2u, 4u}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    solve(system, {{"preconditioner", "mas"}, {"block_vertices", 4}}, solutions.emplace_back());
  }
  EXPECT_EQ(solutions[0], solutions[1]);
  EXPECT_EQ(solutions[0], solutions[2]);
  EXPECT_GT(solutions[0].norm(), 0);
}

/// Contacts that come and go change components and nothing of the blocks; going back gives the first operator again.
TEST(Mas, FollowsThePattern) {
  const ReducedSystem tied = sheets(12, 1e3, 1);
  ReducedSystem apart = sheets(12, 0, 2);
  apart.lower.prune(0.0);
  apart.mesh = tied.mesh;
  const auto m = mas("metis", 8);
  const VecXd r = random_vector(tied.lower.rows(), 3);
  std::vector<VecXd> z(3);
  const ReducedSystem* order[] = {&tied, &apart, &tied};
  for (int i = 0; i < 3; ++i) {
    SymmetricProduct rows;
    rows.update(*order[i]);
    ASSERT_EQ(m->setup(*order[i], rows), LinearStatus::ok);
    m->apply(r, z[at(i)]);
    VecXd alone;
    const auto fresh = mas("metis", 8);
    ASSERT_EQ(fresh->setup(*order[i], rows), LinearStatus::ok);
    fresh->apply(r, alone);
    EXPECT_EQ(z[at(i)], alone);
  }
  EXPECT_EQ(z[0], z[2]);
  EXPECT_NE(z[0], z[1]);
}

TEST(Mas, NamesWhatIsNotPositiveDefinite) {
  ReducedSystem system = grid_system(6, 1e-2);
  SymmetricProduct rows;
  for (int i = 0; i < 3; ++i) system.lower.coeffRef(40 + i, 40 + i) *= -1;
  rows.update(system);
  EXPECT_EQ(mas("morton", 8)->setup(system, rows), LinearStatus::matrix_indefinite);
}

}  // namespace
}  // namespace bb::mas_test
