// One element of every other kind of a scene: rods, springs of cloth, stitches, loads, drag of the air, pressure, and one contact
// that rubs or damps. With energies (membranes, solids, springs, hinges, the limit) these are all kinds that a scene can have.
#include <cmath>
#include <memory>
#include <vector>

#include "core/energy/families/families.hpp"
#include "core/energy/friction.hpp"
#include "core/energy/friction_law.hpp"
#include "core/energy/restitution.hpp"
#include "core/exec/host_executor.hpp"
#include "core/model/bodies/scene_builder.hpp"
#include "core/model/mesh/generators.hpp"
#include "core/model/mesh/strand_generators.hpp"
#include "experiments/microbenchmarks/cloth_stack.hpp"
#include "experiments/microbenchmarks/microbenchmark.hpp"
#include "experiments/microbenchmarks/timed_family.hpp"

namespace bb::bench {
namespace {

BodySpec body(const std::string& name, TriangleMesh mesh) {
  BodySpec spec;
  spec.name = name;
  spec.mesh = std::move(mesh);
  spec.d_hat = 1e-3;
  return spec;
}

/// Half of the vertices of a grid are pulled by soft pins.
PinSpec soft_pins(int n) {
  PinSpec pins;
  for (int v = 0; v < n / 2; ++v) pins.indices.push_back(v);
  pins.pull = 5.0;
  return pins;
}

/// A rod of 4096 segments, a sheet of 64 x 64 vertices and a ball of 2562, each strained by about 3 % of an edge and moving.
Scene scene_of_kinds() {
  SceneBuilder builder("kinds", false, Vec3d(0, 0, -9.81), "kinds");
  BodySpec rod = body("rod", rod_mesh(4096, Vec3d(0, 3, 0), Vec3d(64, 3, 0)));
  rod.material.line_density = 0.01;
  rod.material.springs = 100;
  rod.material.rod_bending = 1e-3;
  builder.add_body(rod);
  BodySpec sheet = body("sheet", grid_mesh(64, 64, 1.0, 1.0));
  sheet.material.cloth_tension = 10;
  sheet.material.cloth_shear = 5;
  sheet.pins = {soft_pins(64 * 64)};
  builder.add_body(sheet);
  BodySpec ball = body("ball", icosphere_mesh(4, 0.5));
  ball.mesh.vertices.colwise() += Vec3d(0, -3, 0);
  ball.pressure = 100;
  builder.add_body(ball);
  builder.set_air({0.1, 0.05, Vec3d(1, 0, 0.2), {}});
  StitchSpec stitch{"sheet", "ball", {}, {}, 3.0, 0.0};
  for (int v = 0; v < 2562; ++v) {
    stitch.a_vertices.push_back(v);
    stitch.b_vertices.push_back(v);
  }
  builder.add_stitch(stitch, "kinds");
  Scene scene = builder.finish();
  scene.x0 = moved(scene.rest, 4e-4, 1);
  return scene;
}

void family(benchmark::State& state, ElementFamily& elements, const Scene& scene) {
  constexpr double dt = 0.01;
  FamilyStep step;
  step.x_n = scene.rest.data();
  step.x_tilde = scene.x0.data();
  step.dt = step.t_end = dt;
  elements.begin_step(step);
  const Positions x = moved(scene.x0, 4e-4, 2);  // away from the start, where soft pins and inertia pull
  derivatives(state, elements, x);
}

using MakeKind = MadeFamily (*)(const FamilyPlace&, const Scene&);

void register_kind(const std::string& name, MakeKind make) {
  add("energy/" + name + "/gradient_and_hessian", [make](benchmark::State& state) {
    const Scene scene = scene_of_kinds();
    exec::HostExecutor executor;
    family(state, *make({executor}, scene), scene);
  });
}

/// Motions of contacts in a step: half of them stick, half slide.
std::vector<Vec3d> slides(std::size_t n, double eps) {
  std::vector<Vec3d> out;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 0.7 * static_cast<double>(i), length = eps * (i % 2 == 0 ? 0.4 : 5.0);
    out.emplace_back(length * std::cos(angle), length * std::sin(angle), 0.1 * eps);
  }
  return out;
}

/// Gradient and Hessian of a contact of four points, from its motion.
template <class F>
void contact_motion(benchmark::State& state, const F& terms_of) {
  constexpr std::size_t n = 4096;
  const std::vector<Vec3d> motions = slides(n, 1e-5);
  const Vec<double, 4> weights(1, -0.2, -0.3, -0.5);
  double force = 0;
  for (auto _ : state) {
    force = 0;
    for (const Vec3d& motion : motions) {
      const ElementTerms<double, 12> terms = motion_in_points<double, 4>(terms_of(motion), weights);
      benchmark::DoNotOptimize(terms.hess.data());
      force += terms.grad.norm();
    }
    benchmark::DoNotOptimize(force);
  }
  count_items(state, n);
  state.counters["gradient"] = force / static_cast<double>(n);
}

void register_contact_motions() {
  for (const FrictionLaw<double>& law : friction_laws_in<double>()) {
    add("energy/friction_" + std::string(law.name) + "/gradient_and_hessian",
        [&law](benchmark::State& state) {
          contact_motion(state, [&law](const Vec3d& motion) {
            const Vec3d normal = Vec3d::UnitZ(), slide = slide_of<double>(motion, normal);
            const auto eval = [&law](double y) { return law.eval(y, {1e-5, 0.5, 1e-4}); };
            return friction_of_slide<double>(slide, normal, 0.3, eval);
          });
        });
  }
  add("energy/restitution/gradient_and_hessian", [](benchmark::State& state) {
    contact_motion(state, [](const Vec3d& motion) {
      return damping_terms<double>(motion, Vec3d::UnitZ(), ContactDamping<double>{100.0, 1.0});
    });
  });
}

}  // namespace

void register_kinds() {
  register_kind("rod",
                [](const FamilyPlace& place, const Scene& scene) { return rod_family(place, scene.rods); });
  register_kind("cloth_spring", [](const FamilyPlace& place, const Scene& scene) {
    return cloth_spring_family(place, scene.cloth_springs);
  });
  register_kind("stitch", [](const FamilyPlace& place, const Scene& scene) {
    return stitch_family(place, scene.stitches);
  });
  register_kind("inertia", inertia_family);
  register_kind("weight", weight_family);
  register_kind("soft_pin", pull_family);
  register_kind("air_drag", air_drag_family);
  register_kind("inflation", inflation_family);
  register_contact_motions();
}

}  // namespace bb::bench
