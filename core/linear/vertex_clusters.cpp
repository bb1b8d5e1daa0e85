#include "core/linear/vertex_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "core/math/at.hpp"

namespace bb {
namespace {

/// Couplings by block rows, 0 for the diagonal.
std::vector<double> couplings(const BlockGraph& graph) {
  std::vector<double> scale(at(graph.n()), 0.0), out(graph.column.size());
  const auto for_blocks = [&graph](const auto& f) {
    for (int r = 0; r < graph.n(); ++r) {
      for (std::int64_t k = graph.row_start[at(r)]; k < graph.row_start[at(r) + 1]; ++k) {
        f(r, graph.column[at(k)], at(k));
      }
    }
  };
  for_blocks([&](int r, int c, std::size_t k) {
    if (r == c) scale[at(r)] += graph.norm[k];
  });
  for (double& s : scale) s = std::sqrt(s);
  for_blocks([&](int r, int c, std::size_t k) {
    const double both = scale[at(r)] * scale[at(c)];
    out[k] = r == c || both == 0 ? 0 : graph.norm[k] / both;
  });
  return out;
}

class Greedy {
 public:
  Greedy(const BlockGraph& graph, int vertices)
      : graph_(graph), coupling_(couplings(graph)), vertices_(vertices), score_(at(graph.n()), 0.0) {
    clusters_.of.assign(at(graph.n()), -1);
  }

  VertexClusters run() {
    for (int v = 0; v < graph_.n(); ++v) {
      if (clusters_.of[at(v)] < 0) grow(v);
    }
    number();
    return std::move(clusters_);
  }

 private:
  using Candidate = std::pair<double, int>;  // score, minus the vertex: equal scores go by number

  template <class F>
  void for_neighbours(int v, const F& f) const {
    for (std::int64_t k = graph_.row_start[at(v)]; k < graph_.row_start[at(v) + 1]; ++k) {
      if (graph_.column[at(k)] != v) f(graph_.column[at(k)], coupling_[at(k)]);
    }
  }

  void grow(int seed) {
    std::priority_queue<Candidate> candidates;
    std::vector<int> members;
    const auto take = [&](int v) {
      clusters_.of[at(v)] = n_clusters_;
      members.push_back(v);
      for_neighbours(v, [&](int u, double coupling) {
        if (clusters_.of[at(u)] < 0) candidates.emplace(score_[at(u)] += coupling, -u);
      });
    };
    take(seed);
    while (static_cast<int>(members.size()) < vertices_ && !candidates.empty()) {
      const auto [score, minus_vertex] = candidates.top();
      candidates.pop();
      const int v = -minus_vertex;
      if (clusters_.of[at(v)] < 0 && score == score_[at(v)]) take(v);  // others are out of date
    }
    for (; !candidates.empty(); candidates.pop()) score_[at(-candidates.top().second)] = 0;
    const int joined = 2 * static_cast<int>(members.size()) < vertices_ ? strongest(members) : -1;
    if (joined >= 0 && size_[at(joined)] <= vertices_) {
      for (const int v : members) clusters_.of[at(v)] = joined;
      size_[at(joined)] += static_cast<int>(members.size());
    } else {
      size_.push_back(static_cast<int>(members.size()));
      ++n_clusters_;
    }
  }

  // The other cluster with the largest coupling to these vertices, -1 without one.
  int strongest(const std::vector<int>& members) const {
    std::vector<std::pair<int, double>> sums;
    for (const int v : members) {
      for_neighbours(v, [&](int u, double coupling) {
        const int other = clusters_.of[at(u)];
        if (other >= 0 && other != n_clusters_) sums.emplace_back(other, coupling);
      });
    }
    std::stable_sort(sums.begin(), sums.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    int best = -1;
    double largest = 0;
    for (std::size_t i = 0; i < sums.size();) {
      const int cluster = sums[i].first;
      double sum = 0;
      for (; i < sums.size() && sums[i].first == cluster; ++i) sum += sums[i].second;
      if (sum <= largest) continue;
      largest = sum;
      best = cluster;
    }
    return best;
  }

  void number() {
    clusters_.start.assign(at(n_clusters_) + 1, 0);
    for (const int cluster : clusters_.of) ++clusters_.start[at(cluster) + 1];
    for (int k = 0; k < n_clusters_; ++k) clusters_.start[at(k) + 1] += clusters_.start[at(k)];
    clusters_.member.resize(clusters_.of.size());
    std::vector<int> cursor(clusters_.start.begin(), clusters_.start.end() - 1);
    for (int v = 0; v < graph_.n(); ++v) clusters_.member[at(cursor[at(clusters_.of[at(v)])]++)] = v;
  }

  const BlockGraph& graph_;
  const std::vector<double> coupling_;
  int vertices_, n_clusters_ = 0;
  std::vector<double> score_;  // of vertices without a cluster: coupling to the one that grows
  std::vector<int> size_;
  VertexClusters clusters_;
};

}  // namespace

VertexClusters cluster_vertices(const BlockGraph& graph, int vertices) {
  return Greedy(graph, vertices).run();
}

VertexClusters cluster_vertices(const SymmetricProduct& rows, int vertices) {
  BlockGraph graph;
  graph.row_start.assign(rows.row_start().begin(), rows.row_start().end());
  graph.column = rows.column();
  graph.norm.resize(graph.column.size());
  for (std::size_t k = 0; k < graph.norm.size(); ++k) {
    graph.norm[k] = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(rows.block(static_cast<int>(k))).norm();
  }
  return cluster_vertices(graph, vertices);
}

}  // namespace bb
