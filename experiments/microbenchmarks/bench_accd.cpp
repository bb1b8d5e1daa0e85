// ACCD of one pair. Primitives of size 1 lie around the origin, the second one moves:
//   hitting   through the first one
//   missing   past it: it comes down to half its gap, turning a little
//   sliding   along it at a constant gap of 100 stop levels
#include <random>
#include <vector>

#include "core/geometry/accd.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

constexpr std::size_t kMotions = 1024;

enum class Motion { hitting, missing, sliding };
constexpr const char* kMotionNames[] = {"hitting", "missing", "sliding"};

template <class T>
struct Query {
  Mat<T, 3, 4> x0, x1;
};

/// Two primitives in the planes z = 0 and z = gap that cross at the origin.
template <PairKind K, class T>
Mat<T, 3, 4> resting_pair(T gap) {
  Mat<T, 3, 4> x = Mat<T, 3, 4>::Zero();
  if constexpr (K == PairKind::point_triangle) {
    x.col(0) << 0, 0, gap;
    x.col(1) << T(-0.5), T(-0.3), 0;
    x.col(2) << T(0.5), T(-0.3), 0;
    x.col(3) << 0, T(0.6), 0;
  } else {
    x.col(0) << T(-0.5), 0, gap;
    x.col(1) << T(0.5), 0, gap;
    x.col(2) << 0, T(-0.5), 0;
    x.col(3) << 0, T(0.5), 0;
  }
  return x;
}

template <PairKind K, class T>
std::vector<Query<T>> make_queries(Motion motion, T park) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<T> unit(T(-1), T(1));
  const T gap = motion == Motion::sliding ? 100 * park : T(0.01);
  std::vector<Query<T>> queries(kMotions);
  for (Query<T>& q : queries) {
    q.x0 = resting_pair<K, T>(gap);
    Mat<T, 3, 4> drift = Mat<T, 3, 4>::Zero();
    const T across = motion == Motion::sliding ? T(0.2) : T(0.02);
    for (int i = 0; i < 4; ++i) {
      const T side = across * unit(random), turn = across * unit(random);
      drift.col(i) << side, turn, motion == Motion::sliding ? T(0) : T(0.1) * gap * unit(random);
    }
    const T down = motion == Motion::hitting ? -2 * gap : motion == Motion::missing ? -gap / 2 : T(0);
    for (int i = 0; i < pair_split(K); ++i) drift(2, i) += down;
    q.x1 = q.x0 + drift;
  }
  return queries;
}

template <PairKind K, class T>
void accd(benchmark::State& state, Motion motion) {
  const T park = std::is_same_v<T, float> ? T(1e-5) : T(1e-8);
  const std::vector<Query<T>> queries = make_queries<K, T>(motion, park);
  long long probes = 0, hits = 0;
  for (auto _ : state) {
    probes = hits = 0;
    for (const Query<T>& q : queries) {
      const AccdResult<T> result = bb::accd<K, T>(q.x0, q.x1, T(0), park);
      probes += result.probes;
      hits += result.hit;
    }
    benchmark::DoNotOptimize(probes);
  }
  const long long expected = motion == Motion::hitting ? static_cast<long long>(kMotions) : 0;
  if (hits != expected) state.SkipWithError("another number of hits than the motion is made for");
  count_items(state, kMotions);
  state.counters["probes"] = static_cast<double>(probes) / static_cast<double>(kMotions);
}

template <PairKind K>
void register_motions() {
  for (const Motion motion : {Motion::hitting, Motion::missing, Motion::sliding}) {
    const std::string name =
        std::string("accd/") + pair_name(K) + "/" + kMotionNames[static_cast<int>(motion)];
    add(name + "/double", [motion](benchmark::State& state) { accd<K, double>(state, motion); });
    add(name + "/float", [motion](benchmark::State& state) { accd<K, float>(state, motion); });
  }
}

}  // namespace

void register_accd() {
  register_motions<PairKind::point_triangle>();
  register_motions<PairKind::edge_edge>();
}

}  // namespace bb::bench
