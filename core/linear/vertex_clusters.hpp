// Clusters of strongly coupled vertices. Contacts couple by their blocks in the matrix as elements do, so a
// stiff contact draws both its sides into one cluster.
#pragma once

#include <cstdint>
#include <vector>

#include "core/linear/symmetric_product.hpp"

namespace bb {

/// The blocks of a matrix by rows. A column may stand several times in a row: its blocks add up.
struct BlockGraph {
  std::vector<std::int64_t> row_start;  // [n + 1]
  std::vector<int> column;              // [blocks]
  std::vector<double> norm;             // [blocks] Frobenius
  int n() const { return static_cast<int>(row_start.size()) - 1; }
};

struct VertexClusters {
  std::vector<int> of;      // [n_blocks] cluster of a vertex
  std::vector<int> start;   // [n_clusters + 1] into members
  std::vector<int> member;  // [n_blocks] vertices by cluster, ascending within one
  int size() const { return static_cast<int>(start.size()) - 1; }
};

/// Greedy: a cluster begins with the first vertex that has none and takes the vertex most strongly coupled to
/// it, sum |A_rc| / sqrt(|A_rr| |A_cc|) over its members, until it has `vertices`. A cluster that gets stuck
/// below half of that joins the one it is most strongly coupled to, so up to 3/2 of `vertices` are in one.
/// Serial. Cost: O(blocks log blocks).
VertexClusters cluster_vertices(const SymmetricProduct& rows, int vertices);
VertexClusters cluster_vertices(const BlockGraph& graph, int vertices);

}  // namespace bb
