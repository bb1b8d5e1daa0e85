// Differences of energies between two states of an executor, against those of the CPU path.
#include <cmath>

#include "tests/executor/on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec_change_test {
namespace {

using namespace bb::test;
constexpr double eps = std::numeric_limits<double>::epsilon();

struct Pair {
  Scene scene;
  TermOptions options;
  StepFrame frame;
  Positions x;
  CpuElements cpu;
  test::TestedExecutor executor;
  OnExecutor resident;

  explicit Pair(bool planar, const char* model = "stable_neo_hookean", const char* limit = "cubic",
                Argument argument = Argument::gap, bool literal = false)
      : scene(cloth_scene(model, planar)),
        options(with_form(element_options(limit), argument, literal)),
        frame(step_frame(scene)),
        x(strained(scene)),
        cpu(scene, options, frame),
        resident(executor, scene, options, frame) {
    cpu.linearise(x, StepHessian::clamped);
    resident.linearise(x);
  }
  static TermOptions with_form(TermOptions options, Argument argument, bool literal) {
    options.limit.argument = argument;
    options.limit.literal = literal;
    return options;
  }
  /// The parts of all terms.
  EnergyParts parts(const Positions& to) {
    EnergyParts out;
    for (const auto& term : cpu.terms) {
      EXPECT_TRUE(admits(*term, cpu.scene.x0, to, cpu.clock));
      term->evaluate(to);
    }
    for (const auto& term : cpu.terms) term->change(x, to, out);
    return out;
  }
};

TEST(ExecutorChange, IsThatOfTheTermsForMotionsOfAnySize) {
  double worst = 0;
  for (const bool planar : {false, true}) {
    for (const double size : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
      Pair pair(planar);
      const Positions to = pair.x + wave(pair.scene, size);
      ASSERT_TRUE(pair.resident.evaluate(to));
      const exec::Compensated found = pair.resident.change();
      long double change = 0, magnitude = 0;
      for (const EnergyPart& part : pair.parts(to)) change += part.change, magnitude += part.magnitude;
      const EnergyChange cpu = pair.cpu.sums.change(pair.cpu.terms, pair.x, to);
      const auto scale = static_cast<double>(magnitude);
      ASSERT_GT(scale, 0.1);
      EXPECT_NE(found.value(), 0);
      const double off = std::abs(found.value() - static_cast<double>(change)) / (eps * scale);
      EXPECT_LE(off, 2e-3) << size;  // far below a rounding error of the energy
      EXPECT_LE(std::abs(found.value() - cpu.change), 2 * eps * scale);
      EXPECT_NEAR(found.magnitude, cpu.magnitude, 1e-13 * scale);
      worst = std::max(worst, off);
    }
  }
  std::printf("largest difference of changes: %.2g eps of the magnitude\n", worst);
}

TEST(ExecutorChange, IsThatOfTheTermsForEveryMembrane) {
  int n_pairs = 0;
  for (const MembraneModel<double>& model : membrane_models<double>()) {
    for (const bool planar : {false, true}) {
      Pair pair(planar, model.name.data());
      const Positions to = pair.x + wave(pair.scene, 1e-3);
      ASSERT_TRUE(pair.resident.evaluate(to));
      const exec::Compensated found = pair.resident.change();
      long double change = 0, magnitude = 0;
      for (const EnergyPart& part : pair.parts(to)) change += part.change, magnitude += part.magnitude;
      EXPECT_GT(std::abs(found.value()), 1e-6);
      EXPECT_NEAR(found.value(), static_cast<double>(change), eps * static_cast<double>(magnitude))
          << model.name;
      ++n_pairs;
    }
  }
  EXPECT_GE(n_pairs, 8);
}

/// Of the change from pair.x to a state: that of all terms on both sides, and of the limit alone.
void expect_change_of_limit(Pair& pair, const Positions& to, const std::string& what) {
  ASSERT_TRUE(pair.resident.evaluate(to)) << what;
  const exec::Compensated found = pair.resident.change();
  double change = 0, magnitude = 0, of_limit = 0;
  for (const auto& term : pair.cpu.terms) {
    EnergyParts parts;
    EXPECT_TRUE(admits(*term, pair.cpu.scene.x0, to, pair.cpu.clock));
    term->evaluate(to);
    term->change(pair.x, to, parts);
    for (const EnergyPart& part : parts) {
      change += part.change, magnitude += part.magnitude;
      if (term->group() == TermGroup::limit) of_limit += part.change;
    }
  }
  EXPECT_GT(std::abs(of_limit), 1e-6) << what;
  EXPECT_NEAR(found.value(), change, 1e-13 * magnitude) << what;
}

// The kernel that measures a trial has the shape in it, once for the plane and once for space. Stretched one way, then both,
// so that the smaller singular value acts too.
TEST(ExecutorChange, IsThatOfTheTermsForEveryShapeOfTheLimit) {
  struct Form {
    Argument argument;
    bool literal;
  };
  int n_pairs = 0;
  for (const char* shape : {"log", "log_squared", "quadratic", "cubic", "two_stage", "exponential"}) {
    for (const Form form : {Form{Argument::gap, false}, Form{Argument::squared_gap, false},
                            Form{Argument::gap, true}, Form{Argument::squared_gap, true}}) {
      for (const bool planar : {false, true}) {
        Pair pair(planar, "arap", shape, form.argument, form.literal);
        ASSERT_GT(pair.resident.energy(TermGroup::limit).value(), 1e-6) << shape;
        Positions both_ways = pair.x;
        both_ways.row(0) *= 1.1;
        const std::string what = std::string(shape) + (planar ? ", planar" : ", in space");
        expect_change_of_limit(pair, pair.x + wave(pair.scene, 2e-3), what);
        expect_change_of_limit(pair, both_ways, what + ", both ways");
        Positions beyond = both_ways;
        beyond.topRows(2) *= 1.3;
        EXPECT_EQ(pair.resident.evaluate(beyond), form.literal) << what;
        ++n_pairs;
      }
    }
  }
  EXPECT_EQ(n_pairs, 48);
}

// Free fall of vertices far from their prediction: the change of their loads is known in closed form.
TEST(ExecutorChange, KeepsTheDigitsOfTheLoads) {
  Scene scene = cloth_scene("arap", false, 4);
  scene.membranes.clear();
  scene.springs = {};
  scene.hinges = {};
  scene.limit = {};
  const TermOptions options = element_options();
  StepFrame frame = step_frame(scene);
  frame.x_tilde.array() += 1e6;
  test::TestedExecutor executor;
  OnExecutor resident(executor, scene, options, frame);
  resident.linearise(scene.x0);
  Positions to = scene.x0;
  to.row(2).array() += 0x1p-30;
  ASSERT_TRUE(resident.evaluate(to));
  long double expected = 0;
  for (int v = 0; v < scene.n_vertices(); ++v) {
    const long double mass = scene.mass[static_cast<std::size_t>(v)];
    const long double weight = mass / (static_cast<long double>(frame.c) * frame.dt * frame.dt);
    const long double from = static_cast<long double>(scene.x0(2, v)) - frame.x_tilde(2, v);
    const long double step = static_cast<long double>(to(2, v)) - scene.x0(2, v);
    expected += weight * step * (from + step / 2) + mass * frame.load_factor * 10 * step;
  }
  ASSERT_LT(expected, -1e-5L);
  EXPECT_NEAR(resident.change().value(), static_cast<double>(expected),
              1e-14 * std::abs(static_cast<double>(expected)));
}

TEST(ExecutorChange, BelongsToTheIterateThatWasAccepted) {
  Pair pair(false);
  const Positions to = pair.x + wave(pair.scene, 1e-3);
  ASSERT_TRUE(pair.resident.evaluate(to));
  const double there = pair.resident.change().value();
  pair.resident.accept();
  ASSERT_TRUE(pair.resident.evaluate(pair.x));
  const exec::Compensated back = pair.resident.change();
  EXPECT_NE(there, 0);
  EXPECT_NEAR(back.value(), -there, 4 * eps * back.magnitude);
}

}  // namespace
}  // namespace bb::exec_change_test
