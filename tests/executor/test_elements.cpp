// Elements, loads and matrix of an executor against the terms of the CPU path.
#include <cmath>

#include "core/energy/membrane_model.hpp"
#include "core/exec/counting_executor.hpp"
#include "tests/executor/on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec_elements_test {
namespace {

using namespace bb::test;

struct Case {
  const char* model;
  bool planar;
};
std::vector<Case> all_cases() {
  std::vector<Case> out;
  for (const MembraneModel<double>& model : membrane_models<double>()) {
    out.push_back({model.name.data(), false});
    out.push_back({model.name.data(), true});
  }
  return out;
}

TEST(ExecutorElements, HaveTheGradientAndEnergiesOfTheTerms) {
  for (const Case& one : all_cases()) {
    const Scene scene = cloth_scene(one.model, one.planar);
    TermOptions options = element_options();
    const StepFrame frame = step_frame(scene);
    const Positions x = strained(scene);
    CpuElements cpu(scene, options, frame);
    cpu.linearise(x, StepHessian::clamped);
    test::TestedExecutor executor;
    OnExecutor resident(executor, scene, options, frame);
    resident.linearise(x);
    ASSERT_GT(largest(cpu.gradient), 0.1);
    EXPECT_EQ(resident.gradient(), cpu.gradient) << one.model;
    for (const TermGroup group : {TermGroup::load, TermGroup::elastic, TermGroup::limit}) {
      long double expected = 0, magnitude = 0;
      for (const auto& term : cpu.terms) {
        if (term->group() != group) continue;
        for (const double e : term->families()[0].local.energy) expected += e, magnitude += std::abs(e);
      }
      const exec::Compensated sum = resident.energy(group);
      EXPECT_GT(std::abs(sum.value()), 1e-9) << one.model << static_cast<int>(group);
      EXPECT_NEAR(sum.value(), static_cast<double>(expected), 1e-14 * static_cast<double>(magnitude));
      EXPECT_NEAR(sum.magnitude, static_cast<double>(magnitude), 1e-13 * static_cast<double>(magnitude));
    }
    EXPECT_EQ(resident.first_not_finite().second, -1);
  }
}

// All choices of a step's Hessian at all their levels.
TEST(ExecutorElements, HaveTheMatrixOfTheTerms) {
  int n_matrices = 0;
  for (const Case& one : all_cases()) {
    const Scene scene = cloth_scene(one.model, one.planar, 4);
    TermOptions options = element_options();
    const StepFrame frame = step_frame(scene);
    const Positions x = strained(scene);
    test::TestedExecutor executor;
    OnExecutor resident(executor, scene, options, frame);
    resident.linearise(x);
    std::vector<double> force;
    for (int v = 0; v < scene.n_vertices(); ++v) force.push_back(1 + std::sin(5.0 * v));
    exec::Buffer<double> force_there(executor, "force");
    force_there.upload(force);
    for (const StepHessian choice : all_step_hessians) {
      CpuElements cpu(scene, options, frame);
      cpu.linearise(x, choice);
      HessianLevel level({choice});
      for (;;) {
        cpu.sum(TermSet::all(), choice, level, force);
        resident.fill(TermSet::all(),
                      exec::hessian_request(choice, level.t(), level.threshold(), force_there.data()));
        const Difference found = compare(resident, cpu);
        EXPECT_GT(found.n_nonzero, 100);
        EXPECT_EQ(found.relative, 0) << one.model << " " << to_string(choice) << " " << level.t();
        ++n_matrices;
        if (level.last() || choice == StepHessian::clamped || choice == StepHessian::absolute) break;
        level.raise(2);
      }
    }
  }
  EXPECT_GT(n_matrices, 100);
}

// By themselves, so that no stiffer element hides what differs.
TEST(ExecutorElements, HingesAloneAgree) {
  Scene scene = cloth_scene("arap", false, 6);
  scene.membranes.clear();
  scene.springs = {};
  scene.limit = {};
  scene.gravity.setZero();
  TermOptions options = element_options();
  StepFrame frame = step_frame(scene);
  frame.c = 0;
  test::TestedExecutor executor;
  OnExecutor resident(executor, scene, options, frame);
  for (const double folds : {0.3, 1.0}) {  // m, some triangles turn over
    const Positions x = strained(scene, folds);
    CpuElements cpu(scene, options, frame);
    cpu.linearise(x, StepHessian::clamped);
    resident.linearise(x);
    EXPECT_GT(largest(cpu.gradient), 1e-2);
    EXPECT_EQ(resident.gradient(), cpu.gradient);
    ASSERT_TRUE(resident.evaluate(strained(scene, 0.9 * folds)));
    EXPECT_NE(resident.change().value(), 0);
  }
  resident.linearise(strained(scene));
  for (const StepHessian choice : {StepHessian::clamped, StepHessian::absolute, StepHessian::blend}) {
    CpuElements cpu(scene, options, frame);
    cpu.linearise(strained(scene), choice);
    ASSERT_GT(largest(cpu.gradient), 1e-4);
    EXPECT_EQ(resident.gradient(), cpu.gradient);
    const HessianLevel level({choice});
    cpu.sum(TermSet::all(), choice, level, {});
    resident.fill(TermSet::all(), exec::hessian_request(choice, level.t(), level.threshold(), nullptr));
    const Difference found = compare(resident, cpu);
    EXPECT_GT(found.n_nonzero, 1000);
    EXPECT_EQ(found.relative, 0) << to_string(choice);
    std::printf("%s: %.2g\n", std::string(to_string(choice)).c_str(), found.relative);
  }
}

TEST(ExecutorElements, SumTheGroupsThatAreAskedFor) {
  const Scene scene = cloth_scene("stvk", false, 4);
  TermOptions options = element_options();
  const StepFrame frame = step_frame(scene);
  CpuElements cpu(scene, options, frame);
  cpu.linearise(strained(scene), StepHessian::clamped);
  test::TestedExecutor executor;
  OnExecutor resident(executor, scene, options, frame);
  resident.linearise(strained(scene));
  std::vector<std::vector<double>> seen;
  for (const TermSet set : {TermSet(TermGroup::load), TermSet(TermGroup::elastic), TermSet(TermGroup::limit),
                            TermSet(TermGroup::elastic) | TermGroup::load}) {
    cpu.sum(set, StepHessian::clamped, HessianLevel({StepHessian::clamped}), {});
    resident.fill(set, {});
    const Difference found = compare(resident, cpu);
    EXPECT_GT(found.n_nonzero, 10);
    EXPECT_EQ(found.relative, 0);
    for (const auto& other : seen) EXPECT_NE(resident.matrix(), other);
    seen.push_back(resident.matrix());
  }
  // what was elastic stays while the rest is added
  resident.fill(TermGroup::elastic, {});
  resident.add(TermGroup::load, {});
  EXPECT_EQ(resident.matrix(), seen.back());
}

TEST(ExecutorElements, HaveTheSameBitsInEveryOrderAndForEveryPiece) {
  const Scene scene = cloth_scene("baraff_witkin", false);
  TermOptions options = element_options("log");
  options.limit_stiffness = elastic_limit();
  options.contact_options.ccd_park = 1e-3;
  const StepFrame frame = step_frame(scene);
  const Positions x = strained(scene), dx = wave(scene, 0.3);
  struct Found {
    std::vector<double> matrix, some_clamped;
    Positions gradient;
    double change = 0, carry = 0, bound = 0;
    bool operator==(const Found&) const = default;
  };
  std::vector<double> sizes(static_cast<std::size_t>(scene.n_vertices()),
                            0);  // N: some vertices have a large force
  for (std::size_t v = 0; v < sizes.size(); v += 7) sizes[v] = 1;
  const auto find = [&](exec::Executor& executor, exec::Index piece) {
    exec::Buffer<double> force(executor, "force");
    force.upload(sizes);
    OnExecutor resident(executor, scene, options, frame, piece);
    resident.linearise(x);
    Found out;
    out.gradient = resident.gradient();
    resident.fill(TermSet::all(), {Projection::none, 0.25, -1, nullptr});
    out.matrix = resident.matrix();
    resident.fill(TermSet::all(), {Projection::none, 0, 0.5, force.data()});
    out.some_clamped = resident.matrix();
    EXPECT_TRUE(resident.evaluate(x + 1e-3 * dx));
    const exec::Compensated change = resident.change();
    out.change = change.sum, out.carry = change.carry;
    out.bound = resident.bound(dx);
    return out;
  };
  test::TestedExecutor first;
  const Found expected = find(first, exec::ElementMatrix::default_piece);
  EXPECT_NE(expected.change, 0);
  EXPECT_NE(expected.matrix, expected.some_clamped);
  EXPECT_GT(expected.bound, 0);
  EXPECT_LT(expected.bound, 1);
  for (const auto& executor : all_orders()) EXPECT_TRUE(find(*executor, 1000) == expected);
  for (const exec::Index piece : {1, 3, 32}) EXPECT_TRUE(find(first, piece) == expected) << piece;
}

TEST(ExecutorElements, RefuseWhatHasNoKernel) {
  const Scene scene = cloth_scene("arap", false, 3);
  test::TestedExecutor executor;
  TermOptions options = element_options();
  options.limit.shape.name = "mine", options.limit.shape.launches = nullptr;
  try {
    const OnExecutor resident(executor, scene, options);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("mine"), std::string::npos);
  }
  EXPECT_EQ(executor.memory().bytes(), 0u);
}

