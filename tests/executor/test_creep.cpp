// Rest shapes that follow from step to step, and bending that grows, on an executor against the terms of the CPU path.
#include "core/base/archive/archive.hpp"
#include "tests/executor/on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec_creep_test {
namespace {

using namespace bb::test;

BodySpec folded_sheet() {
  BodySpec out;
  out.name = "sheet";
  out.mesh = grid_mesh(5, 4, 1.0, 0.8);
  for (Eigen::Index v = 0; v < out.mesh.vertices.cols(); ++v) {
    out.mesh.vertices(2, v) = 0.1 * std::sin(3.0 * static_cast<double>(v));
  }
  out.material.model = "none";
  out.material.density = 0.3;
  out.d_hat = 1e-3;
  return out;
}

struct Case {
  const char* name;
  const char* term;
  Scene scene;
};
std::vector<Case> all_cases() {
  std::vector<Case> out;
  const auto add = [&](const char* name, const char* term, const auto& set) {
    SceneBuilder builder("creep", false, Vec3d::Zero(), "test");
    BodySpec sheet = folded_sheet();
    set(sheet.material);
    builder.add_body(sheet);
    out.push_back({name, term, builder.finish()});
  };
  add("bending that grows", "hinges",
      [](Material& m) { m.bending = 0.01, m.bending_exponential = 0.02, m.bending_exponent = 3; });
  add("bending that creeps", "hinges",
      [](Material& m) { m.bending = 0.01, m.bending_yield = 0.02, m.bending_creep = 4; });
  add("bending that grows and creeps", "hinges", [](Material& m) {
    m.bending = 0.01, m.bending_exponential = 0.02, m.bending_yield = 0.02, m.bending_creep = 4;
  });
  add("springs that shrink and creep", "cloth_springs", [](Material& m) {
    m.cloth_tension = 3, m.cloth_compression = 1, m.cloth_tension_growing = 1;
    m.cloth_yield = 0.01, m.cloth_creep = 5, m.shrink_keys = {{0, 1}, {1, 0.7}};
  });
  add("triangles that shrink and creep", "membrane", [](Material& m) {
    m.model = "arap", m.youngs = 20, m.membrane_yield = 0.01, m.membrane_creep = 5;
    m.shrink_keys = {{0, 1}, {1, 0.7}};
  });
  return out;
}

struct Both {
  TermOptions options = element_options();
  StepFrame frame;
  CpuElements cpu;
  test::TestedExecutor executor;
  OnExecutor resident;

  explicit Both(const Scene& scene)
      : frame(frame_of(scene)), cpu(scene, options, frame), resident(executor, scene, options, frame) {}
  static StepFrame frame_of(const Scene& scene) {
    StepFrame out = step_frame(scene);
    out.c = 0;
    out.t_end = 0.3;
    return out;
  }
  void linearise(const Positions& x) {
    cpu.linearise(x, StepHessian::clamped);
    resident.linearise(x);
  }
  void end_step(const Positions& x) {
    for (const auto& term : cpu.terms) term->end_step(x, cpu.clock);
    resident.x.upload(numbers_of(x));
    for (const auto& term : resident.terms) term->end_step(resident.x, resident.clock);
  }
  void begin_step(const Positions& x) {
    frame.x_n = x;
    frame.t_end += frame.dt;
    for (const auto& term : cpu.terms) term->begin_step(frame, cpu.clock);
    resident.x_n.upload(numbers_of(x));
    for (const auto& term : resident.terms) term->begin_step(resident.step_of(frame), resident.clock);
  }
  void expect_same() {
    ASSERT_GT(largest(cpu.gradient), 1e-3);
    EXPECT_EQ(resident.gradient(), cpu.gradient);
    cpu.sum(TermSet::all(), StepHessian::clamped, HessianLevel({StepHessian::clamped}), {});
    resident.fill(TermSet::all(), {});
    const Difference found = compare(resident, cpu);
    EXPECT_GT(found.n_nonzero, 100);
    EXPECT_EQ(found.relative, 0);
    long double energy = 0;
    for (const auto& term : cpu.terms) {
      for (const double e : term->families()[0].local.energy) energy += e;
    }
    ASSERT_GT(energy, 1e-4L);
    EXPECT_NEAR(resident.energy(TermSet::all()).value(), static_cast<double>(energy),
                1e-13 * static_cast<double>(energy));
  }
};

TEST(ExecutorCreep, FollowsFromStepToStep) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.name);
    Both both(one.scene);
    ASSERT_TRUE(both.cpu.plan.term(one.term).needed);
    ASSERT_EQ(both.resident.terms.size(), 2u) << "inertia and the term";
    const Positions x = strained(one.scene, 0.05), y = strained(one.scene, 0.08);
    both.linearise(x);
    both.expect_same();
    const Positions first = both.cpu.gradient;
    both.end_step(x);
    both.linearise(x);
    EXPECT_EQ(both.cpu.gradient, first) << "a step that is over has its own energy";
    both.expect_same();
    for (int step = 0; step < 2; ++step) {
      both.begin_step(x);
      both.linearise(y);
      both.expect_same();
      both.end_step(y);
    }
    both.begin_step(x);
    both.linearise(x);
    both.expect_same();
    const bool creeps = std::string(one.name) != "bending that grows";
    EXPECT_EQ(largest(both.cpu.gradient - first) > 1e-3 * largest(first), creeps);
  }
}

