// The broad phase on a stack of cloths, per primitive: one tree built, refitted and queried; then everything
// that one Newton iteration needs.
#include <vector>

#include "core/contact/bvh.hpp"
#include "core/contact/contact_system.hpp"
#include "core/contact/surface.hpp"
#include "experiments/microbenchmarks/cloth_stack.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

struct Stack {
  Scene scene = cloth_stack(5, 48);
  Surface surface{scene};
  std::vector<TreeBox> boxes;  // of the edges, the most numerous primitives

  Stack() {
    boxes.resize(surface.edges.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (const int v : surface.edges.vertices[i]) boxes[i].add(Vec3d(scene.x0.col(v)));
      boxes[i].inflate(surface.edges.side[i].d_hat / 2);
    }
  }
};

void build(benchmark::State& state) {
  const Stack stack;
  for (auto _ : state) {
    Bvh bvh;
    bvh.update(stack.boxes, stack.surface.edges.free);
    benchmark::DoNotOptimize(bvh.primitive(0));
  }
  count_items(state, stack.boxes.size());
}

void refit(benchmark::State& state) {
  const Stack stack;
  Bvh bvh;
  bvh.update(stack.boxes, stack.surface.edges.free);
  for (auto _ : state) {
    bvh.update(stack.boxes, stack.surface.edges.free);
    benchmark::DoNotOptimize(bvh.primitive(0));
  }
  if (bvh.builds() != 1) state.SkipWithError("the tree was built again");
  count_items(state, stack.boxes.size());
}

void tree_query(benchmark::State& state) {
  const Stack stack;
  Bvh bvh;
  bvh.update(stack.boxes, stack.surface.edges.free);
  const auto edge = [&](int i) { return stack.surface.edges.vertices[static_cast<std::size_t>(i)]; };
  PairFinder finder;
  std::vector<IndexPair> pairs;
  for (auto _ : state) {
    finder.find(
        bvh, bvh, [&](IndexPair p) { return Surface::disjoint(edge(p.first), edge(p.second)); }, pairs);
    benchmark::DoNotOptimize(pairs.data());
  }
  count_items(state, stack.boxes.size());
  state.counters["pairs"] = static_cast<double>(pairs.size());
}

/// Boxes, refit and queries of all three trees, as between two Newton iterations.
void update(benchmark::State& state) {
  const Stack stack;
  ContactSystem contacts(stack.scene, {});
  const Positions& x0 = stack.scene.x0;
  const Positions x1 = moved(x0, 1e-3, 2);
  for (auto _ : state) contacts.update_candidates(x0, x1);
  count_items(state,
              stack.surface.points.size() + stack.surface.edges.size() + stack.surface.triangles.size());
  const ContactSystem::Counts counts = contacts.candidate_counts();
  state.counters["pairs"] = static_cast<double>(counts.point_triangle + counts.edge_edge);
}

}  // namespace

void register_broad_phase() {
  add("broad_phase/build", build);
  add("broad_phase/refit", refit);
  add("broad_phase/query", tree_query);
  add("broad_phase/update", update);
}

}  // namespace bb::bench
