// Pairs that collide as `audited`: no motion is bounded, the straight motion of a step is proven free of
// contact when it is over, and a step for which it is not is done again as with `ccd`.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "core/audit/audit.hpp"
#include "core/audit/surface_edges.hpp"
#include "core/base/archive/archive.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::audited_test {
namespace {

constexpr double dt = 0.01, d_hat = 0.01, fast = -20, slow = -1.5;

/// A small cloth above a closed ball that stands still, or above a large cloth with pinned corners; nothing
/// has a weight.
Scene thrown(CollisionChoice choice, double speed, bool at_ball = false, double height = 0.05) {
  SceneBuilder builder("thrown", false, Vec3d::Zero(), "test");
  BodySpec small = test::cloth_spec(3, height, d_hat);
  small.name = "small";
  small.mesh = grid_mesh(3, 3, 0.2, 0.2);
  small.mesh.vertices.colwise() += Vec3d(0.013, 0.029, height);
  small.velocity = Vec3d(0, 0, speed);
  builder.add_body(small);
  BodySpec other = test::cloth_spec(4, 0, d_hat);
  other.name = "other";
  if (at_ball) {
    other.kind = BodyKind::rigid;
    other.mesh = icosphere_mesh(1, 0.3);
    other.mesh.vertices.row(2).array() -= 0.3;
  } else {
    PinSpec corners;
    corners.indices = {0, 3, 12, 15};
    other.pins.push_back(corners);
  }
  builder.add_body(other);
  builder.add_collision({"small", "other", choice}, "/collisions/0");
  return builder.finish();
}

Method method_of(const std::string& solver = "line_search") {
  Method method = test::fixed_method("log", 200);
  choose_step_solver(method, solver);
  method.step_solver.tol_velocity = 1e-4;
  fit_terms(method);
  return method;
}

/// The motions of the attempts that count, and how often a step began again.
class Watch final : public StepObserver {
 public:
  void on_motion(const Positions& x0, const Positions& x1, int) override { motions.push_back({x0, x1}); }
  void on_retry(int) override { ++retries, motions.resize(at_step_end); }
  void on_redo(int) override { ++redone, motions.resize(at_step_end); }
  void on_step(StepSystem&, const StepReport&, const Positions&) override { at_step_end = motions.size(); }
  std::vector<std::pair<Positions, Positions>> motions;
  std::size_t at_step_end = 0;
  int retries = 0, redone = 0;
};

struct Course {
  std::vector<StepReport> steps;
  std::vector<Positions> x;  // the start first
  Watch watch;
  int redone() const {
    return sum([](const StepReport& step) { return step.redone_audited; });
  }
  int retries() const {
    return sum([](const StepReport& step) { return step.retries; });
  }
  long long queries() const {
    long long out = 0;
    for (const StepReport& step : steps) out += step.ccd_queries;
    return out;
  }
  std::size_t contacts() const {
    std::size_t out = 0;
    for (const StepReport& step : steps) out += step.contacts.total();
    return out;
  }
  template <class F>
  int sum(const F& of) const {
    int out = 0;
    for (const StepReport& step : steps) out += of(step);
    return out;
  }
};

Course course(const Scene& scene, Method method, int nominal_steps, StepStatus all = StepStatus::converged) {
  Simulation simulation(scene, method, dt, nominal_steps);
  Course out;
  out.x.push_back(simulation.history().x);
  while (simulation.nominal_steps() < nominal_steps) {
    out.steps.push_back(simulation.step(out.watch));
    out.x.push_back(simulation.history().x);
    EXPECT_EQ(out.steps.back().status, all) << out.steps.back().detail;
  }
  return out;
}

/// Whether the surfaces have passed through each other in a straight motion or intersect at its end, as the
/// audit reports.
bool passes(const Scene& scene, const Positions& x0, const Positions& x1) {
  audit::AuditMesh mesh;
  audit::set_edges(scene.surface_triangles, scene.surface_edges, mesh);
  mesh.triangles = audit::as_columns(scene.surface_triangles);
  audit::Audit judge(mesh);
  judge.check_state(x0, 0);
  judge.check_motion(x0, x1, 0, 1e-9);
  judge.check_state(x1, 0);
  EXPECT_GT(judge.ledger().judged(), 0);
  return !judge.ledger().clean();
}

/// Of a step that was done again every motion counts, of others their straight motion.
bool passes(const Scene& scene, const Course& of) {
  bool out = false;
  if (of.redone() > 0) {
    for (const auto& [x0, x1] : of.watch.motions) out = out || passes(scene, x0, x1);
    return out;
  }
  for (std::size_t k = 1; k < of.x.size(); ++k) out = out || passes(scene, of.x[k - 1], of.x[k]);
  return out;
}

double height_of_small(const Positions& x) { return x.leftCols(9).row(2).mean(); }

TEST(Audited, AStepThatPassesThroughIsDoneAgainAndEndsAsWithCcd) {
  for (const bool ball : {false, true}) {
    const Course through = course(thrown(CollisionChoice::proximity, fast, ball), method_of(), 1);
    EXPECT_LT(height_of_small(through.x[1]), -0.05) << "nothing passes through";
    EXPECT_TRUE(passes(thrown(CollisionChoice::proximity, fast, ball), through));
    const Scene scene = thrown(CollisionChoice::audited, fast, ball);
    const Course audited = course(scene, method_of(), 1);
    const Course ccd = course(thrown(CollisionChoice::ccd, fast, ball), method_of(), 1);
    EXPECT_EQ(audited.redone(), 1) << ball;
    EXPECT_EQ(audited.watch.redone, 1);
    EXPECT_EQ(audited.retries(), 0) << "the length stays";
    EXPECT_EQ(audited.steps[0].dt_s, dt);
    EXPECT_GT(audited.contacts(), 0U) << ball;
    EXPECT_EQ(audited.x[1], ccd.x[1]) << ball;
    EXPECT_FALSE(passes(scene, audited)) << ball;
    EXPECT_EQ(audited.steps[0].newton_iterations,
              through.steps[0].newton_iterations + ccd.steps[0].newton_iterations);
    EXPECT_EQ(audited.steps[0].iterations_before, through.steps[0].newton_iterations);
    EXPECT_GT(audited.steps[0].audited_queries, 0);
  }
}

TEST(Audited, ASlowSceneIsProvenAtOnceWithFewerQueries) {
  const Scene scene = thrown(CollisionChoice::audited, slow, false, 0.012);
  const Course audited = course(scene, method_of(), 8);
  const Course ccd = course(thrown(CollisionChoice::ccd, slow, false, 0.012), method_of(), 8);
  EXPECT_EQ(audited.redone(), 0);
  EXPECT_GT(audited.contacts(), 0U);
  EXPECT_LT(audited.queries(), ccd.queries());
  EXPECT_FALSE(passes(scene, audited));
  EXPECT_LT((audited.x.back() - ccd.x.back()).cwiseAbs().maxCoeff(), 8 * dt * 1e-4);
}

TEST(Audited, EveryStepSolverHasItRightOrRefusesIt) {
  const Scene scene = thrown(CollisionChoice::audited, fast, true);
  int right = 0, refused = 0;
  for (const StepSolverEntry& entry : step_solvers()) {
    Method method = method_of(entry.name);
    method.step_solver.saddle = SaddleRule::ignore;
    try {
      const Course of = course(scene, std::move(method), 2);
      EXPECT_GT(of.redone(), 0) << entry.name;
      EXPECT_FALSE(passes(scene, of)) << entry.name;
      EXPECT_GT(height_of_small(of.x.back()), -0.05) << entry.name;
      ++right;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(entry.name), std::string::npos) << error.what();
      ++refused;
    }
  }
  EXPECT_EQ(right, 4) << "line_search, accumulated_toi, al_barrier, pncg";
  EXPECT_EQ(refused, 6);
  Method unbounded = method_of("pncg");
  unbounded.step_solver.parameters["pncg_bound"] = "half_d_hat";
  EXPECT_THROW(Simulation(scene, unbounded, dt, 1), ConfigError);
}