TEST(ExecutorCreep, HasEveryMatrixOfTheTerms) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.name);
    Both both(one.scene);
    const Positions x = strained(one.scene, 0.05);
    both.linearise(x);
    both.end_step(x);
    both.begin_step(x);
    expect_every_matrix(both.resident, both.cpu, strained(one.scene, 0.08), 0);
  }
}

TEST(ExecutorCreep, HasTheEnergiesOfATrial) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.name);
    Both both(one.scene);
    both.linearise(strained(one.scene, 0.05));
    const Positions to = strained(one.scene, 0.08);
    ASSERT_TRUE(both.resident.evaluate(to));
    both.resident.accept();
    double energy = 0;
    for (const auto& term : both.cpu.terms) {
      term->evaluate(to);
      for (const double e : term->families()[0].trial_energy) energy += e;
    }
    ASSERT_GT(energy, 1e-4);
    EXPECT_NEAR(both.resident.energy(TermSet::all()).value(), energy, 1e-13 * energy);
  }
}

// What is remembered goes from path to path.
TEST(ExecutorCreep, IsKept) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.name);
    if (std::string(one.name) == "bending that grows") continue;
    Both both(one.scene), fresh(one.scene);
    const Positions x = strained(one.scene, 0.05);
    both.linearise(x);
    both.end_step(x);
    both.begin_step(x);
    both.linearise(x);
    both.end_step(x);
    Archive of_cpu, of_executor;
    for (const auto& term : both.cpu.terms) of_cpu.section(term->name()), term->keep(of_cpu);
    for (const auto& term : both.resident.terms) of_executor.section(term->name()), term->keep(of_executor);
    Archive from_cpu(of_cpu.bytes()), from_executor(of_executor.bytes());
    for (const auto& term : fresh.resident.terms) from_cpu.section(term->name()), term->keep(from_cpu);
    for (const auto& term : fresh.cpu.terms) from_executor.section(term->name()), term->keep(from_executor);
    EXPECT_TRUE(from_cpu.at_end());
    EXPECT_TRUE(from_executor.at_end());
    fresh.frame.t_end = both.frame.t_end;
    both.begin_step(x);
    fresh.begin_step(x);
    both.linearise(x);
    fresh.linearise(x);
    EXPECT_EQ(fresh.resident.gradient(), both.resident.gradient());
    EXPECT_EQ(fresh.cpu.gradient, both.cpu.gradient);
    fresh.expect_same();
  }
}

}  // namespace
}  // namespace bb::exec_creep_test
