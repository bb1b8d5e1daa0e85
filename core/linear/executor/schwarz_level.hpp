// A level of the Schwarz preconditioner in an executor's memory: its clusters, and the matrix of the level above.
#pragma once

#include "core/exec/buffer.hpp"
#include "core/linear/executor/schwarz_kernels.hpp"
#include "core/linear/vertex_clusters.hpp"

namespace bb::exec {

/// Where the blocks of a matrix are: beside the graph, most_parts number + part of every block.
struct HostPattern {
  BlockGraph graph;
  std::vector<Index> source;
};

/// The nodes of one level. The matrix of vertices is given, that of a level above is made here.
class SchwarzLevel {
 public:
  explicit SchwarzLevel(Executor& executor);

  /// Clusters of the nodes of a level.
  void set_clusters(const VertexClusters& clusters, Index n_nodes);
  /// The level above: a node is a cluster of `below`. Returns its pattern; norms are missing.
  HostPattern set_coarse(const HostPattern& below, const VertexClusters& clusters,
                         const std::vector<FixedMask>& fixed_below, std::vector<FixedMask>& fixed);
  void launch_values(const ExecutorMatrix& below, const FixedMask* fixed_below);
  void launch_factors(const ExecutorMatrix& matrix, const FixedMask* fixed, Index number,
                      FactorFaults* faults);
  /// z = the solves of all clusters; coarse_r may be null.
  void launch_solves(const FixedMask* fixed, const double* r, double* z, double* coarse_r,
                     const CgState* state);

  ExecutorMatrix matrix() const {
    return {{{row_begin_.data(), column_.data(), value_.data()}, {nullptr, nullptr, nullptr}}};
  }
  const FixedMask* fixed() const { return fixed_.data(); }
  const int* of() const { return of_.data(); }
  double* r() { return r_.data(); }
  double* z() { return z_.data(); }

 private:
  ClusterLevel view(const FixedMask* fixed);

  Executor& executor_;
  Buffer<int> start_, member_, of_, place_;
  Buffer<Index> offset_;
  Buffer<double> factor_;
  // of a coarse level
  Buffer<FixedMask> fixed_;
  Buffer<Index> row_begin_, source_begin_, source_;
  Buffer<int> column_, source_row_;
  Buffer<double> value_, r_, z_;
};

}  // namespace bb::exec
