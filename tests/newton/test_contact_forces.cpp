// Forces of contact and friction at the ends of steps: the momentum of every step under each integrator and step solver, action and
// reaction, differences of the energy of contact, and a weight that rests.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "barriers/matching.hpp"
#include "core/contact/contact_forces.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::contact_forces_test {
namespace {

constexpr double d_hat = 5e-3, dt = 0.01, g = 10, mu = 0.3;

/// A patch that is held at one side.
BodySpec patch(const std::string& name, double height, const Vec3d& at, const Vec3d& velocity) {
  BodySpec spec = test::cloth_spec(4, height, d_hat);
  spec.name = name;
  spec.mesh.vertices *= 0.3;
  spec.mesh.vertices.row(2).setConstant(height);
  spec.mesh.vertices.colwise() += at;
  spec.material.bending = 1e-3;
  spec.velocity = velocity;
  const double side = spec.mesh.vertices.row(0).maxCoeff();
  PinSpec pin;
  for (int v = 0; v < spec.mesh.vertices.cols(); ++v) {
    if (spec.mesh.vertices(0, v) > side - 1e-9) pin.indices.push_back(v);
  }
  spec.pins = {pin};
  return spec;
}

/// Two patches, one on the other, on a floor: free vertices meet the floor, each other, and what is held. gap: in d_hat, at the start.
Scene stack(double gap = 0.92, const Vec3d& shift = {0.02, 0.03, 0}) {
  SceneBuilder builder("stack", false, Vec3d(0, 0, -g), "test");
  builder.add_body(patch("lower", gap * d_hat, Vec3d::Zero(), Vec3d(0, 0.05, 0)));
  builder.add_body(patch("upper", 2.02 * gap * d_hat, shift, Vec3d(0, 0.3, -0.02)));
  Obstacle plane;
  plane.name = "floor";
  builder.add_obstacle(plane);
  return builder.finish();
}

bool is_of_obstacle(const ContactForce& row) {
  return std::any_of(row.key.begin(), row.key.end(), [](int id) { return obstacle_of(id) >= 0; });
}

std::vector<ContactForce> forces_of(NewtonSystem& system) {
  const Diagnosis& state = system.diagnosis();
  std::vector<ContactForce> out;
  for (const auto& term : state.terms()) term->add_forces(state.x(), state.x_n(), out);
  return out;
}

Positions on_vertices(const std::vector<ContactForce>& rows, Eigen::Index n) {
  Positions out = Positions::Zero(3, n);
  for (const ContactForce& row : rows) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (row.vertex[k] >= 0) out.col(row.vertex[k]) += row.force[k];
    }
  }
  return out;
}

/// Gradients of the elastic terms on every vertex, N, as they are linearised.
Positions elastic_gradient(const Diagnosis& state) {
  Positions out = Positions::Zero(3, state.x().cols());
  for (const auto& term : state.terms()) {
    if (term->group() != TermGroup::elastic) continue;
    for (const TermFamily& family : term->families()) {
      const auto by = static_cast<std::size_t>(family.stencils.width);
      for (std::size_t i = 0; i < family.stencils.vertices.size(); ++i) {
        const int v = family.stencils.vertices[i];
        const std::size_t at = i / by * 3 * by + i % by * 3;
        if (v >= 0) out.col(v) += Vec3d::Map(&family.local.grad[at]);
      }
    }
  }
  return out;
}

/// The forces of a step beside what its momentum changes by.
struct Balance {
  Vec3d missing = Vec3d::Zero();     // N, of forces on everything that is free and reactions of what is held
  Vec3d unsolved = Vec3d::Zero();    // N, gradient of E at the end over free vertices
  Vec3d momentum = Vec3d::Zero();    // N, mass times change of velocity over the length of the step
  Vec3d inertia = Vec3d::Zero();     // N, the same as the integrator has it
  double contact = 0, friction = 0;  // N, sums of lengths
  bool converged = false;
};

class Watch final : public StepObserver {
 public:
  void on_step(StepSystem& system, const StepReport& report, const Positions&) override {
    rows = forces_of(system.on_host());
    last = report;
  }
  std::vector<ContactForce> rows;
  StepReport last;
};

