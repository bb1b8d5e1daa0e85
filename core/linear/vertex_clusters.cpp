#include "core/linear/vertex_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace bb {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

double norm(const double* block) { return Eigen::Map<const Eigen::Matrix<double, 9, 1>>(block).norm(); }

/// Couplings by block rows, 0 for the diagonal.
std::vector<double> couplings(const SymmetricProduct& rows) {
  std::vector<double> scale(at(rows.n_blocks()), 0.0), out(rows.column().size());
  const auto for_blocks = [&rows](const auto& f) {
    for (int r = 0; r < rows.n_blocks(); ++r) {
      for (int k = rows.row_start()[at(r)]; k < rows.row_start()[at(r) + 1]; ++k)
        f(r, rows.column()[at(k)], k);
    }
  };
  for_blocks([&](int r, int c, int k) {
    if (r == c) scale[at(r)] = std::sqrt(norm(rows.block(k)));
  });
  for_blocks([&](int r, int c, int k) {
    const double both = scale[at(r)] * scale[at(c)];
    out[at(k)] = r == c || both == 0 ? 0 : norm(rows.block(k)) / both;
  });
  return out;
}

class Greedy {
 public:
  Greedy(const SymmetricProduct& rows, int vertices)
      : rows_(rows), coupling_(couplings(rows)), vertices_(vertices), score_(at(rows.n_blocks()), 0.0) {
    clusters_.of.assign(at(rows.n_blocks()), -1);
  }

  VertexClusters run() {
    for (int v = 0; v < rows_.n_blocks(); ++v) {
      if (clusters_.of[at(v)] < 0) grow(v);
    }
    number();
    return std::move(clusters_);
  }

 private:
  using Candidate = std::pair<double, int>;  // score, minus the vertex: equal scores go by number

  template <class F>
  void for_neighbours(int v, const F& f) const {
    for (int k = rows_.row_start()[at(v)]; k < rows_.row_start()[at(v) + 1]; ++k) {
      if (rows_.column()[at(k)] != v) f(rows_.column()[at(k)], coupling_[at(k)]);
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
    for (int v = 0; v < rows_.n_blocks(); ++v) clusters_.member[at(cursor[at(clusters_.of[at(v)])]++)] = v;
  }

  const SymmetricProduct& rows_;
  const std::vector<double> coupling_;
  int vertices_, n_clusters_ = 0;
  std::vector<double> score_;  // of vertices without a cluster: coupling to the one that grows
  std::vector<int> size_;
  VertexClusters clusters_;
};

}  // namespace

VertexClusters cluster_vertices(const SymmetricProduct& rows, int vertices) {
  return Greedy(rows, vertices).run();
}

}  // namespace bb
