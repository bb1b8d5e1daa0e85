#include "core/newton/newton_state.hpp"

#include <algorithm>

#include "core/model/scene/pinned_vertices.hpp"

namespace bb {

std::vector<std::uint8_t> fixed_dofs(const Scene& scene, const Plan& plan) {
  std::vector<std::uint8_t> fixed(3 * static_cast<std::size_t>(scene.n_vertices()), 0);
  for (const Pin& pin : scene.pins) {
    for (std::size_t k = 0; k < 3; ++k) fixed[3 * static_cast<std::size_t>(pin.vertex) + k] = 1;
  }
  if (plan.planar_lock.needed) {
    for (std::size_t i = 2; i < fixed.size(); i += 3) fixed[i] = 1;
  }
  return fixed;
}

std::vector<double> body_sizes(const Scene& scene) {
  std::vector<double> out(static_cast<std::size_t>(scene.n_vertices()), 0);
  for (const Body& body : scene.bodies) {
    if (body.n_vertices == 0) continue;
    const auto rest = scene.rest.middleCols(body.first_vertex, body.n_vertices);
    const double side = (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).maxCoeff();
    std::fill_n(out.begin() + body.first_vertex, body.n_vertices, side);
  }
  return out;
}

ExactHessians exact_hessians(const Plan& plan, const Method& method) {
  bool some = false, all = true;
  for (std::size_t i = 0; i < plan.terms.size(); ++i) {
    const TermEntry& entry = term_entries()[i];
    if (!plan.terms[i].needed || entry.convex) continue;
    const bool exact = first_projection(method.hessian_of(entry.name)) == Projection::none;
    some = some || exact;
    all = all && exact && knows_exact_hessian(entry.name, method);
  }
  if (all) return ExactHessians::all;
  return some ? ExactHessians::some : ExactHessians::none;
}

PlanOptions plan_options(const Method& method) {
  PlanOptions options;
  options.step = method.step_needs;
  options.end_check = method.step_solver.saddle != SaddleRule::ignore;
  options.linear = method.linear;
  return options;
}

namespace {

std::vector<StepHessian> choices_of(const Plan& plan, const Method& method) {
  std::vector<StepHessian> out;
  for (std::size_t i = 0; i < plan.terms.size(); ++i) {
    if (plan.terms[i].needed) out.push_back(method.hessian_of(term_entries()[i].name));
  }
  return out;
}

}  // namespace

NewtonState::NewtonState(const Scene& of, Method& method, const Plan& with, PhaseClock& clock,
                         const MakePotential& make)
    : scene(of),
      plan(with),
      precision(method.precision),
      fixed(fixed_dofs(of, plan)),
      n_free(static_cast<int>(std::count(fixed.begin(), fixed.end(), 0))),
      potential(make(of, method, plan, fixed, clock)),
      executor(potential->executor()),
      vectors(executor, fixed, pinned_vertices(of)),
      level(choices_of(plan, method)),
      x(executor, "positions"),
      trial(executor, "trial positions"),
      end(executor, "end of the motion"),
      dx(executor, "Newton direction"),
      g(executor, "gradient"),
      force(executor, "force norms"),
      x_n(executor, "positions at the start of the step"),
      x_tilde(executor, "predicted positions"),
      b(executor, "right-hand side"),
      step(executor, "solution"),
      work(executor, "work column"),
      aside(executor, "direction of negative curvature"),
      body_size(executor, "sizes of bodies") {
  for (Column* column : {&x, &trial, &end, &dx, &g, &x_n, &x_tilde, &b, &step, &work, &aside}) {
    column->resize(3 * static_cast<exec::Index>(of.n_vertices()));
  }
  body_size.upload(body_sizes(of));
}

exec::Index NewtonState::first_short_pin() {
  if (!pins_seen) {
    vectors.look_at_pins(x);
    trial_pins_seen = false;  // there is one number of both
  }
  pins_seen = true;
  return vectors.first_short_pin();
}

void NewtonState::look_at_trial_pins() {
  vectors.look_at_pins(trial);
  pins_seen = false;
  trial_pins_seen = true;
}

}  // namespace bb
