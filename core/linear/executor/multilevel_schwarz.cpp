#include "core/linear/executor/multilevel_schwarz.hpp"

#include <algorithm>

#include "core/math/at.hpp"

namespace bb::exec {
namespace {

constexpr int most_parts = ExecutorMatrix::most_parts;

template <class T>
std::vector<T> download_numbers(Executor& executor, const T* from, Index n) {
  std::vector<T> out(at(n));
  if (n > 0) executor.download(out.data(), from, out.size() * sizeof(T));
  return out;
}

/// True when a block beside the diagonal is not 0.
bool has_couplings(const BlockGraph& graph) {
  for (int r = 0; r < graph.n(); ++r) {
    for (Index k = graph.row_start[at(r)]; k < graph.row_start[at(r) + 1]; ++k) {
      if (graph.column[at(k)] != r && graph.norm[at(k)] > 0) return true;
    }
  }
  return false;
}

}  // namespace

/// All parts as one graph, those of the first part first in a row.
HostPattern MultilevelSchwarz::download(const ExecutorMatrix& matrix, Index n) const {
  std::vector<Index> begin[most_parts];
  std::vector<int> column[most_parts];
  for (int p = 0; p < most_parts; ++p) {
    if (!matrix.part[p].row_begin) continue;
    begin[p] = download_numbers(executor_, matrix.part[p].row_begin, n + 1);
    column[p] = download_numbers(executor_, matrix.part[p].column, begin[p].back());
  }
  HostPattern out;
  out.graph.row_start.push_back(0);
  for (Index r = 0; r < n; ++r) {
    for (int p = 0; p < most_parts; ++p) {
      if (begin[p].empty()) continue;
      for (Index j = begin[p][at(r)]; j < begin[p][at(r) + 1]; ++j) {
        out.graph.column.push_back(column[p][at(j)]);
        out.source.push_back(most_parts * j + p);
      }
    }
    out.graph.row_start.push_back(static_cast<Index>(out.source.size()));
  }
  return out;
}

void MultilevelSchwarz::download_norms(const ExecutorMatrix& matrix, const FixedMask* fixed,
                                       HostPattern& pattern) {
  std::vector<double> norm[most_parts];
  for (int p = 0; p < most_parts; ++p) {
    if (!matrix.part[p].row_begin) continue;
    const Index count = std::count_if(pattern.source.begin(), pattern.source.end(),
                                      [p](Index source) { return source % most_parts == p; });
    Buffer<double> on_executor(executor_, "block norms", count);
    executor_.each(pattern.graph.n(), BlockNorms{matrix.part[p], fixed, on_executor.data()});
    norm[p] = on_executor.download();
  }
  pattern.graph.norm.resize(pattern.source.size());
  for (std::size_t k = 0; k < pattern.source.size(); ++k) {
    pattern.graph.norm[k] = norm[pattern.source[k] % most_parts][at(pattern.source[k] / most_parts)];
  }
}

void MultilevelSchwarz::keep(Archive& archive) {
  std::uint64_t n = clusters_.size();
  archive(pattern_id_, n);
  clusters_.resize(n);
  for (VertexClusters& level : clusters_) archive(level.of, level.start, level.member);
  if (archive.reads()) levels_.clear();
}

// Levels of clusters that are known, or else new ones.
void MultilevelSchwarz::build(const ExecutorMatrix& matrix, const PcgVectors& v) {
  levels_.clear();
  const std::size_t n_known = clusters_.size();
  ++version_;
  HostPattern pattern = download(matrix, v.partition.n_rows);
  download_norms(matrix, v.fixed, pattern);
  std::vector<FixedMask> fixed = download_numbers(executor_, v.fixed, v.partition.n_rows), coarse_fixed;
  ExecutorMatrix here = matrix;
  const FixedMask* fixed_here = v.fixed;
  levels_.push_back(std::make_unique<SchwarzLevel>(executor_));
  for (;;) {
    if (n_known == 0) clusters_.push_back(cluster_vertices(pattern.graph, cluster_vertices_));
    const VertexClusters& clusters = clusters_[levels_.size() - 1];
    levels_.back()->set_clusters(clusters, pattern.graph.n());
    // A level of clusters without couplings has been solved exactly.
    if (clusters.size() == pattern.graph.n() || n_levels() > AddLevels::most_levels) return;
    auto above = std::make_unique<SchwarzLevel>(executor_);
    HostPattern coarse = above->set_coarse(pattern, clusters, fixed, coarse_fixed);
    above->launch_values(here, fixed_here);
    here = above->matrix(), fixed_here = above->fixed();
    download_norms(here, fixed_here, coarse);
    if (n_known == 0 ? !has_couplings(coarse.graph) : levels_.size() == n_known) return;
    levels_.push_back(std::move(above));
    pattern = std::move(coarse);
    fixed = coarse_fixed;
  }
}

void MultilevelSchwarz::setup(const ExecutorMatrix& matrix, const PcgVectors& v, std::uint64_t pattern_id,
                              FactorFaults* faults) {
  if (pattern_id == 0 || pattern_id != pattern_id_) clusters_.clear();
  if (clusters_.empty() || levels_.empty()) build(matrix, v);
  pattern_id_ = pattern_id;
  ExecutorMatrix here = matrix;
  const FixedMask* fixed = v.fixed;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    if (l > 0) {
      levels_[l]->launch_values(here, fixed);
      here = levels_[l]->matrix(), fixed = levels_[l]->fixed();
    }
    levels_[l]->launch_factors(here, fixed, static_cast<Index>(l), faults);
  }
}

void MultilevelSchwarz::launch(const PcgVectors& v, const CgState* state) {
  AddLevels add{};
  add.partition = v.partition, add.fixed = v.fixed, add.r = v.r, add.z = v.z;
  add.partial_rz = v.partial_rz, add.state = state, add.n_above = n_levels() - 1;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    SchwarzLevel& here = *levels_[l];
    SchwarzLevel* above = l + 1 < levels_.size() ? levels_[l + 1].get() : nullptr;
    here.launch_solves(l == 0 ? v.fixed : here.fixed(), l == 0 ? v.r : here.r(), l == 0 ? v.z : here.z(),
                       above ? above->r() : nullptr, state);
    if (above) add.of[l] = here.of(), add.z_above[l] = above->z();
  }
  executor_.blocks(v.partition.n_blocks(), add);
}

void MultilevelSchwarz::update(const PcgVectors& v, int k) {
  executor_.blocks(v.partition.n_blocks(),
                   UpdateResidual{v.partition, v.p, v.q, v.partial_pq, v.x, v.r, v.partial_rr, v.scalars, k});
  launch(v, v.scalars->state + k % 2);
}

std::string MultilevelSchwarz::fault_text(Index number) const {
  const Index level = number >> 48, node = number - level_fault(level, 0);
  if (level == 0) return "vertex " + std::to_string(node);
  return "cluster " + std::to_string(node) + " on level " + std::to_string(level);
}

}  // namespace bb::exec
