// Rods and solids of an executor against the terms of the CPU path: energies, gradients, matrices, changes.
#include <cmath>

#include "core/energy/solid_model.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "tests/executor/on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec_parts_test {
namespace {

using namespace bb::test;
constexpr double eps = std::numeric_limits<double>::epsilon();
// The CPU's product of rods is Eigen's, in vectors where the processor has them; all else is the same arithmetic.
constexpr double rod_rounding = 1e-14;

Scene scene_of(const std::vector<BodySpec>& bodies) {
  SceneBuilder builder("parts", false, Vec3d(0, 0, -10), "test");
  for (const BodySpec& body : bodies) builder.add_body(body);
  return builder.finish();
}

BodySpec helix() {
  BodySpec body;
  body.name = "helix";
  body.mesh = helix_mesh(24, 1.5, 0.2, 0.1);
  body.material.line_density = 0.3;
  body.material.rod_stretching = 50;
  body.material.rod_bending = 0.02;
  body.d_hat = 0.001;
  PinSpec pin;
  pin.indices = {0, 1};
  body.pins.push_back(pin);
  return body;
}

/// Straight at rest, so that its corners have theta0 = 0.
BodySpec straight_rod() {
  BodySpec body = helix();
  body.name = "rod";
  body.mesh = rod_mesh(6, Vec3d(1, 0, 0), Vec3d(1, 1, 0.5));
  return body;
}

BodySpec block(const std::string& model, const std::string& name, double height) {
  BodySpec body;
  body.name = name;
  body.mesh = solid_box_mesh({2, 3, 2}, Vec3d(0.4, 0.5, 0.3));
  body.mesh.vertices.row(2).array() += height;
  body.material.solid_model = model;
  body.material.solid_youngs = 200;
  body.material.solid_density = 3;
  body.d_hat = 0.01;
  PinSpec pin;
  pin.indices = {0, 1};
  body.pins.push_back(pin);
  return body;
}

struct Case {
  std::string name;
  Scene scene;
  double size;       // m, how far vertices are moved
  double tolerance;  // relative
};

std::vector<Case> all_cases() {
  std::vector<Case> out;
  out.push_back({"rods", scene_of({helix(), straight_rod()}), 0.05, rod_rounding});
  for (const SolidModel<double>& model : solid_models<double>()) {
    out.push_back({std::string(model.name), scene_of({block(std::string(model.name), "block", 0)}), 0.08, 0});
  }
  out.push_back({"two models", scene_of({block("stvk", "one", 0), block("arap", "other", 2)}), 0.08, 0});
  return out;
}

struct Both {
  TermOptions options = element_options();
  StepFrame frame;
  Positions x;
  CpuElements cpu;
  test::TestedExecutor executor;
  OnExecutor resident;

  explicit Both(const Case& of, StepHessian choice = StepHessian::clamped)
      : frame(step_frame(of.scene)),
        x(strained(of.scene, of.size)),
        cpu(of.scene, options, frame),
        resident(executor, of.scene, options, frame) {
    cpu.linearise(x, choice);
    resident.linearise(x);
  }
};

TEST(ExecutorParts, HaveTheGradientAndEnergiesOfTheTerms) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.name);
    Both both(one);
    ASSERT_EQ(both.resident.terms.size() + 1, both.cpu.terms.size());  // inertia and weight are one
    ASSERT_GT(largest(both.cpu.gradient), 0.1);
    EXPECT_LE(largest(both.resident.gradient() - both.cpu.gradient),
              one.tolerance * largest(both.cpu.gradient));
    long double expected = 0;
    for (const auto& term : both.cpu.terms) {
      if (term->group() != TermGroup::elastic) continue;
      for (const double e : term->families()[0].local.energy) expected += e;
    }
    ASSERT_GT(expected, 1e-3L);
    EXPECT_NEAR(both.resident.energy(TermGroup::elastic).value(), static_cast<double>(expected),
                1e-14 * static_cast<double>(expected));
  }
}

// All choices of a step's Hessian at all their levels. The clamped matrix is another than the exact one.
TEST(ExecutorParts, HaveTheMatrixOfTheTerms) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.name);
    std::vector<double> exact, clamped;
    for (const StepHessian choice : {StepHessian::clamped, StepHessian::absolute, StepHessian::blend}) {
      Both both(one, choice);
      HessianLevel level({choice});
      for (;;) {
        both.cpu.sum(TermSet::all(), choice, level, {});
        both.resident.fill(TermSet::all(),
                           exec::hessian_request(choice, level.t(), level.threshold(), nullptr));
        const Difference found = compare(both.resident, both.cpu);
        EXPECT_GT(found.n_nonzero, 100);
        EXPECT_LE(found.relative, one.tolerance) << to_string(choice) << " " << level.t();
        if (choice == StepHessian::clamped) clamped = both.resident.matrix();
        if (choice == StepHessian::blend && level.t() == 0) exact = both.resident.matrix();
        if (level.last() || choice != StepHessian::blend) break;
        level.raise(2);
      }
    }
    EXPECT_NE(exact, clamped);
  }
}

TEST(ExecutorParts, ChangeAsTheTermsDo) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.name);
    Both both(one);
    const Positions to = both.x + wave(one.scene, 1e-3);
    ASSERT_TRUE(both.resident.evaluate(to));
    EnergyParts parts;
    for (const auto& term : both.cpu.terms) term->evaluate(to);
    for (const auto& term : both.cpu.terms) term->change(both.x, to, parts);
    long double change = 0, magnitude = 0;
    for (const EnergyPart& part : parts) change += part.change, magnitude += part.magnitude;
    ASSERT_GT(std::abs(change), 1e-6L);
    EXPECT_NEAR(both.resident.change().value(), static_cast<double>(change),
                eps * static_cast<double>(magnitude));
  }
}

TEST(ExecutorParts, HaveTheSameBitsInEveryOrderAndForEveryPiece) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.name);
    Both both(one);
    both.resident.fill(TermSet::all(), {Projection::none, 0.25, -1, nullptr});
    const std::vector<double> matrix = both.resident.matrix();
    const Positions gradient = both.resident.gradient();
    for (const auto& executor : all_orders()) {
      for (const exec::Index piece : {exec::Index{7}, exec::ElementMatrix::default_piece}) {
        OnExecutor other(*executor, one.scene, both.options, both.frame, piece);
        other.linearise(both.x);
        other.fill(TermSet::all(), {Projection::none, 0.25, -1, nullptr});
        EXPECT_EQ(other.matrix(), matrix);
        EXPECT_EQ(other.gradient(), gradient);
      }
    }
  }
}

// Two neighbours of a rod that coincide; a solid with a point that is no number.
TEST(ExecutorParts, NameTheFirstElementThatIsNoNumber) {
  const Scene rods = scene_of({helix()});
  const TermOptions options = element_options();
  test::TestedExecutor executor;
  OnExecutor bent(executor, rods, options, step_frame(rods));
  Positions x = rods.x0;
  x.col(9) = x.col(8);
  bent.linearise(x);
  const auto [term, element] = bent.first_not_finite();
  ASSERT_EQ(term, "rods");
  EXPECT_EQ(rods.rods.corners[static_cast<std::size_t>(element)][2], 9);
}

}  // namespace
}  // namespace bb::exec_parts_test
