// A scene that needs every registered term, and its terms at a state, without Newton.
#pragma once

#include <string>

#include "barriers/shapes/registry.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/exec/host_executor.hpp"
#include "core/model/bodies/scene_builder.hpp"
#include "core/model/mesh/generators.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "core/terms/plan.hpp"
#include "tests/barriers/limit_policies.hpp"
#include "tests/terms/asked.hpp"

namespace bb::test {

inline TermOptions term_options() {
  TermOptions options;
  options.contact = {require_shape("cubic"), Argument::gap};
  PolicyConfig policy;
  policy.parameters["kappa_N_per_m"] = 40.0;
  options.stiffness = make_policy(policy);
  options.limit = {require_shape("cubic"), Argument::gap};
  options.limit_stiffness = test::fixed_limit(30);
  options.friction.mu = 0.4;
  return options;
}

/// Two small cloths with bending, springs and a strain limit, the lower one close above a floor, the upper
/// one close above the lower, each with a rod of two segments on its side and a corner that is pulled; a solid block far from
/// both, inflated, and stitched to the upper one; wind.
inline Scene scene_with_everything() {
  constexpr double d_hat = 0.05;
  SceneBuilder builder("everything", false, Vec3d(0, 0, -10), "test");
  for (int layer = 0; layer < 2; ++layer) {
    BodySpec body;
    body.name = "cloth" + std::to_string(layer);
    body.mesh = grid_mesh(3, 3, 1.0, 1.0);
    body.mesh.segments = {{0, 3}, {3, 6}};
    body.mesh.vertices.row(2).array() += 0.02 + 0.03 * layer;
    body.mesh.vertices.row(0) *= 1 + 0.03 * layer;  // vertices not above vertices
    body.material.density = 0.3;
    body.material.youngs = 20;
    body.material.bending = 0.01;
    body.material.springs = 3;
    body.material.cloth_tension = 2;
    body.material.cloth_compression = 1;
    body.material.rod_bending = 0.004;
    body.material.limit = StrainLimitSpec{0.001, 0.2};
    body.d_hat = d_hat;
    body.restitution = 0.5;
    PinSpec& pull = body.pins.emplace_back();
    pull.indices = {2};
    pull.pull = 5;
    builder.add_body(body);
  }
  builder.set_air({0.3, 0.1, Vec3d(0.5, 0, 0.2), {}});
  BodySpec block;
  block.name = "block";
  block.mesh = solid_box_mesh({1, 1, 1}, Vec3d(0.5, 0.4, 0.3));
  block.mesh.vertices.colwise() += Vec3d(3, 0, 1);
  block.material.solid_youngs = 100;
  block.material.solid_density = 10;
  block.d_hat = d_hat;
  block.pressure = 7;
  builder.add_body(block);
  builder.add_stitch({"cloth1", "block", {8, 5}, {0, 2}, 0.4}, "/stitches/0");
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

/// A little away from rest, so that no term is at its minimum.
inline Positions disturbed(const Scene& scene, double size) {
  Positions x = scene.x0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    for (Eigen::Index k = 0; k < 3; ++k)
      x(k, i) += size * std::sin(1.7 * static_cast<double>(3 * i + k) + 0.4);
  }
  return x;
}

/// The terms of a scene at the start of a step.
struct TermsOf {
  exec::HostExecutor executor;
  Scene scene;
  TermOptions options;
  Plan plan;
  std::vector<std::uint8_t> fixed;
  BlockSystem blocks;
  BlockSystem::Values no_elastic;
  Positions no_gradient;
  PhaseClock clock;
  StepFrame first_step;
  TermList terms;

  TermsOf(Scene given, const Positions& x_n, const StepFrame& frame)
      : TermsOf(std::move(given), x_n, frame, [](TermOptions&) {}) {}
  /// change(options): before the plan is made.
  template <class Change>
  TermsOf(Scene given, const Positions& x_n, const StepFrame& frame, const Change& change)
      : scene(std::move(given)),
        options(changed(change)),
        plan(make_plan(scene, options, {})),
        fixed(3 * scene.mass.size(), 0),
        blocks(scene.n_vertices(), fixed),
        first_step(frame),
        terms(make_terms(plan, {executor, scene, options, plan.contacts, fixed})) {
    no_gradient.setZero(3, x_n.cols());
    for (const auto& term : terms) term->set_matrix(blocks, no_elastic);
    for (const auto& term : terms) term->begin_step(first_step, clock);
  }
  template <class Change>
  static TermOptions changed(const Change& change) {
    TermOptions out = term_options();
    change(out);
    return out;
  }
  TermContext context(Projection projection = Projection::psd) const {
    return {no_gradient, projection, const_cast<PhaseClock&>(clock)};
  }
};

inline double sum_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

inline double change_of(const EnergyParts& parts) {
  double sum = 0;
  for (const EnergyPart& part : parts) sum += part.change;
  return sum;
}

inline double magnitude_of(const EnergyParts& parts) {
  double sum = 0;
  for (const EnergyPart& part : parts) sum += part.magnitude;
  return sum;
}

inline double iterate_energy(const HostTerm& term) {
  double sum = 0;
  for (const TermFamily& family : term.families()) sum += sum_of(family.local.energy);
  return sum;
}

inline double trial_energy(const HostTerm& term) {
  double sum = 0;
  for (const TermFamily& family : term.families()) sum += sum_of(family.trial_energy);
  return sum;
}

}  // namespace bb::test
