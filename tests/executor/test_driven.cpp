// Terms of one family each (pulls, drag of the air, stitches, a pressure, springs of cloth that shrink) have the same bits in the sums of an
// executor and in those of the CPU path, whatever the time of the step is. Families against closed forms: tests/energy/test_load_families.cpp.
#include <cmath>

#include "core/model/mesh/generators.hpp"
#include "tests/executor/on_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::exec_driven_test {
namespace {

using namespace bb::test;
constexpr double eps = std::numeric_limits<double>::epsilon();

/// A sheet without elements of its own and without weight.
BodySpec bare_sheet(const char* name) {
  BodySpec out;
  out.name = name;
  out.mesh = grid_mesh(5, 4, 1.0, 0.8);
  for (Eigen::Index v = 0; v < out.mesh.vertices.cols(); ++v) {
    out.mesh.vertices(2, v) = 0.1 * std::sin(3.0 * static_cast<double>(v));
  }
  out.material.model = "none";
  out.material.density = 0.3;
  out.d_hat = 1e-3;
  return out;
}

Scene pulled() {
  SceneBuilder builder("pulled", false, Vec3d::Zero(), "test");
  BodySpec sheet = bare_sheet("sheet");
  for (const int v : {3, 12}) {
    PinSpec& pin = sheet.pins.emplace_back();
    pin.indices = {v, v + 1};
    pin.pull = 4.0 * v;
    pin.pull_factors = {{0, 1}, {1, 0.25}};
    pin.motion.velocity = Vec3d(0.2, -0.1, 0.4);
    pin.motion.angular_velocity = 0.7;
  }
  builder.add_body(sheet);
  return builder.finish();
}

Scene in_wind() {
  SceneBuilder builder("in wind", false, Vec3d::Zero(), "test");
  builder.set_air({0.9, 0.2, Vec3d::Zero(), {{0, Vec3d(1, 2, -1)}, {1, Vec3d(0, -3, 5)}}});
  BodySpec sheet = bare_sheet("sheet");
  PinSpec& pin = sheet.pins.emplace_back();  // has no mass, and so no drag
  pin.indices = {0};
  builder.add_body(sheet);
  return builder.finish();
}

Scene stitched() {
  SceneBuilder builder("stitched", false, Vec3d::Zero(), "test");
  builder.add_body(bare_sheet("lower"));
  BodySpec upper = bare_sheet("upper");
  upper.mesh.vertices.row(2).array() += 0.3;
  builder.add_body(upper);
  builder.add_stitch({"lower", "upper", {0, 3, 7}, {1, 3, 6}, 6, 0}, "/stitches/0");
  builder.add_stitch({"lower", "upper", {11, 15}, {11, 14}, 9, 0.5}, "/stitches/1");  // pushes
  return builder.finish();
}

/// Two balls, one with a pressure that changes.
Scene inflated() {
  SceneBuilder builder("inflated", false, Vec3d::Zero(), "test");
  for (const int i : {0, 1}) {
    BodySpec ball = bare_sheet("ball");
    ball.name += std::to_string(i);
    ball.mesh = icosphere_mesh(i + 1, 0.5);
    ball.mesh.vertices.row(0).array() += 2 * i;
    if (i == 0) ball.pressure = 30;
    if (i == 1) ball.pressure_keys = {{0, 20}, {1, 40}};
    builder.add_body(ball);
  }
  return builder.finish();
}

Scene sprung() {
  SceneBuilder builder("sprung", false, Vec3d::Zero(), "test");
  for (const bool shrinks : {false, true}) {
    BodySpec sheet = bare_sheet(shrinks ? "shrinks" : "stays");
    sheet.mesh.vertices.row(2).array() += shrinks ? 1 : 0;
    sheet.material.cloth_tension = 3, sheet.material.cloth_tension_growing = 2;
    sheet.material.cloth_compression = 1, sheet.material.cloth_compression_growing = 0.5;
    sheet.material.cloth_exponent = 4;
    if (shrinks) sheet.material.shrink_keys = {{0, 1}, {1, 0.6}};
    builder.add_body(sheet);
  }
  return builder.finish();
}

struct Case {
  const char* term;
  Scene scene;
  double tolerance = 0;  // of the matrix, relative
};
std::vector<Case> all_cases() {
  std::vector<Case> out;
  out.push_back({"pull", pulled()});
  out.push_back(
      {"air_drag", in_wind(), 1e-16});  // K is symmetric to rounding, and the host keeps one triangle of it
  out.push_back({"inflation", inflated()});
  out.push_back({"cloth_springs", sprung()});
  out.push_back({"stitch", stitched()});
  return out;
}

/// Without inertia: a term of the size of what is tested.
StepFrame frame_at(const Scene& scene, double t_end) {
  StepFrame out = step_frame(scene);
  out.c = 0;
  out.t_end = t_end;
  return out;
}

struct Both {
  TermOptions options = element_options();
  StepFrame frame;
  Positions x;
  CpuElements cpu;
  test::TestedExecutor executor;
  OnExecutor resident;