TEST(ExecutorElements, AreCountedWithoutMemory) {
  const Scene scene = cloth_scene("arap", false, 8);
  const TermOptions options = element_options();
  test::TestedExecutor host;
  exec::CountingExecutor counting;
  const OnExecutor there(host, scene, options), counted(counting, scene, options);
  EXPECT_GT(host.memory().bytes(), 10000u);
  EXPECT_EQ(host.memory().by_name(), counting.memory().by_name());
  for (const char* name : {"element matrix values", "limit stiffness", "hinge vertices"}) {
    EXPECT_EQ(host.memory().by_name().count(name), 1u) << name;
  }
}

TEST(ExecutorElements, AreToldTheStepThatItIs) {
  test::TestedExecutor executor;
  exec::Buffer<double> x_n(executor, "start"), x_tilde(executor, "prediction");
  x_n.upload(std::vector<double>(6, 1));
  x_tilde.upload(std::vector<double>(6, 2));
  const FamilyStep step = StepColumns{x_n, x_tilde, 0.1, 0.25, 0.5, 3, true}.of_families();
  EXPECT_EQ(step.x_n, x_n.data());
  EXPECT_EQ(step.x_tilde, x_tilde.data());
  EXPECT_EQ(step.dt, 0.1);
  EXPECT_EQ(step.c, 0.25);
  EXPECT_EQ(step.load_factor, 0.5);
  EXPECT_EQ(step.t_end, 3);
  EXPECT_TRUE(step.at_start);
}

TEST(ExecutorElements, NameTheFirstElementThatIsNoNumber) {
  const Scene scene = cloth_scene("arap", true, 4);
  const TermOptions options = element_options();
  const StepFrame frame = step_frame(scene);
  test::TestedExecutor executor;
  OnExecutor resident(executor, scene, options, frame);
  Positions x = strained(scene);
  x(0, 5) = std::nan("");
  resident.linearise(x);
  const auto [term, element] = resident.first_not_finite();
  EXPECT_EQ(term, "membrane");
  const auto& triangle = scene.membranes[0].triangles[static_cast<std::size_t>(element)];
  EXPECT_TRUE(triangle[0] == 5 || triangle[1] == 5 || triangle[2] == 5);
}

}  // namespace
}  // namespace bb::exec_elements_test
