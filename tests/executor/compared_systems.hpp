// Two systems of one scene and method, on the host and on the tested executor, that take the same ways: what they say at each state
// is compared, and what was there to be compared is counted.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "tests/executor/both_systems.hpp"

namespace bb::test {

inline constexpr double eps = std::numeric_limits<double>::epsilon();

/// What was compared.
struct Counts {
  std::size_t contacts = 0, loads = 0, mollified = 0, friction = 0, renewed = 0, secants = 0;
  std::size_t shared = 0;         // rows whose closest feature a row before it has
  std::size_t started = 0;        // states after the start of a policy that starts itself
  std::size_t kappa_changes = 0;  // iterates with another kappa than the one before
};

class Compared : public Both {
 public:
  /// rounding: relative, of what a row has.
  Compared(const Scene& of, const std::function<Method()>& method, double rounding)
      : Both(of, method), rounding_(rounding) {}

  /// Of the assembled iterate.
  void expect_same_state(Counts& counts) {
    expect_same_state(there, counts);
    IterateNumbers expected, found;
    cpu.view().report(expected), there.view().report(found);
    expect_same(found.kappa_change_rel, expected.kappa_change_rel);
    counts.kappa_changes += expected.kappa_change_rel.value > 0;
    const double start = of_cpu.stiffness->state().kappa_start;
    expect_same(of_executor.stiffness->state().kappa_start, start);
    counts.started += of_cpu.stiffness->adapts() && start > 0;
  }
  /// What the executor's system shows to the host, whose copy knows what is frozen for the step.
  void expect_shown(Counts& counts) { expect_same_state(there.on_host(), counts); }
  void expect_same_state(NewtonSystem& other, Counts& counts) {
    EXPECT_EQ(other.view().x(), cpu.view().x());
    for (const TermGroup group :
         {TermGroup::load, TermGroup::elastic, TermGroup::limit, TermGroup::contact, TermGroup::friction}) {
      const double expected = cpu.view().energy(group);
      EXPECT_NEAR(other.view().energy(group), expected, (2 * eps + rounding_) * std::abs(expected));
      counts.friction += group == TermGroup::friction && expected > 0;
    }
    expect_same_gradient(other, counts);
    IterateNumbers expected, found;
    cpu.view().report(expected), other.view().report(found);
    expect_same_contacts(found, expected);
    expect_same(found.gap_min_iterates_m, expected.gap_min_iterates_m);
    expect_same(found.gap_min_iterates_rel, expected.gap_min_iterates_rel);
    expect_same(found.contact_curvature_max_N_per_m, expected.contact_curvature_max_N_per_m);
    expect_same(found.limit_load_max_N_per_m, expected.limit_load_max_N_per_m);
    StepNumbers end_expected, end_found;
    cpu.view().report_end(end_expected), other.view().report_end(end_found);
    expect_same_end(end_found, end_expected, counts);
  }
  /// To within rounding of its largest number, at all levels of what a step's Hessian may be.
  void expect_same_matrix() {
    for (HessianRegularisation level({StepHessian::blend, StepHessian::progressive});; level.raise(2)) {
      const Eigen::MatrixXd expected = matrix(cpu, level), found = matrix(there, level);
      const double size = expected.cwiseAbs().maxCoeff();
      ASSERT_GT(size, 1e-3);
      EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), (16 * eps + rounding_) * size) << level.t();
      if (level.last()) break;
    }
  }
  /// To the tolerance of the solver, of the matrix that was compared last.
  void expect_same_solution() {
    Positions target = cpu.view().x();
    target.row(0).array() += 5e-4;  // of prescribed vertices
    DirectionSize size[2];
    for (const std::size_t k : {0, 1}) {
      NewtonSystem& system = k == 0 ? cpu : there;
      system.set_target(target);
      EXPECT_EQ(system.find_direction().linear.status, LinearStatus::ok);
      size[k] = system.direction_size();
    }
    EXPECT_GT(size[0].inf_m, 1e-6);
    EXPECT_NEAR(size[1].inf_m, size[0].inf_m, 1e-8 * size[0].inf_m);
    EXPECT_NEAR(size[1].vertex_m, size[0].vertex_m, 1e-8 * size[0].vertex_m);
    EXPECT_NEAR(size[1].slope_J, size[0].slope_J, 1e-8 * std::abs(size[0].slope_J));
  }
  /// What is reported of a given direction, as long as motions are and as long as rounding is.
  void expect_same_direction(const Positions& dx) {
    for (const double scale : {1.0, 1e-14}) {
      DirectionSize size[2];
      double curvature[2];
      for (const std::size_t k : {0, 1}) {
        NewtonSystem& system = k == 0 ? cpu : there;
        system.set_direction(dx);
        system.scale_direction(scale);
        size[k] = system.direction_size();
        curvature[k] = system.direction_curvature();
      }
      EXPECT_GT(size[0].vertex_m, 0);
      EXPECT_GT(scale == 1 ? size[0].beyond_m : size[0].rounding_m, 0);
      EXPECT_EQ(std::max(size[0].beyond_m, size[0].rounding_m), size[0].inf_m);
      for (const auto part : {&DirectionSize::inf_m, &DirectionSize::beyond_m, &DirectionSize::rounding_m,
                              &DirectionSize::vertex_m})
        EXPECT_EQ(size[1].*part, size[0].*part);
      EXPECT_NEAR(size[1].slope_J, size[0].slope_J, (64 * eps + rounding_) * std::abs(size[0].slope_J));
      EXPECT_NE(curvature[0], 0);
      EXPECT_NEAR(curvature[1], curvature[0], (64 * eps + rounding_) * std::abs(curvature[0]));
    }
  }
  /// A motion that contact ends, and a state on the way, which becomes the iterate.
  double move(const Positions& dx) {
    double alpha[2] = {0, 0};
    std::optional<EnergyChange> change[2];
    for (const std::size_t k : {0, 1}) {
      NewtonSystem& system = k == 0 ? cpu : there;
      system.set_direction(dx);
      system.prepare_motion(MotionEnd::free, true);
      IterationReport report;
      alpha[k] = system.bound_motion(report);
      change[k] = system.try_motion(0.9 * alpha[k]);
      system.accept();
      system.assemble();
    }
    EXPECT_EQ(alpha[1], alpha[0]);
    EXPECT_EQ(there.view().describe_bound(), cpu.view().describe_bound());
    EXPECT_TRUE(change[0] && change[1]);
    if (change[0] && change[1]) {
      EXPECT_NE(change[0]->change, 0);
      EXPECT_NEAR(change[1]->change, change[0]->change, (4 * eps + rounding_) * change[0]->magnitude);
      EXPECT_NEAR(change[1]->magnitude, change[0]->magnitude, 1e-13 * change[0]->magnitude);
    }
    return alpha[0];
  }
  /// c: 0 without inertia.
  void next_step(double c, double load_factor) {
    const Positions x = cpu.view().x();
    for (StepSystem* system : systems()) {
      system->end_step();
      system->begin_step(x, falling(x, 1e-3, c), 0.008, load_factor);
      system->assemble();
    }
  }
  /// The step goes on with friction of the loads at its iterate.
  void renew_lagged_state(Counts& counts) {
    const bool renewed = cpu.renew_lagged_state();
    EXPECT_EQ(there.renew_lagged_state(), renewed);
    counts.renewed += renewed;
    for (StepSystem* system : systems()) system->assemble();
  }
  /// Friction has a share of its secant from here on, where there is friction.
  void take_secant(Counts& counts) {
    const HessianRegularisation first({StepHessian::blend});
    const Eigen::MatrixXd exact = matrix(cpu, first);
    const bool taken = cpu.take_secant(0.25);
    EXPECT_EQ(there.take_secant(0.25), taken);
    for (StepSystem* system : systems()) system->assemble();
    counts.secants += taken && matrix(cpu, first) != exact;
  }
  /// The step goes on with another length.
  void restart() {
    const Positions x = cpu.view().x();
    for (StepSystem* system : systems()) {
      system->restart_step(falling(x, 4e-4, 4.0 / 9), 0.003);
      system->assemble();
    }
  }

 private:
  Prediction falling(const Positions& x, double by, double c) const {
    Prediction out{c, x};
    out.x_tilde.row(scene.planar ? 1 : 2).array() -= by;
    return out;
  }
  /// more: relative, beside the rounding of the method.
  void expect_same(const Number& found, const Number& expected, double more = 0) const {
    EXPECT_EQ(found.finite(), expected.finite());
    if (expected.finite()) expect_same(found.value, expected.value, more);
  }
  void expect_same(double found, double expected, double more = 0) const {
    EXPECT_LE(std::abs(found - expected), (rounding_ + more) * std::abs(expected))
        << found << " " << expected;
  }
  /// What an iterate and the end of a step both report of contacts.
  template <class Numbers>
  void expect_same_contacts(const Numbers& found, const Numbers& expected) const {
    for (const auto kind :
         {&ContactCounts::point_point, &ContactCounts::point_edge, &ContactCounts::point_triangle,
          &ContactCounts::edge_edge, &ContactCounts::obstacle, &ContactCounts::mollified})
      EXPECT_EQ(found.contacts.*kind, expected.contacts.*kind);
    expect_same(found.kappa_min_N_per_m, expected.kappa_min_N_per_m);
    expect_same(found.kappa_max_N_per_m, expected.kappa_max_N_per_m);
    expect_same(found.contact_load_max_N, expected.contact_load_max_N);
  }
  void expect_same_end(const StepNumbers& found, const StepNumbers& expected, Counts& counts) const {
    expect_same_contacts(found, expected);
    expect_same(found.gap_min_m, expected.gap_min_m);
    expect_same(found.gap_min_rel, expected.gap_min_rel);
    expect_same(found.gap_min_ulps, expected.gap_min_ulps);
    expect_same(found.contact_load_sum_N, expected.contact_load_sum_N, 4 * eps);
    EXPECT_EQ(found.friction_sliding, expected.friction_sliding);
    EXPECT_EQ(found.friction_sticking, expected.friction_sticking);
    ASSERT_EQ(found.contact_loads.size(), expected.contact_loads.size());
    std::map<ContactKey, std::size_t> rows;
    for (std::size_t i = 0; i < expected.contact_loads.size(); ++i) {  // in one order: that of the pairs
      const ContactLoad &a = expected.contact_loads[i], &b = found.contact_loads[i];
      EXPECT_EQ(b.key, a.key);
      EXPECT_EQ(b.gap_rel, a.gap_rel);
      expect_same(b.load_N, a.load_N);
      counts.shared += rows[a.key]++ > 0;
    }
    counts.contacts += expected.contacts.total();
    counts.loads += expected.contact_loads.size();
  }
  /// At prescribed vertices an executor's rows have no force.
  void expect_same_gradient(NewtonSystem& other, Counts& counts) {
    const Positions expected = cpu.view().gradient(), found = other.view().gradient();
    const ContactState& rows = contact_state(cpu.diagnosis().terms());
    std::vector<char> mollified(scene.mass.size(), 0);
    for (const int v : rows.mollified.free_vertex) {
      if (v >= 0) mollified[static_cast<std::size_t>(v)] = 1;
    }
    const double size = expected.cwiseAbs().maxCoeff();
    ASSERT_GT(size, 1e-6);
    for (int v = 0; v < scene.n_vertices(); ++v) {
      if (scene.mass[static_cast<std::size_t>(v)] == 0) continue;
      const bool other_order = mollified[static_cast<std::size_t>(v)] != 0;
      counts.mollified += other_order;
      EXPECT_LE((found.col(v) - expected.col(v)).cwiseAbs().maxCoeff(),
                ((other_order ? 8 * eps : 0) + 2 * rounding_) * size)
          << "vertex " << v;
    }
  }
  double rounding_;

  /// Rows and columns of free degrees of freedom.
  Eigen::MatrixXd matrix(NewtonSystem& system, const HessianRegularisation& level) const {
    IncrementalPotential& potential = system.potential();
    const std::vector<std::uint8_t>& fixed = system.view().fixed();
    const auto n = static_cast<Eigen::Index>(fixed.size());
    const Positions at = system.view().x();
    Column x(potential.executor(), "x"), force(potential.executor(), "force", n / 3),
        unit(potential.executor(), "unit", n), product(potential.executor(), "product", n);
    x.upload({at.data(), static_cast<std::size_t>(n)});
    std::vector<double> sizes(static_cast<std::size_t>(scene.n_vertices()));  // N
    for (std::size_t v = 0; v < sizes.size(); ++v) sizes[v] = 1 + std::sin(5.0 * static_cast<double>(v));
    force.upload(sizes);
    potential.fill_matrix(x, level, force);
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      if (fixed[static_cast<std::size_t>(j)]) continue;
      unit.fill_zero();
      unit.set(j, 1);
      potential.multiply(unit, product);
      for (Eigen::Index i = 0; i < n; ++i) {
        if (!fixed[static_cast<std::size_t>(i)]) out(i, j) = product.get(i);
      }
    }
    return out;
  }
};

}  // namespace bb::test