TEST(Audited, PartsOfAStepThatWasDoneAgainAreBounded) {
  const Scene scene = thrown(CollisionChoice::audited, fast);
  const Course whole = course(scene, method_of(), 1);
  Method capped = method_of();
  capped.step_solver.max_iterations = whole.steps[0].newton_iterations - whole.steps[0].iterations_before - 1;
  ASSERT_GE(capped.step_solver.max_iterations, whole.steps[0].iterations_before);
  capped.step_solver.retries = 8;
  const Course of = course(scene, std::move(capped), 1);
  EXPECT_GT(of.redone(), 0);
  EXPECT_GT(of.retries(), 0);
  EXPECT_EQ(of.steps[0].dt_s, dt / (1 << of.steps[0].retries));
  EXPECT_EQ(of.watch.retries, of.retries());
  EXPECT_EQ(of.watch.redone, of.redone());
  EXPECT_GT(of.contacts(), 0U);
  EXPECT_FALSE(passes(scene, of));
}

TEST(Audited, AStepThatEndsTheRunIsProvenToo) {
  const auto cut_off = [](const Scene& scene) {
    Method method = method_of();
    method.step_solver.max_iterations = 1;
    return course(scene, std::move(method), 1, StepStatus::iteration_cap);
  };
  const Scene scene = thrown(CollisionChoice::audited, fast), open = thrown(CollisionChoice::proximity, fast);
  const Course of = cut_off(scene);
  EXPECT_EQ(of.redone(), 1);
  EXPECT_FALSE(passes(scene, of));
  EXPECT_TRUE(passes(open, cut_off(open)));
}

