#include "core/linear/executor/schwarz_level.hpp"

#include <algorithm>

#include "core/math/at.hpp"

namespace bb::exec {
SchwarzLevel::SchwarzLevel(Executor& executor)
    : executor_(executor),
      start_(executor, "clusters"),
      member_(executor, "cluster members"),
      of_(executor, "cluster of a node"),
      place_(executor, "place in a cluster"),
      offset_(executor, "cluster factor offsets"),
      factor_(executor, "cluster factors"),
      fixed_(executor, "coarse fixed degrees of freedom"),
      row_begin_(executor, "coarse matrix rows"),
      source_begin_(executor, "coarse sums"),
      source_(executor, "coarse summands"),
      column_(executor, "coarse matrix columns"),
      source_row_(executor, "coarse summand rows"),
      value_(executor, "coarse matrix values"),
      r_(executor, "coarse residual"),
      z_(executor, "coarse preconditioned residual") {}

void SchwarzLevel::set_clusters(const VertexClusters& clusters, Index n_nodes) {
  std::vector<int> place(at(n_nodes));
  std::vector<Index> offset;
  Index n_numbers = 0;
  for (int k = 0; k < clusters.size(); ++k) {
    const int begin = clusters.start[at(k)], end = clusters.start[at(k) + 1];
    for (int m = begin; m < end; ++m) place[at(clusters.member[at(m)])] = m - begin;
    offset.push_back(n_numbers);
    n_numbers += 9 * Index{end - begin} * (end - begin);
  }
  start_.upload(clusters.start), member_.upload(clusters.member), of_.upload(clusters.of);
  place_.upload(place), offset_.upload(offset);
  factor_.resize(n_numbers);
}

HostPattern SchwarzLevel::set_coarse(const HostPattern& below, const VertexClusters& clusters,
                                     const std::vector<FixedMask>& fixed_below,
                                     std::vector<FixedMask>& fixed) {
  struct Summand {
    int column;
    Index source;
    int row;
  };
  HostPattern out;
  std::vector<Index> sources, source_begin;
  std::vector<int> source_row;
  std::vector<Summand> summands;
  out.graph.row_start.push_back(0);
  fixed.assign(at(clusters.size()), FixedMask{7});
  for (int k = 0; k < clusters.size(); ++k) {
    summands.clear();
    for (int m = clusters.start[at(k)]; m < clusters.start[at(k) + 1]; ++m) {
      const int v = clusters.member[at(m)];
      fixed[at(k)] = fixed[at(k)] & fixed_below[at(v)];
      for (Index j = below.graph.row_start[at(v)]; j < below.graph.row_start[at(v) + 1]; ++j) {
        summands.push_back({clusters.of[at(below.graph.column[at(j)])], below.source[at(j)], v});
      }
    }
    std::stable_sort(summands.begin(), summands.end(),
                     [](const Summand& a, const Summand& b) { return a.column < b.column; });
    for (std::size_t i = 0; i < summands.size(); ++i) {
      if (i == 0 || summands[i].column != summands[i - 1].column) {
        out.source.push_back(ExecutorMatrix::most_parts * static_cast<Index>(out.graph.column.size()));
        out.graph.column.push_back(summands[i].column);
        source_begin.push_back(static_cast<Index>(sources.size()));
      }
      sources.push_back(summands[i].source);
      source_row.push_back(summands[i].row);
    }
    out.graph.row_start.push_back(static_cast<Index>(out.graph.column.size()));
  }
  source_begin.push_back(static_cast<Index>(sources.size()));
  fixed_.upload(fixed);
  row_begin_.upload(out.graph.row_start), column_.upload(out.graph.column);
  source_begin_.upload(source_begin), source_.upload(sources), source_row_.upload(source_row);
  value_.resize(value_count(column_.size()));
  r_.resize(3 * clusters.size()), z_.resize(3 * clusters.size());
  return out;
}

void SchwarzLevel::launch_values(const ExecutorMatrix& below, const FixedMask* fixed_below) {
  executor_.each(9 * column_.size(), CoarseValues{below, fixed_below, source_begin_.data(), source_.data(),
                                                  source_row_.data(), value_.data()});
}

ClusterLevel SchwarzLevel::view(const FixedMask* fixed) {
  return {offset_.size(), start_.data(), member_.data(), of_.data(),
          place_.data(),  fixed,         offset_.data(), factor_.data()};
}

void SchwarzLevel::launch_factors(const ExecutorMatrix& matrix, const FixedMask* fixed, Index number,
                                  FactorFaults* faults) {
  executor_.blocks(offset_.size(), FactorizeClusters{view(fixed), matrix, number, faults});
}

void SchwarzLevel::launch_solves(const FixedMask* fixed, const double* r, double* z, double* coarse_r,
                                 const CgState* state) {
  constexpr Index each = SolveClusters::clusters_a_block;
  executor_.blocks((offset_.size() + each - 1) / each, SolveClusters{view(fixed), r, z, coarse_r, state});
}

}  // namespace bb::exec
