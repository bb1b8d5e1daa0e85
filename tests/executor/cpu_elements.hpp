// The reference of terms on an executor: the terms of core/terms without contact, summed as Newton sums them.
#pragma once

#include <gtest/gtest.h>

#include "barriers/shapes/registry.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/exec/host_executor.hpp"
#include "core/model/bodies/scene_builder.hpp"
#include "core/model/mesh/generators.hpp"
#include "core/newton/energy_sum.hpp"
#include "core/newton/hessian_level.hpp"
#include "core/terms/plan.hpp"
#include "tests/barriers/limit_policies.hpp"
#include "tests/terms/asked.hpp"

namespace bb::test {

inline TermOptions element_options(const char* shape = "cubic") {
  TermOptions options;
  options.contact = {require_shape("cubic"), Argument::gap};
  PolicyConfig policy;
  policy.parameters["kappa_N_per_m"] = 40.0;
  options.stiffness = make_policy(policy);
  options.limit = {require_shape(shape), Argument::gap};
  options.limit_stiffness = test::fixed_limit(30);
  return options;
}

/// A cloth with every kind of element, a corner and an edge of it prescribed; in the plane without bending.
inline Scene cloth_scene(const char* model, bool planar, int n = 5) {
  SceneBuilder builder("cloth", planar, planar ? Vec3d(0, -10, 0) : Vec3d(0, 0, -10), "test");
  BodySpec body;
  body.name = "cloth";
  body.mesh = grid_mesh(n, n, 1.0, 1.3);
  if (!planar) {  // rest angles that are not 0
    for (Eigen::Index v = 0; v < body.mesh.vertices.cols(); ++v) {
      body.mesh.vertices(2, v) = 0.05 * std::sin(3.0 * static_cast<double>(v));
    }
  }
  body.material.model = model;
  if (is_anisotropic(model)) body.material.warp_axis = Vec3d(0.8, 0.6, 0);
  body.material.density = 0.3;
  body.material.youngs = 20;
  body.material.bending = planar ? 0 : 0.01;
  body.material.springs = 3;
  body.material.limit = StrainLimitSpec{0.001, 0.2};
  body.d_hat = 0.01;
  PinSpec pin;
  pin.indices = {0, 1, n * n - 1};
  body.pins.push_back(pin);
  builder.add_body(body);
  return builder.finish();
}

/// Away from rest, compressed one way and stretched the other, so that elements have negative eigenvalues and the
/// limit acts; in the plane where the scene is.
inline Positions strained(const Scene& scene, double size = 0.006) {
  Positions x = scene.x0;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x.data()[i] += size * std::sin(1.7 * static_cast<double>(i) + 0.4);
  x.row(0) *= 0.97;
  x.row(1) *= 1.05;
  if (scene.planar) x.row(2) = scene.x0.row(2);
  return x;
}

inline Positions wave(const Scene& scene, double size) {
  Positions dx(3, scene.n_vertices());
  for (Eigen::Index i = 0; i < dx.size(); ++i)
    dx.data()[i] = size * std::cos(2.9 * static_cast<double>(i) + 1);
  if (scene.planar) dx.row(2).setZero();
  return dx;
}

inline StepFrame step_frame(const Scene& scene) {
  StepFrame frame;
  frame.x_n = scene.x0;
  frame.x_tilde = scene.x0 + 0.01 * wave(scene, 1);
  frame.dt = 0.05;
  frame.c = 0.7;
  frame.load_factor = 0.9;
  return frame;
}

struct CpuElements {
  exec::HostExecutor executor;
  const Scene& scene;
  TermOptions& options;
  Plan plan;
  std::vector<std::uint8_t> fixed;
  BlockSystem blocks;
  TermList terms;
  BlockSystem::Values elastic;
  Positions gradient;
  PhaseClock clock;
  EnergySums sums;
  StepFrame first_step;

  CpuElements(const Scene& given, TermOptions& chosen, const StepFrame& frame)
      : scene(given),
        options(chosen),
        plan(plan_without_contact(given, chosen)),
        fixed(3 * given.mass.size(), 0),
        blocks(given.n_vertices(), fixed),
        terms(make_terms(plan, {executor, scene, options, plan.contacts, fixed})),
        first_step(frame) {
    std::vector<Stencils> families;
    for (const auto& term : terms) families.push_back(term->families()[0].stencils);
    blocks.set_elements(families);
    for (const auto& term : terms) term->set_matrix(blocks, elastic);
    for (const auto& term : terms) term->begin_step(first_step, clock);
  }
  static Plan plan_without_contact(const Scene& scene, const TermOptions& options) {
    Plan plan = make_plan(scene, options, {});
    for (std::size_t i = 0; i < plan.terms.size(); ++i) {
      for (const char* name : {"contact", "friction", "restitution"}) {
        if (term_entries()[i].name == name) plan.terms[i].needed = false;
      }
    }
    return plan;
  }
  TermContext context(Projection projection) { return {gradient, projection, clock}; }

  /// Gradient and local terms at x, every term beginning with the Hessian of `choice`.
  void linearise(const Positions& x, StepHessian choice) {
    for (const auto& term : terms) {
      if (term->group() != TermGroup::elastic) continue;
      term->linearise(x, context(first_projection(choice)));
      term->clamp(x);
    }
    sum(TermGroup::elastic, StepHessian::blend, all_clamped(), {});
    blocks.take_values(elastic);
    gradient.setZero(3, x.cols());
    std::size_t family = 0;
    for (const auto& term : terms) {
      if (term->group() != TermGroup::elastic) term->linearise(x, context(first_projection(choice)));
      term->clamp(x);
      blocks.gather_elements(family++, term->families()[0].local.grad, gradient);
    }
  }
  static HessianLevel all_clamped() {
    HessianLevel level({StepHessian::blend});
    while (!level.last()) level.raise(1);
    return level;
  }
  /// Into blocks.values(), after linearise() with that choice.
  void sum(TermSet set, StepHessian choice, const HessianLevel& level, std::span<const double> force) {
    std::vector<double> buffer;
    blocks.clear();
    for (const bool elastic_ones : {true, false}) {
      for (std::size_t i = 0; i < terms.size(); ++i) {
        const TermGroup group = terms[i].group();
        if ((group == TermGroup::elastic) != elastic_ones || !set.has(group)) continue;
        const TermFamily& family = terms[i].families()[0];
        if (family.local.hess.empty()) continue;
        blocks.add_elements(i, is_convex(terms[i].name()) ? family.local.hess
                                                          : hessian_at(family, choice, level, force, buffer));
      }
    }
  }
  static bool is_convex(std::string_view name) {
    for (const TermEntry& entry : term_entries()) {
      if (entry.name == name) return entry.convex;
    }
    return false;
  }
  /// 3x3 block of the values summed last.
  Mat3d block(int row, int column) const {
    const int vertices[2] = {row, column};
    Mat<double, 12, 12> out;
    blocks.submatrix(blocks.values(), vertices, 2, out.data());
    return row == column ? Mat3d(out.topLeftCorner<3, 3>()) : Mat3d(out.block<3, 3>(0, 3));
  }
};

}  // namespace bb::test
