// Closest points of random pairs: all regions occur, as they do behind a broad phase.
#include <random>
#include <vector>

#include "core/geometry/closest_points.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

constexpr std::size_t kPairs = 1024;

template <PairKind K, class T>
void closest_points_of(benchmark::State& state) {
  using Points = Mat<T, 3, pair_points(K)>;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<T> unit(T(-1), T(1));
  std::vector<Points> pairs(kPairs);
  for (Points& points : pairs) {
    for (Eigen::Index i = 0; i < points.size(); ++i) points.data()[i] = unit(random);
  }
  for (auto _ : state) {
    T sum = 0;
    for (const Points& points : pairs) sum += closest_points<K, T>(points).d;
    benchmark::DoNotOptimize(sum);
  }
  count_items(state, kPairs);
}

template <PairKind K>
void register_pairs() {
  const std::string name = std::string("closest_points/") + pair_name(K);
  add(name + "/double", closest_points_of<K, double>);
  add(name + "/float", closest_points_of<K, float>);
}

}  // namespace

void register_closest_points() {
  register_pairs<PairKind::point_point>();
  register_pairs<PairKind::point_edge>();
  register_pairs<PairKind::point_triangle>();
  register_pairs<PairKind::edge_edge>();
}

}  // namespace bb::bench
