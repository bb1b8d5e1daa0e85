// One element of every energy: all models of membranes and of solids, springs, hinges, the strain limit.
#include <functional>
#include <memory>
#include <vector>

#include "barriers/shapes/registry.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/families/limit_family.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/energy/solid_model.hpp"
#include "core/exec/host_executor.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "experiments/microbenchmarks/cloth_stack.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"
#include "experiments/microbenchmarks/timed_family.hpp"

namespace bb::bench {
namespace {

/// One sheet of 64 x 64 vertices, strained by about 3 % and bent.
struct Sheet {
  Scene scene = cloth_stack(1, 64);
};

void value(benchmark::State& state, ElementFamily& family, const Positions& x) {
  std::vector<double> energy(static_cast<std::size_t>(family.size()));
  for (auto _ : state) {
    family.values(x.data(), energy.data());
    benchmark::DoNotOptimize(energy.data());
    benchmark::ClobberMemory();
  }
  count_items(state, static_cast<std::size_t>(family.size()));
}

using MakeFamily = std::function<MadeFamily(const FamilyPlace&, const Scene&)>;

void register_family(const std::string& name, const MakeFamily& make) {
  add("energy/" + name + "/value", [make](benchmark::State& state) {
    const Sheet sheet;
    exec::HostExecutor executor;
    value(state, *make({executor}, sheet.scene), sheet.scene.x0);
  });
  add("energy/" + name + "/gradient_and_hessian", [make](benchmark::State& state) {
    const Sheet sheet;
    exec::HostExecutor executor;
    derivatives(state, *make({executor}, sheet.scene), sheet.scene.x0);
  });
}

/// A block of 10368 tetrahedra, strained by about 3 %.
void solid(benchmark::State& state, std::string_view model, bool with_derivatives) {
  const TriangleMesh mesh = solid_box_mesh({12, 12, 12}, Vec3d(1, 1, 1));
  const std::vector<double> lame(mesh.tetrahedra.size(), 1e5);
  const SolidPart part{std::string(model), mesh.tetrahedra, lame, lame};
  exec::HostExecutor executor;
  const MadeFamily family = tetrahedron_family({executor}, part, mesh.vertices);
  const Positions x = moved(mesh.vertices, 2e-3, 2);
  with_derivatives ? derivatives(state, *family, x) : value(state, *family, x);
}

/// The limit of the sheet with the first shape of the registry; `terms` null for values.
void strain_limit(benchmark::State& state, bool with_derivatives) {
  const Sheet sheet;
  const StrainLimitPart& part = sheet.scene.limit;
  exec::HostExecutor executor;
  const auto limit = limited_triangles({executor}, part, sheet.scene.rest, false);
  const BarrierFunction barrier{all_shapes().front(), Argument::gap};
  limit->kappa().upload(std::vector<double>(part.width.size(), 1.0));
  LocalTerms terms;
  terms.resize(part.width.size(), 3);
  exec::Key beyond = ~exec::Key{0};
  const double* x = sheet.scene.x0.data();
  for (auto _ : state) {
    limit->measure(x, barrier, terms.energy.data(), &beyond);
    if (with_derivatives) limit->derivatives(x, Projection::psd, terms);
    benchmark::DoNotOptimize(terms.energy.data());
    benchmark::ClobberMemory();
  }
  count_items(state, part.width.size());
  if (with_derivatives) report_gradient(state, terms, part.width.size());
  double active = 0;
  for (std::size_t e = 0; e < part.width.size(); ++e)
    active += limit->smallest_gap(e) < part.width[e] ? 1 : 0;
  state.counters["active"] = active;
}

void strain_bound(benchmark::State& state) {
  const Sheet sheet;
  const StrainLimitPart& part = sheet.scene.limit;
  exec::HostExecutor executor;
  const auto limit = limited_triangles({executor}, part, sheet.scene.rest, false);
  const Positions dx = moved(sheet.scene.x0, 2e-3, 2) - sheet.scene.x0;
  double alpha = 0;
  for (auto _ : state) {
    limit->look_along(sheet.scene.x0.data(), dx.data(), 0);
    alpha = limit->bound();
    benchmark::DoNotOptimize(alpha);
  }
  count_items(state, part.width.size());
  state.counters["alpha"] = alpha;
}

}  // namespace

void register_energies() {
  for (const MembraneModel<double>& model : membrane_models<double>()) {
    register_family(std::string(model.name),
                    [&model, part = MembranePart()](const FamilyPlace& place, const Scene& scene) mutable {
                      part = scene.membranes.front();
                      part.model = model.name;
                      return membrane_family(place, part, scene.rest, false);
                    });
  }
  register_family("spring", [](const FamilyPlace& place, const Scene& scene) {
    const SpringPart& part = scene.springs;
    return spring_family(place, {}, part.edges, part.stiffness, lengths_of(part.edges, scene.rest));
  });
  register_family("hinge", [](const FamilyPlace& place, const Scene& scene) {
    return hinge_family(place, scene.hinges);
  });
  for (const SolidModel<double>& model : solid_models<double>()) {
    const std::string name = "energy/" + std::string(model.name) + "_solid";
    add(name + "/value", [&model](benchmark::State& state) { solid(state, model.name, false); });
    add(name + "/gradient_and_hessian",
        [&model](benchmark::State& state) { solid(state, model.name, true); });
  }
  add("energy/strain_limit/value", [](benchmark::State& state) { strain_limit(state, false); });
  add("energy/strain_limit/gradient_and_hessian", [](benchmark::State& state) { strain_limit(state, true); });
  add("energy/strain_limit/step_bound", strain_bound);
}

}  // namespace bb::bench