  explicit Both(const Case& of)
      : frame(frame_at(of.scene, 0.3)),
        x(strained(of.scene, 0.05)),
        cpu(of.scene, options, frame),
        resident(executor, of.scene, options, frame) {
    EXPECT_TRUE(cpu.plan.term(of.term).needed);
    EXPECT_EQ(resident.terms.size(), 2u) << "inertia and the term";
    linearise();
  }
  void linearise() {
    cpu.linearise(x, StepHessian::clamped);
    resident.linearise(x);
  }
  /// Energies are summed in another order.
  void expect_same() {
    linearise();
    ASSERT_GT(largest(cpu.gradient), 1e-2);
    EXPECT_EQ(resident.gradient(), cpu.gradient);
    const double expected = total_energy(cpu.terms, TermSet::all());
    ASSERT_GT(std::abs(expected), 1e-3);
    EXPECT_NEAR(resident.energy(TermSet::all()).value(), expected, 1e-13 * std::abs(expected));
  }
};

// Also at another time and with another length: what is given as a function of time follows.
TEST(ExecutorDriven, HasTheGradientAndEnergiesOfTheTerms) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.term);
    Both both(one);
    both.expect_same();
    const Positions before = both.cpu.gradient;
    both.frame.dt = 0.02;
    both.frame.t_end = 0.6;
    for (const auto& term : both.cpu.terms) term->change_step(both.frame);
    for (const auto& term : both.resident.terms) term->change_step(both.resident.step_of(both.frame));
    both.expect_same();
    EXPECT_EQ(both.cpu.gradient == before, std::string(one.term) == "stitch");
  }
}

TEST(ExecutorDriven, HasTheMatrixOfTheTerms) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.term);
    Both both(one);
    expect_every_matrix(both.resident, both.cpu, both.x, one.tolerance);
  }
}

// Also of so small a step that energies are equal to their last place.
TEST(ExecutorDriven, ChangesAsTheTermsDo) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.term);
    for (const double size : {1e-2, 1e-9}) {
      Both both(one);
      const Positions to = both.x + wave(one.scene, size);
      ASSERT_TRUE(both.resident.evaluate(to));
      for (const auto& term : both.cpu.terms) term->evaluate(to);
      const EnergyChange expected = both.cpu.sums.change(both.cpu.terms, both.x, to);
      ASSERT_NE(expected.change, 0);
      const exec::Compensated found = both.resident.change();
      const bool closed = std::string(one.term) == "pull" || std::string(one.term) == "air_drag";
      EXPECT_NEAR(found.value(), expected.change,
                  4 * eps * (closed ? std::abs(expected.change) : expected.magnitude));
      EXPECT_NEAR(found.magnitude, expected.magnitude, 1e-13 * expected.magnitude);
      both.resident.accept();
      for (const auto& term : both.cpu.terms) term->take_energies();
      const double energy = total_energy(both.cpu.terms, TermSet::all());
      EXPECT_NEAR(both.resident.energy(TermSet::all()).value(), energy, 1e-14 * std::abs(energy));
    }
  }
}

TEST(ExecutorDriven, HasTheSameBitsInEveryOrderAndForEveryPiece) {
  for (const Case& one : all_cases()) {
    SCOPED_TRACE(one.term);
    Both both(one);
    both.resident.fill(TermSet::all(), {Projection::none, 0.25, -1, nullptr});
    const std::vector<double> matrix = both.resident.matrix();
    const Positions gradient = both.resident.gradient();
    for (const auto& executor : all_orders()) {
      for (const exec::Index piece : {exec::Index{3}, exec::ElementMatrix::default_piece}) {
        OnExecutor other(*executor, one.scene, both.options, both.frame, piece);
        other.linearise(both.x);
        other.fill(TermSet::all(), {Projection::none, 0.25, -1, nullptr});
        EXPECT_EQ(other.matrix(), matrix);
        EXPECT_EQ(other.gradient(), gradient);
      }
    }
  }
}

}  // namespace
}  // namespace bb::exec_driven_test
