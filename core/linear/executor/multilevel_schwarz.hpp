// Multilevel additive Schwarz on an executor: M^-1 = sum over levels l of P_l (sum_k R_k^T A_lk^-1 R_k) P_l^T. Level 0 has
// the vertices; the nodes of each further level are the clusters of the one before, with their translations P_l and the
// matrix P_l^T A P_l; A_lk is the dense matrix of one cluster. Clusters hold what the matrix couples most, contacts
// included (core/linear/vertex_clusters.hpp). Sources: Toselli, Widlund 2005; Wu et al. 2022; Huang et al. 2025.
#pragma once

#include <memory>

#include "core/linear/executor/executor_preconditioner.hpp"
#include "core/linear/executor/schwarz_level.hpp"

namespace bb::exec {

/// Clusters are made on the host when the pattern changes, from norms that come down: O(blocks log blocks), serial.
/// Memory: 72 bytes a vertex and vertex of its cluster on level 0, about a seventh of that above.
class MultilevelSchwarz final : public ExecutorPreconditioner {
 public:
  static constexpr int most_cluster_vertices = 11;  // clusters grow by half of it (ClusterLevel::most_nodes)
  /// cluster_vertices: 1 to most_cluster_vertices.
  MultilevelSchwarz(Executor& executor, int cluster_vertices)
      : executor_(executor), cluster_vertices_(cluster_vertices) {}
  void setup(const ExecutorMatrix& matrix, const PcgVectors& v, std::uint64_t pattern_id,
             FactorFaults* faults) override;
  void apply(const PcgVectors& v) override { launch(v, nullptr); }
  void update(const PcgVectors& v, int k) override;
  void keep(Archive& archive) override;
  int version() const override { return version_; }
  std::string fault_text(Index number) const override;
  int n_levels() const { return static_cast<int>(levels_.size()); }

 private:
  void build(const ExecutorMatrix& matrix, const PcgVectors& v);
  HostPattern download(const ExecutorMatrix& matrix, Index n) const;
  void download_norms(const ExecutorMatrix& matrix, const FixedMask* fixed, HostPattern& pattern);
  void launch(const PcgVectors& v, const CgState* state);

  Executor& executor_;
  int cluster_vertices_, version_ = 0;
  std::uint64_t pattern_id_ = 0;
  std::vector<VertexClusters> clusters_;  // of every level
  std::vector<std::unique_ptr<SchwarzLevel>> levels_;
};

}  // namespace bb::exec
