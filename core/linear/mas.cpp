// Multilevel additive Schwarz: M^-1 = sum over levels l of C_l sum_k R_lk^T (R_lk C_l^T A C_l R_lk^T)^-1 R_lk C_l^T.
// The nodes of level 0 are the vertices, in blocks k of at most block_vertices: stretches of a Morton curve (GIPC), or
// parts of the mesh's graph by METIS (StiffGIPC). The nodes of the next level are the connected components of the
// matrix within a block, contacts included, in blocks of consecutive ones; C_l moves all vertices of a node alike.
// Levels end where one block holds all nodes, and after six, StiffGIPC's cap. Sources: Wu et al. 2022 (levels, Morton curve); GIPC; Huang et al. 2025
// (StiffGIPC, METIS). Otherwise than there: factors in double in the place of inverses in float; the number of levels
// comes from the nodes and not from a formula of n; prescribed vertices are not in the matrix.
#include <algorithm>
#include <memory>

#include "core/linear/block_starts.hpp"
#include "core/linear/mas_level.hpp"
#include "core/linear/node_blocks.hpp"
#include "core/linear/parallel.hpp"
#include "core/linear/pattern_key.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/math/at.hpp"

namespace bb {
namespace {

constexpr std::size_t most_levels = 6;

class Mas final : public Preconditioner {
 public:
  Mas(bool by_graph, int block_vertices) : by_graph_(by_graph), block_vertices_(block_vertices) {}
  LinearStatus setup(const ReducedSystem& system, const SymmetricProduct& rows) override;
  void apply(const VecXd& r, VecXd& z) const override;
  bool wants_mesh() const override { return true; }
  std::string detail() const override { return detail_; }

 private:
  VertexClusters first_blocks(const ReducedSystem& system, const SymmetricProduct& rows);
  void build(const ReducedSystem& system, const SymmetricProduct& rows);

  bool by_graph_;
  int block_vertices_;
  std::string detail_;
  PatternKey key_;
  std::shared_ptr<const BlockMesh> mesh_;  // that first_ is of
  VertexClusters first_;
  std::vector<std::unique_ptr<MasLevel>> levels_;
};

VertexClusters Mas::first_blocks(const ReducedSystem& system, const SymmetricProduct& rows) {
  const BlockMesh* mesh = system.mesh.get();
  if (!by_graph_) {
    return mesh && !mesh->point.empty() ? morton_blocks(mesh->point, block_vertices_)
                                        : consecutive_blocks(rows.n_blocks(), block_vertices_);
  }
  if (mesh && !mesh->row_start.empty()) {
    return partitioned_blocks(mesh->row_start, mesh->neighbour, block_vertices_);
  }
  std::vector<int> start(1, 0), neighbour;
  for (int r = 0; r < rows.n_blocks(); ++r) {
    for (int k = rows.row_start()[at(r)]; k < rows.row_start()[at(r) + 1]; ++k) {
      if (rows.column()[at(k)] != r) neighbour.push_back(rows.column()[at(k)]);
    }
    start.push_back(static_cast<int>(neighbour.size()));
  }
  return partitioned_blocks(start, neighbour, block_vertices_);
}

void Mas::build(const ReducedSystem& system, const SymmetricProduct& rows) {
  const bool by_mesh = system.mesh && (!by_graph_ || !system.mesh->row_start.empty());
  if (!by_mesh || system.mesh != mesh_) first_ = first_blocks(system, rows);
  mesh_ = system.mesh;
  levels_.clear();
  levels_.push_back(std::make_unique<MasLevel>(rows, first_));
  while (levels_.back()->n_blocks() > 1 && levels_.back()->coarsens() && levels_.size() < most_levels) {
    levels_.push_back(std::make_unique<MasLevel>(*levels_.back(), block_vertices_));
  }
}

LinearStatus Mas::setup(const ReducedSystem& system, const SymmetricProduct& rows) {
  detail_ = zero_diagonal_text(system);
  if (!detail_.empty()) {
    detail_ += "mas needs positive definite ones";
    return LinearStatus::preconditioner_indefinite;
  }
  if (!key_.same_as_last(system) || system.mesh != mesh_) build(system, rows);
  const double* values = rows.block(0);
  for (const auto& level : levels_) {
    // the blocks of every level are positive definite where A is
    if (!level->factorize(values)) return LinearStatus::matrix_indefinite;
    values = level->coarse_values();
  }
  return LinearStatus::ok;
}

void Mas::apply(const VecXd& r, VecXd& z) const {
  z.resize(r.size());
  const double* residual = r.data();
  for (const auto& level : levels_) residual = level->solve(residual);
  const double* above = nullptr;
  for (auto level = levels_.rbegin(); level != levels_.rend(); ++level) above = (*level)->add(above);
  std::copy_n(above, z.size(), z.data());
}

}  // namespace

PreconditionerEntry preconditioner_mas() {
  PreconditionerEntry entry;
  entry.parameters = {
      {"mas_blocks", word({"morton", "metis"}), "morton",
       "what a block of vertices is: a stretch of a Morton curve through the start positions (of a matrix "
       "without "
       "mesh, of its order), or a part of the mesh's graph by METIS (without mesh, of the matrix)"},
      {"block_vertices", count(2, 1000), 32, "most nodes of a block, on every level; GIPC 32, StiffGIPC 16"}};
  entry.make = [](const ParameterMap& complete) -> std::unique_ptr<Preconditioner> {
    return std::make_unique<Mas>(text(complete, "mas_blocks") == "metis",
                                 integer(complete, "block_vertices"));
  };
  return entry;
}

}  // namespace bb
