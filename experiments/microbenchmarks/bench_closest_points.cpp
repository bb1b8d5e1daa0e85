// Closest points of random pairs: all regions occur, as they do behind a broad phase.
#include <random>
#include <vector>

#include "core/geometry/closest_points.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

constexpr std::size_t kQueries = 1024;

template <PairKind K, class T>
void query(benchmark::State& state) {
  using Points = Mat<T, 3, pair_points(K)>;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<T> unit(T(-1), T(1));
  std::vector<Points> pairs(kQueries);
  for (Points& points : pairs) {
    for (Eigen::Index i = 0; i < points.size(); ++i) points.data()[i] = unit(random);
  }
  for (auto _ : state) {
    T sum = 0;
    for (const Points& points : pairs) sum += closest_points<K, T>(points).d;
    benchmark::DoNotOptimize(sum);
  }
  count_items(state, kQueries);
}

template <PairKind K>
void register_kind() {
  const std::string name = std::string("closest_points/") + pair_name(K);
  add(name + "/double", query<K, double>);
  add(name + "/float", query<K, float>);
}

}  // namespace

void register_closest_points() {
  register_kind<PairKind::point_point>();
  register_kind<PairKind::point_edge>();
  register_kind<PairKind::point_triangle>();
  register_kind<PairKind::edge_edge>();
}

}  // namespace bb::bench