Balance balance_of(const Scene& scene, Method& method, Simulation& simulation, int step, int n_steps) {
  const History before = simulation.history();
  Watch watch;
  simulation.step(watch);
  Balance out;
  out.converged = watch.last.status == StepStatus::converged;
  const double length = watch.last.dt_s;
  Prediction predicted;
  method.integrator->predict(before, length, predicted);
  predicted.t_end = before.t + length;
  const double load =
      method.integrator->weight_factor() * (method.integrator->quasi_static() ? (step + 1.0) / n_steps : 1);
  const Positions &x = simulation.history().x, &v = simulation.history().v;
  NewtonSystem copy(scene, method);
  copy.adopt({before.x, predicted.x_tilde, length, predicted.c, load, predicted.t_end},
             simulation.step_system());
  const Positions forces = on_vertices(watch.rows, x.cols()), elastic = elastic_gradient(copy.diagnosis());
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const double mass = scene.mass[static_cast<std::size_t>(i)];
    const bool held = copy.view().fixed()[static_cast<std::size_t>(3 * i)] != 0;
    const Vec3d weight = load * mass * scene.gravity;
    const Vec3d inertia =
        predicted.c > 0
            ? Vec3d(mass / (predicted.c * length * length) * (x.col(i) - predicted.x_tilde.col(i)))
            : Vec3d::Zero();
    // What holds a vertex balances all else there; what is free has nothing else.
    const Vec3d reaction = held ? Vec3d(inertia - weight - forces.col(i) + elastic.col(i)) : Vec3d::Zero();
    out.missing += weight + forces.col(i) + reaction - inertia;
    if (!held) out.unsolved += copy.view().gradient().col(i);
    out.inertia += inertia;
    out.momentum += mass / length * (v.col(i) - before.v.col(i));
  }
  for (const ContactForce& row : watch.rows) {
    (row.term == "friction" ? out.friction : out.contact) += row.normal + row.tangential;
  }
  return out;
}

double weight_of(const Scene& scene) {
  double out = 0;
  for (const double mass : scene.mass) out += mass * g;
  return out;
}

Method method_of(const std::string& solver, const std::string& integrator) {
  const StepSolverEntry& entry = step_solvers().require(solver, "test");
  const bool overlaps =
      entry.needs.overlap && !entry.needs.multipliers;  // soft there, so that nothing bounces off
  Method method = test::fixed_method(overlaps ? "quadratic" : "cubic", overlaps ? 30 : 300, integrator);
  choose_step_solver(method, solver);
  method.friction.mu = mu;
  method.step_solver.max_iterations = 400;
  method.step_solver.tol_velocity = 1e-11;
  method.step_solver.saddle = SaddleRule::ignore;
  if (solver == "augmented_lagrangian") method.step_solver.parameters["al_tolerance_m"] = 1e-9;
  if (solver == "pncg") method.step_solver.parameters["pncg_epsilon"] = 1e-6;
  if (solver == "al_barrier") method.step_solver.parameters["al_barrier_near"] = 0.3;
  if (solver == "al_barrier") method.step_solver.parameters["al_barrier_release"] = 0.4;
  fit_terms(method);
  return method;
}

bool velocity_is_that_of_the_step(const Integrator& integrator) {
  return integrator.velocity_of_step() && !integrator.quasi_static();
}

TEST(ContactForces, BalanceTheMomentumOfEveryStepSolverAndIntegrator) {
  const Scene on_barriers = stack(), on_inequalities = stack(0.01);
  const double rounding = 1e-9 * weight_of(on_barriers);
  constexpr int n_steps = 4;
  int judged = 0, solved = 0;
  std::set<std::string> stalled;
  for (const StepSolverEntry& solver : step_solvers()) {
    if (!solver.has_forces) continue;
    for (const IntegratorEntry& integrator : integrators()) {
      const std::string where = solver.name + ", " + integrator.name;
      Method method = method_of(solver.name, integrator.name);
      if (solver.settings.implicit_euler && integrator.name != "implicit_euler") continue;
      if (solver.settings.velocity_of_step && !method.integrator->velocity_of_step()) continue;
      const Scene& scene = method.multipliers ? on_inequalities : on_barriers;
      Simulation simulation(scene, method, dt, n_steps);
      double contact = 0, friction = 0;  // N, most of a step
      for (int step = 0; step < n_steps; ++step) {
        const Balance of = balance_of(scene, method, simulation, step, n_steps);
        if (!of.converged) {  // a step that failed ends a run
          stalled.emplace(where);
          break;
        }
        if (step == 0 && method.integrator->needs_acceleration())
          continue;  // that of the start is not known before
        contact = std::max(contact, of.contact), friction = std::max(friction, of.friction);
        if (velocity_is_that_of_the_step(*method.integrator)) {
          EXPECT_LT((of.momentum - of.inertia).norm(), rounding) << where;
        }
        // Multipliers of a step are not adopted by a copy: its gradient is of another E.
        if (!method.multipliers) {
          EXPECT_LT((of.missing + of.unsolved).norm(), rounding) << where << ", step " << step;
        }
        if (solver.asked_to_converge) {
          EXPECT_LT(of.missing.norm(), rounding) << where << ", step " << step;
          ++solved;
        }
        ++judged;
      }
      if (stalled.contains(where)) continue;
      EXPECT_GT(contact, 0.1 * weight_of(scene)) << where;
      EXPECT_GT(friction, 1e-4 * weight_of(scene)) << where;
      if (HasFailure()) return;
    }
  }
  EXPECT_LE(stalled.size(), 1U) << *stalled.begin();
  EXPECT_GE(judged, 80);
  EXPECT_GE(solved, 60);
}