TEST(Audited, StepsOfChosenLengthAndBoundsOfEachVertex) {
  const Scene scene = thrown(CollisionChoice::audited, fast);
  Method adaptive = method_of();
  adaptive.step_size.rule = StepSizeRule::adaptive;
  const Course parts = course(scene, std::move(adaptive), 3);
  EXPECT_GT(parts.redone(), 0);
  EXPECT_GT(parts.steps.size(), 3U) << "no step was cut";
  EXPECT_FALSE(passes(scene, parts));
  const auto by_vertex = [](const Scene& of) {
    Method method = method_of();
    method.contact_options.step_bound = StepBoundRule::planar_balanced;
    return course(of, std::move(method), 1);
  };
  const Course each = by_vertex(scene);
  EXPECT_EQ(each.redone(), 1);
  EXPECT_EQ(each.x[1], by_vertex(thrown(CollisionChoice::ccd, fast)).x[1]);
}

TEST(Audited, AnArchiveBetweenStepsIsTheWholeRun) {
  const Scene scene = thrown(CollisionChoice::audited, fast);
  for (const std::string solver : {"line_search", "accumulated_toi"}) {
    Method one = method_of(solver), two = method_of(solver);
    Simulation simulation(scene, one, dt, 4);
    StepObserver nobody;
    int redone = 0;
    for (int step = 0; step < 4; ++step) {
      Archive start;
      simulation.keep(start);
      redone += simulation.step(nobody).redone_audited;
      Simulation other(scene, two, dt, 4);
      Archive read(start.bytes());
      other.keep(read);
      other.step(nobody);
      ASSERT_EQ(other.history().x, simulation.history().x) << solver << " step " << step;
    }
    EXPECT_GT(redone, 0) << solver;
  }
}

/// The bound of a motion of the small cloth through the other one, after a first step that was done again.
TEST(Audited, WhatComesAfterAStepThatWasDoneAgainIsNotBounded) {
  for (const CollisionChoice choice : {CollisionChoice::audited, CollisionChoice::ccd}) {
    const Scene scene = thrown(choice, fast);
    Method method = method_of();
    Simulation simulation(scene, method, dt, 2);
    StepObserver nobody;
    EXPECT_EQ(simulation.step(nobody).redone_audited, choice == CollisionChoice::audited);
    Positions down = Positions::Zero(3, scene.x0.cols());
    down.leftCols(9).row(2).array() -= 1;
    NewtonSystem& system = simulation.system();
    system.set_direction(down);
    system.prepare_motion(MotionEnd::free, false);
    IterationReport report;
    EXPECT_EQ(system.bound_motion(report) < 1, choice == CollisionChoice::ccd);
  }
}

/// A strip that is folded over itself and closes within a step.
TEST(Audited, ABodyAndItselfUnderAuto) {
  const auto strip = [](CollisionChoice choice) {
    SceneBuilder builder("strip", false, Vec3d::Zero(), "test");
    BodySpec spec = test::cloth_spec(2, 0, d_hat);
    spec.mesh = grid_mesh(9, 2, 0.8, 0.1);
    Positions folded = spec.mesh.vertices;
    for (Eigen::Index v = 0; v < folded.cols();
         ++v) {  // the right half lies above the left one, shifted along it
      double& along = folded(0, v);
      if (along > 1e-9) along = -along + 0.033, folded(2, v) = 0.04;
    }
    spec.start = folded;
    builder.add_body(spec);
    builder.add_collision({"cloth", "cloth", choice}, "/collisions/0");
    Scene scene = builder.finish();
    for (Eigen::Index v = 0; v < scene.v0.cols(); ++v) {
      if (scene.x0(2, v) > 0.02) scene.v0(2, v) = fast;
    }
    return scene;
  };
  const Scene scene = strip(CollisionChoice::automatic);
  ASSERT_EQ(scene.collisions.kind(0, 0), CollisionKind::audited);
  const Course audited = course(scene, method_of(), 1);
  EXPECT_EQ(audited.redone(), 1);
  EXPECT_GT(audited.contacts(), 0U);
  EXPECT_EQ(audited.x[1], course(strip(CollisionChoice::ccd), method_of(), 1).x[1]);
  EXPECT_FALSE(passes(scene, audited));
  EXPECT_TRUE(passes(scene, course(strip(CollisionChoice::proximity), method_of(), 1)));
}

}  // namespace
}  // namespace bb::audited_test
