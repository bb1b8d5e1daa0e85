// The terms of a scene with stencils that stay on an executor, with their vectors, as tests evaluate them.
#pragma once

#include <gtest/gtest.h>

#include "core/exec/host_executor.hpp"
#include "core/model/scene/pinned_vertices.hpp"
#include "core/terms/executor/element_terms.hpp"
#include "core/terms/executor/family_term.hpp"
#include "core/terms/executor/hessian_request.hpp"
#include "core/terms/plan.hpp"
#include "tests/executor/term_cases.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test {

inline std::span<const double> numbers_of(const Positions& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

struct OnExecutor {
  exec::Executor& executor;
  Plan plan;
  exec::VectorTools vectors;
  exec::Buffer<double> mass;
  exec::ElementMatrix elements;
  exec::ExecutorTerms terms;
  exec::Buffer<double> x_n, x_tilde, x, trial, dx, g;
  exec::ExecutorSum sum;
  PhaseClock clock;

  /// Without contact.
  OnExecutor(exec::Executor& on, const Scene& scene, const TermOptions& options, const StepFrame& frame,
             exec::Index piece = exec::ElementMatrix::default_piece)
      : OnExecutor(on, scene, options, piece) {
    begin_step(frame);
  }
  /// Before a step.
  OnExecutor(exec::Executor& on, const Scene& scene, const TermOptions& options,
             exec::Index piece = exec::ElementMatrix::default_piece)
      : executor(on),
        plan(make_plan(scene, options, {})),
        vectors(on, std::vector<std::uint8_t>(3 * scene.mass.size()), pinned_vertices(scene)),
        mass(on, "vertex masses"),
        elements(on, scene.n_vertices(), piece),
        x_n(on, "start"),
        x_tilde(on, "prediction"),
        x(on, "iterate"),
        trial(on, "trial"),
        dx(on, "direction"),
        g(on, "gradient", scene.rest.size()),
        sum(on) {
    mass.upload(scene.mass);
    make_terms({on, scene, options, plan.contacts, vectors, mass, elements});
    elements.finish();
  }
  void make_terms(const exec::ExecutorInputs& inputs) {
    const auto make = [&](const char* name, exec::MakeOnExecutor& of) {
      if (plan.term(name).needed) of(inputs, terms);
    };
    make("inertia", exec::make_inertia_on_executor);
    make("external_force", exec::make_external_force_on_executor);
    make("pull", exec::make_pull_on_executor);
    make("air_drag", exec::make_air_drag_on_executor);
    make("inflation", exec::make_inflation_on_executor);
#define BB_MAKE_kernels(name) make(#name, exec::make_part_on_executor<parts::name::part>);
#define BB_MAKE_host_only(name)
#define PART(name, doc, convex, where, ...) BB_MAKE_##where(name)
#include "core/model/scene/parts/registry.inc"
#undef PART
#undef BB_MAKE_kernels
#undef BB_MAKE_host_only
    make("stitch", exec::make_stitch_on_executor);
    make("strain_limit", exec::make_strain_limit_on_executor);
  }
  StepColumns step_of(const StepFrame& frame) const {
    return {x_n, x_tilde, frame.dt, frame.c, frame.load_factor, frame.t_end};
  }
  void begin_step(const StepFrame& frame) {
    x_n.upload(numbers_of(frame.x_n));
    x_tilde.upload(numbers_of(frame.x_tilde));
    for (const auto& term : terms) term->begin_step(step_of(frame), clock);
  }
  void change_step(const StepFrame& frame) {
    for (const auto& term : terms) term->change_step(step_of(frame));
  }
  void end_step(const Positions& at) {
    x.upload(numbers_of(at));
    for (const auto& term : terms) term->end_step(x, clock);
  }
  /// H, kappa of the limit, gradient and energies at x.
  void linearise(const Positions& at) {
    x.upload(numbers_of(at));
    fill(TermGroup::elastic, {});
    g.fill_zero();
    for (const auto& term : terms) term->linearise(x, {elements.part(), elements.n_blocks(), clock}, g);
  }
  void fill(TermSet set, const HessianRequest& request) {
    elements.clear();
    add(set, request);
  }
  /// Elastic terms first.
  void add(TermSet set, const HessianRequest& request) {
    for (const bool elastic : {true, false}) {
      for (const auto& term : terms) {
        if (set.has(term->group()) && (term->group() == TermGroup::elastic) == elastic)
          term->add_matrix(x, request);
      }
    }
    elements.mirror();
  }
  exec::Compensated energy(TermSet set) {
    sum.clear();
    exec::ExecutorEnergy energy(sum);
    for (const auto& term : terms) {
      if (set.has(term->group())) term->add_energy(x, energy);
    }
    energy.launch();
    return sum.get();
  }
  bool evaluate(const Positions& at) {
    trial.upload(numbers_of(at));
    for (const auto& term : terms) term->look_at(x, trial, clock);
    for (const auto& term : terms) {
      if (!term->is_feasible(trial, clock)) return false;
    }
    for (const auto& term : terms) term->evaluate(trial);
    return true;
  }
  exec::Compensated change() {
    sum.clear();
    exec::ExecutorChange change(sum);
    for (const auto& term : terms) term->add_change(x, trial, change);
    change.launch();
    return sum.get();
  }
  void accept() {
    for (const auto& term : terms) term->accept(clock), term->take_energies();
    x.swap(trial);
  }
  /// options.contact_options.min_gap_fraction is read.
  /// said: the report of the terms, where requested.
  double bound(const Positions& direction, IterateNumbers* said = nullptr) {
    dx.upload(numbers_of(direction));
    IterateNumbers nobody;
    IterateNumbers& report = said ? *said : nobody;
    double smallest = 1;
    for (const auto& term : terms) term->look_along({x, trial, dx}, clock);
    for (const auto& term : terms) smallest = std::min(smallest, term->bound({x, trial, dx}, report, clock));
    return smallest;
  }
  IterateNumbers report() {
    IterateNumbers out;
    for (const auto& term : terms) term->report(x, out, clock);
    return out;
  }
  /// The first element with an energy that is not finite, with the name of its term; empty without one.
  std::pair<std::string, exec::Index> first_not_finite() {
    exec::ExecutorLeast least(executor);
    for (const auto& term : terms) {
      const exec::Index element = term->first_not_finite(least);
      if (element >= 0) return {std::string(term->name()), element};
    }
    return {"", -1};
  }
  Positions gradient() const {
    Positions out(3, elements.n_vertices());
    g.download({out.data(), static_cast<std::size_t>(out.size())});
    return out;
  }
  Eigen::MatrixXd matrix() const {
    const exec::MatrixPart part = elements.part();
    const Eigen::Index n = elements.n_vertices();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (Eigen::Index v = 0; v < n; ++v) {
      for (exec::Index j = part.row_begin[v]; j < part.row_begin[v + 1]; ++j) {
        EXPECT_TRUE(j == part.row_begin[v] || part.column[j - 1] < part.column[j]);
        for (int c = 0; c < 9; ++c)
          out(3 * v + c % 3, 3 * part.column[j] + c / 3) = part.value[exec::value_index(j, c)];
      }
    }
    return out;
  }
};

inline double largest(const Positions& a) { return a.cwiseAbs().maxCoeff(); }

/// The five orders of a host executor.
inline std::vector<std::unique_ptr<TestedExecutor>> all_orders() {
  std::vector<std::unique_ptr<TestedExecutor>> out;
  for (const exec::Order order :
       {exec::Order::threads, exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
    out.push_back(std::make_unique<TestedExecutor>(order, 3));
  }
  out.push_back(std::make_unique<TestedExecutor>(exec::Order::shuffled, 17));
  return out;
}

}  // namespace bb::test
