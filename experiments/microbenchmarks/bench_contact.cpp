// The contact rows of a stack of cloths: found by the narrow phase, bounded by ACCD, evaluated, assembled.
#include <algorithm>
#include <vector>

#include "barriers/shapes/registry.hpp"
#include "core/contact/contact_system.hpp"
#include "core/contact/contact_terms.hpp"
#include "core/contact/numeric_projection.hpp"
#include "core/linear/block_system.hpp"
#include "experiments/config/enum_words.hpp"
#include "experiments/microbenchmarks/cloth_stack.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"

namespace bb::bench {
namespace {

struct Contacts {
  Scene scene = cloth_stack(3, 32);
  ContactSystem system{scene, {}};
  ContactTable rows;
  MollifiedTable mollified;
  std::vector<double> energy, grad, hess;

  Contacts() {
    system.update_candidates(scene.x0, scene.x0);
    system.find_rows(scene.x0, rows, mollified);
    const BarrierFunction barrier{all_shapes().front(), Argument::gap};
    evaluate(barrier, rows);
    evaluate(barrier, mollified);
  }
  template <class Table>
  static void evaluate(const BarrierFunction& barrier, Table& table) {
    table.kappa.assign(table.size(), 1.0);
    barrier.eval(table.size(), table.d.data(), table.d_hat.data(), table.b.data(), table.db.data(),
                 table.d2b.data());
  }
};

std::size_t n_candidates(const ContactSystem& system) {
  const ContactSystem::Counts counts = system.candidate_counts();
  return counts.point_triangle + counts.edge_edge + counts.obstacle;
}

void find_rows(benchmark::State& state) {
  Contacts contacts;
  for (auto _ : state) {
    benchmark::DoNotOptimize(contacts.system.find_rows(contacts.scene.x0, contacts.rows, contacts.mollified));
  }
  count_items(state, n_candidates(contacts.system));
  state.counters["rows"] = static_cast<double>(contacts.rows.size());
  state.counters["mollified"] = static_cast<double>(contacts.mollified.size());
}

void contact_bound(benchmark::State& state) {
  Contacts contacts;
  const Positions& x0 = contacts.scene.x0;
  const Positions x1 = moved(x0, 2e-3, 2);
  contacts.system.update_candidates(x0, x1);
  long long queries = 0;
  for (auto _ : state) {
    queries = contacts.system.step_bound(x0, x1).queries;
    benchmark::DoNotOptimize(queries);
  }
  count_items(state, n_candidates(contacts.system));
  state.counters["accd_queries"] = static_cast<double>(queries);
}

void contact_value(benchmark::State& state) {
  Contacts contacts;
  for (auto _ : state) {
    contact_energies(contacts.rows, contacts.energy);
    benchmark::DoNotOptimize(contacts.energy.data());
    benchmark::ClobberMemory();
  }
  count_items(state, contacts.rows.size());
}

void gradient_and_hessian(benchmark::State& state, HessianMode mode) {
  Contacts contacts;
  for (auto _ : state) {
    contact_terms(contacts.rows, contacts.scene.x0, mode, Projection::psd, contacts.grad, contacts.hess);
    benchmark::DoNotOptimize(contacts.hess.data());
    benchmark::ClobberMemory();
  }
  count_items(state, contacts.rows.size());
}

/// From the exact 12 x 12 matrices alone; each iteration copies them first.
void projection(benchmark::State& state, HessianMode mode) {
  Contacts contacts;
  contact_terms(contacts.rows, contacts.scene.x0, mode, Projection::none, contacts.grad, contacts.hess);
  std::vector<double> hess(contacts.hess.size());
  for (auto _ : state) {
    std::copy(contacts.hess.begin(), contacts.hess.end(), hess.begin());
    project_numerically(mode, Projection::psd, contacts.rows.size(), hess.data());
    benchmark::DoNotOptimize(hess.data());
    benchmark::ClobberMemory();
  }
  count_items(state, contacts.rows.size());
}

void mollified_value(benchmark::State& state) {
  Contacts contacts;
  for (auto _ : state) {
    mollified_energies(contacts.mollified, contacts.scene.x0, contacts.energy);
    benchmark::DoNotOptimize(contacts.energy.data());
    benchmark::ClobberMemory();
  }
  count_items(state, contacts.mollified.size());
}

void mollified_gradient_and_hessian(benchmark::State& state) {
  Contacts contacts;
  for (auto _ : state) {
    mollified_terms(contacts.mollified, contacts.scene.x0, Projection::psd, contacts.grad, contacts.hess);
    benchmark::DoNotOptimize(contacts.hess.data());
    benchmark::ClobberMemory();
  }
  count_items(state, contacts.mollified.size());
}

void contact_assembly(benchmark::State& state) {
  Contacts contacts;
  const int n = contacts.scene.n_vertices();
  contact_terms(contacts.rows, contacts.scene.x0, HessianMode::gauss_newton, Projection::psd, contacts.grad,
                contacts.hess);
  BlockSystem blocks(n, std::vector<std::uint8_t>(3 * static_cast<std::size_t>(n), 0));
  blocks.set_elements({});
  Positions gradient = Positions::Zero(3, n);
  for (auto _ : state) {
    blocks.set_contacts({{4, contacts.rows.vertex}});
    blocks.clear();
    blocks.add_contacts(0, contacts.hess);
    blocks.gather_contacts(0, contacts.grad, gradient);
    benchmark::DoNotOptimize(gradient.data());
    benchmark::ClobberMemory();
  }
  count_items(state, contacts.rows.size());
}

}  // namespace

void register_contact() {
  add("contact/find_rows", find_rows);
  add("contact/step_bound", contact_bound);
  add("contact/value", contact_value);
  for (const auto& [mode, word] : words_of(HessianMode())) {
    add("contact/gradient_and_hessian/" + word,
        [mode](benchmark::State& state) { gradient_and_hessian(state, mode); });
    if (!is_numeric(mode)) continue;
    add("contact/projection/" + word, [mode](benchmark::State& state) { projection(state, mode); });
  }
  add("contact/mollified/value", mollified_value);
  add("contact/mollified/gradient_and_hessian", mollified_gradient_and_hessian);
  add("contact/assembly", contact_assembly);
}

}  // namespace bb::bench
