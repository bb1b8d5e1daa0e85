// Blocks of nodes for additive Schwarz: stretches of a Morton curve, or parts of a graph.
#pragma once

#include <span>
#include <vector>

#include "core/linear/vertex_clusters.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Nodes 0 .. n in stretches of `size`; the last one may be shorter.
VertexClusters consecutive_blocks(int n, int size);

/// Stretches of `size` points along the Morton curve (z-order) of a cube round all of them with 1024 cells a side;
/// within a cell points go by number. Members stand in the order of the curve. A point that is not finite counts
/// as the corner of the cube. GIPC divides each side of its box by 1024 apart; one scale for all keeps the noise of
/// a flat sheet from becoming an axis. Source: Wu et al. 2022; GIPC (hash_code).
VertexClusters morton_blocks(std::span<const Vec3d> points, int size);

/// Parts of a graph with at most `size` nodes each by METIS (k-way, edge weights 1, its own seed): every connected
/// component of n nodes apart, in ceil(n / (size - 1)) parts, as StiffGIPC's sorting does for every mesh. A part
/// with more nodes is cut at `size`. size >= 2; row_start [n + 1], neighbour of every node both ways, without itself.
/// Serial. Cost: some 10 us a node. Errors: std::runtime_error when METIS refuses.
VertexClusters partitioned_blocks(std::span<const int> row_start, std::span<const int> neighbour, int size);

}  // namespace bb
