// The stages of contact and the sum of a matrix beside the bytes that each has to read and write at least once, and the operations that it has
// to do: what is read is read once, from memory, and what it leaves is written once. On one thread, on a stack of cloths.
#include <tbb/global_control.h>

#include <vector>

#include "barriers/shapes/registry.hpp"
#include "core/contact/contact_system.hpp"
#include "core/contact/contact_terms.hpp"
#include "core/contact/motion_box.hpp"
#include "core/contact/surface.hpp"
#include "core/contact/tree_box.hpp"
#include "core/linear/block_system.hpp"
#include "experiments/microbenchmarks/cloth_stack.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

struct StageStack {
  const tbb::global_control one_thread{tbb::global_control::max_allowed_parallelism, 1};
  const Scene scene = cloth_stack(5, 32);
  const Positions x1 = moved(scene.x0, 1e-3, 2);
  const Surface surface{scene};
  ContactSystem contacts{scene, {}};
  ContactTable rows;
  MollifiedTable mollified;

  double n_vertices() const { return scene.n_vertices(); }
  double n_primitives() const {
    return static_cast<double>(surface.points.size() + surface.edges.size() + surface.triangles.size());
  }
  std::size_t n_candidates() const {
    const ContactSystem::Counts n = contacts.candidate_counts();
    return n.point_triangle + n.edge_edge;
  }
  double find_rows() { return contacts.find_rows(scene.x0, rows, mollified); }
};

constexpr double stage_point_bytes = 3 * sizeof(double), stage_pair_bytes = 2 * sizeof(int);

/// bytes, flop: of all items together.
void set_stage_floor(benchmark::State& state, std::size_t items, double bytes, double flop) {
  count_items(state, items);
  const auto n = static_cast<double>(items);
  state.counters["bytes"] = bytes / n;
  state.counters["flop"] = flop / n;
  state.counters["bytes_per_s"] = benchmark::Counter(bytes, benchmark::Counter::kIsIterationInvariantRate);
}

/// An item is a primitive: two states become boxes, and boxes a list of pairs.
void stage_broad_phase(benchmark::State& state) {
  StageStack stack;
  for (auto _ : state) stack.contacts.update_candidates(stack.scene.x0, stack.x1);
  const auto pairs = static_cast<double>(stack.n_candidates());
  const double boxes = stack.n_primitives() * sizeof(TreeBox);
  set_stage_floor(state, static_cast<std::size_t>(stack.n_primitives()),
                  2 * stack.n_vertices() * stage_point_bytes + 2 * boxes + pairs * stage_pair_bytes, 0);
  state.counters["pairs"] = pairs;
}

/// Of all columns of a row of the table.
double contact_row_bytes() {
  constexpr double doubles = 4 + 4 + 3 + 3 + 2 + 3 + 1 + 3, ints = 4 + 4 + 1;
  return doubles * sizeof(double) + ints * sizeof(int) + sizeof(PairId) + sizeof(KappaParts) +
         sizeof(ContactKind);
}

/// An item is a candidate: most are far, some become rows. Operations are not counted: closest points take other ways for every pair.
void stage_rows(benchmark::State& state) {
  StageStack stack;
  stack.contacts.update_candidates(stack.scene.x0, stack.x1);
  for (auto _ : state) benchmark::DoNotOptimize(stack.find_rows());
  const std::size_t n = stack.n_candidates();
  set_stage_floor(state, n,
                  static_cast<double>(n) * stage_pair_bytes + stack.n_vertices() * stage_point_bytes +
                      static_cast<double>(stack.rows.size()) * contact_row_bytes(),
                  0);
  state.counters["rows"] = static_cast<double>(stack.rows.size() + stack.mollified.size());
}

/// An item is a candidate, of which most are decided by their boxes: on both sides of three axes two differences and a quotient, then one product.
void stage_bound(benchmark::State& state) {
  StageStack stack;
  stack.contacts.update_candidates(stack.scene.x0, stack.x1);
  long long queries = 0;
  for (auto _ : state) {
    queries = stack.contacts.step_bound(stack.scene.x0, stack.x1).queries;
    benchmark::DoNotOptimize(queries);
  }
  const std::size_t n = stack.n_candidates();
  const double boxes = stack.n_primitives() * sizeof(MotionBox);
  set_stage_floor(
      state, n,
      static_cast<double>(n) * stage_pair_bytes + 2 * stack.n_vertices() * stage_point_bytes + 2 * boxes,
      (2 * 3 * 3 + 1) * static_cast<double>(n));
  state.counters["queries"] = static_cast<double>(queries);
}

/// An item is a row, whose numbers are added to the blocks of the matrix and to the gradient; the stencils stay.
void stage_assembly(benchmark::State& state) {
  StageStack stack;
  stack.contacts.update_candidates(stack.scene.x0, stack.scene.x0);
  stack.find_rows();
  ContactTable& rows = stack.rows;
  const std::size_t n = rows.size();
  rows.kappa.assign(n, 1.0);
  const BarrierFunction barrier{all_shapes().front(), Argument::gap};
  barrier.eval(n, rows.d.data(), rows.d_hat.data(), rows.b.data(), rows.db.data(), rows.d2b.data());
  std::vector<double> grad, hess;
  contact_terms(rows, stack.scene.x0, HessianMode::projected_full, Projection::psd, grad, hess);
  const auto n_fixed = 3 * static_cast<std::size_t>(stack.scene.n_vertices());
  BlockSystem blocks(stack.scene.n_vertices(), std::vector<std::uint8_t>(n_fixed, 0));
  blocks.set_elements({});
  blocks.set_contacts({{4, rows.vertex}});
  Positions gradient = Positions::Zero(3, stack.scene.n_vertices());
  for (auto _ : state) {
    blocks.clear();
    blocks.add_contacts(0, hess);
    blocks.gather_contacts(0, grad, gradient);
    benchmark::DoNotOptimize(gradient.data());
    benchmark::ClobberMemory();
  }
  const auto numbers = static_cast<double>(grad.size() + hess.size());
  const auto values = static_cast<double>(blocks.values().size());
  set_stage_floor(state, n, sizeof(double) * (numbers + 2 * values + 2 * 3 * stack.n_vertices()), numbers);
}

}  // namespace

void register_stages() {
  add("stages/broad_phase", stage_broad_phase);
  add("stages/rows", stage_rows);
  add("stages/step_bound", stage_bound);
  add("stages/assembly", stage_assembly);
}

}  // namespace bb::bench