void expect_cancelling(const Scene& scene) {
  Method method = method_of("line_search", "implicit_euler");
  Simulation simulation(scene, method, dt, 6);
  std::map<std::string, int> judged;
  int held = 0;
  double largest = 0;
  for (int step = 0; step < 6; ++step) {
    Watch watch;
    simulation.step(watch);
    for (const ContactForce& row : watch.rows) {
      Vec3d sum = Vec3d::Zero();
      double most = 0;
      for (std::size_t k = 0; k < 4; ++k) sum += row.force[k], most = std::max(most, row.force[k].norm());
      if (is_of_obstacle(row) || most == 0) continue;
      EXPECT_LT(sum.norm(), 1e-14 * most + 1e-18) << row.term;
      ++judged[std::string(row.term)];
      largest = std::max(largest, most);
      for (const int v : row.vertex)
        held += v >= 0 && simulation.step_system().view().fixed()[static_cast<std::size_t>(3 * v)] != 0;
    }
  }
  EXPECT_GT(judged["contact"], 50);
  EXPECT_GT(judged["friction"], 50);
  EXPECT_GT(held, 0) << "forces on what is held are forces too";
  EXPECT_GT(largest, 1e-3);
}

TEST(ContactForces, OfTwoSurfacesCancel) {
  expect_cancelling(stack());
  expect_cancelling(stack(0.92, {0.001, 0.002, 0}));
}

void expect_differences(const Scene& scene, bool mollified) {
  Method method = method_of("line_search", "implicit_euler");
  method.friction.mu = 0;
  Simulation simulation(scene, method, dt, 3);
  StepReport report;
  for (int step = 0; step < 3; ++step) {
    Watch watch;
    simulation.step(watch);
    report = watch.last;
  }
  NewtonSystem& system = simulation.step_system();
  const Positions x = simulation.history().x, forces = on_vertices(forces_of(system), x.cols());
  ASSERT_GT(report.contacts.total(), 10U);
  ASSERT_EQ(report.contacts.mollified > 0, mollified);
  const auto energy_at = [&](const Positions& at) {
    system.go_to(at);
    return system.view().energy(TermGroup::contact);
  };
  constexpr double h = 1e-7;
  const double largest = forces.cwiseAbs().maxCoeff();
  ASSERT_GT(largest, 1e-3);
  int nonzero = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    for (int c = 0; c < 3; ++c) {
      Positions up = x, down = x;
      up(c, i) += h, down(c, i) -= h;
      const double high = energy_at(up), low = energy_at(down);
      EXPECT_NEAR(forces(c, i), -(high - low) / (2 * h), 1e-5 * largest) << "vertex " << i << ", axis " << c;
      nonzero += std::abs(forces(c, i)) > 1e-3 * largest;
    }
  }
  EXPECT_GT(nonzero, 20);
}

TEST(ContactForces, AreDifferencesOfTheEnergyOfContact) {
  expect_differences(stack(), false);
  expect_differences(stack(0.92, {0.001, 0.002, 0}), true);  // edges above edges along them
}

TEST(ContactForces, OfAVertexAtRestCarryItsWeight) {
  constexpr double mass = 0.2;
  for (const char* shape : {"log", "cubic"}) {
    Method method = test::fixed_method(shape, 400);
    method.step_solver.tol_velocity = 1e-15;
    const Scene scene = test::particle_over_plane(mass, 0.5 * d_hat, d_hat);
    Simulation simulation(scene, method, 1e3, 1);  // s, in which inertia is nothing
    Watch watch;
    simulation.step(watch);
    ASSERT_EQ(watch.last.status, StepStatus::converged);
    ASSERT_EQ(watch.rows.size(), 1U);
    const ContactForce& row = watch.rows[0];
    EXPECT_EQ(row.key, obstacle_key(0, std::array{0}));
    EXPECT_NEAR(row.force[0][2], mass * g, 1e-9 * mass * g) << shape;
    EXPECT_EQ(row.force[0].head<2>().norm(), 0);
    EXPECT_NEAR(row.normal, mass * g, 1e-9 * mass * g);
    EXPECT_NEAR(row.work, mass * g * (simulation.history().x(2, 0) - 0.5 * d_hat), 1e-9);
    EXPECT_GT(std::abs(row.work), 1e-6);
    EXPECT_FALSE(row.area);
  }
}

TEST(ContactForces, WorkOfFrictionIsWhatTheStepSaysIsDissipated) {
  const Scene scene = stack();
  Method method = method_of("line_search", "implicit_euler");
  Simulation simulation(scene, method, dt, 5);
  double total = 0;
  for (int step = 0; step < 5; ++step) {
    Watch watch;
    simulation.step(watch);
    double work = 0;
    for (const ContactForce& row : watch.rows) work += row.term == "friction" ? row.work : 0;
    EXPECT_NEAR(-work, watch.last.friction_dissipation_J.value, 1e-12 * std::abs(work) + 1e-20);
    total -= work;
  }
  EXPECT_GT(total, 1e-6);
}

}  // namespace
}  // namespace bb::contact_forces_test
