// Terms with stencils that stay: an executor's sums have the bits of the host's engine at equal states, for every kind of element, load and
// limit, in steps that follow one another, and the same bits in every order. What an element has itself: tests/energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/exec/counting_executor.hpp"
#include "core/math/error.hpp"
#include "tests/barriers/host_policy.hpp"
#include "tests/executor/on_executor.hpp"
#include "tests/executor/on_host.hpp"

namespace bb::exec_terms_test {
namespace {

using namespace bb::test;
constexpr double eps = std::numeric_limits<double>::epsilon();

/// Sums of the same parts in another order, each compensated.
void expect_same_sum(double found, double expected) {
  EXPECT_NEAR(found, expected, 4 * eps * std::abs(expected));
}

void expect_same(const Number& found, const Number& expected) {
  EXPECT_EQ(found.finite(), expected.finite());
  EXPECT_TRUE(!expected.finite() || found.value == expected.value) << found.value << " " << expected.value;
}

struct Both {
  const TermCase& of;
  Method method;
  StepFrame frame;
  OnHost host;
  TestedExecutor executor;
  OnExecutor there;

  explicit Both(const TermCase& given, StepHessian choice = StepHessian::clamped)
      : of(given),
        method(given.method()),
        frame(step_frame(given.scene, given.c)),
        host(given.scene, given.method(), frame, choice),
        there(executor, given.scene, method, frame) {}
  Positions first() const { return (of.literal() ? of.stretch : 1) * strained(of.scene, of.size); }
  Positions second() const { return of.stretch * strained(of.scene, 1.5 * of.size); }

  void linearise(const Positions& x) { host.linearise(x), there.linearise(x); }
  void begin_step(const Positions& x) {
    frame.x_n = x;
    frame.t_end += frame.dt;
    host.begin_step(frame), there.begin_step(frame);
  }
  void change_step() {
    frame.dt = 0.02, frame.t_end += 0.3;
    host.change_step(frame), there.change_step(frame);
  }
  void end_step(const Positions& x) { host.end_step(x), there.end_step(x); }

  /// Gradient, energies of every group and what is reported at x.
  Positions expect_same_state(const Positions& x) {
    linearise(x);
    Positions gradient = host.gradient();
    EXPECT_GT(largest(gradient), 1e-3);
    EXPECT_EQ(there.gradient(), gradient);
    double magnitude = 0;
    for (const TermGroup group : {TermGroup::load, TermGroup::elastic, TermGroup::limit}) {
      const double expected = host.energy(group);
      expect_same_sum(there.energy(group).value(), expected);
      magnitude += std::abs(expected);
    }
    EXPECT_GT(magnitude, 1e-4);
    const IterateNumbers a = host.report(), b = there.report();
    expect_same(b.max_stretch, a.max_stretch);
    expect_same(b.limit_gap_min_rel, a.limit_gap_min_rel);
    expect_same(b.limit_load_max_N_per_m, a.limit_load_max_N_per_m);
    expect_same(b.solid_limit_load_max_Pa, a.solid_limit_load_max_Pa);
    expect_same(b.limit_kappa_change_rel, a.limit_kappa_change_rel);
    EXPECT_EQ(there.first_not_finite().second, -1);
    return gradient;
  }
  /// From the iterate to a trial: whether it is feasible, how energies change, their sums once it is accepted.
  bool expect_same_trial(const Positions& to) {
    const bool admitted = host.is_feasible(to);
    EXPECT_EQ(there.evaluate(to), admitted);
    if (!admitted) return false;
    const EnergyChange expected = host.change();
    const exec::Compensated found = there.change();
    EXPECT_NE(expected.change, 0);
    expect_same_sum(found.value(), expected.change);
    EXPECT_NEAR(found.magnitude, expected.magnitude, 1e-13 * expected.magnitude);
    host.accept(), there.accept();
    for (const TermGroup group : {TermGroup::elastic, TermGroup::limit})
      expect_same_sum(there.energy(group).value(), host.energy(group));
    return true;
  }
  double expect_same_bound(const Positions& dx) {
    IterationReport a;
    IterateNumbers b;
    const double expected = host.bound(dx, a), found = there.bound(dx, &b);
    EXPECT_EQ(found, expected);
    EXPECT_EQ(a.alpha_strain, expected);
    EXPECT_EQ(b.alpha_strain, expected);
    return found;
  }
};

TEST(ExecutorTerms, HaveTheBitsOfTheHostInStepsThatFollowOneAnother) {
  int n_limited = 0, n_moved = 0;
  for (const TermCase& one : all_cases()) {
    SCOPED_TRACE(one.name);
    Both both(one);
    for (const std::string& term : one.terms) EXPECT_TRUE(both.host.plan().term(term).needed) << term;
    const Positions x = both.first(), y = both.second();
    const Positions at_first = both.expect_same_state(x);
    both.expect_same_state(y);     // kappa is refreshed or kept
    both.linearise(one.scene.x0);  // where no limit acts any more
    EXPECT_EQ(both.there.gradient(), both.host.gradient());
    both.linearise(x);
    for (const double size : {1e-3, 1e-9}) {
      EXPECT_TRUE(both.expect_same_trial(x + wave(one.scene, size)));
      both.linearise(x);
    }
    both.change_step();
    both.expect_same_state(x);
    both.end_step(y);
    both.begin_step(y);
    n_moved += largest(both.expect_same_state(x) - at_first) > 1e-3 * largest(at_first);
    const double load = both.there.report().limit_load_max_N_per_m.value;
    n_limited += load > 0 || both.there.report().solid_limit_load_max_Pa.value > 0;
  }
  EXPECT_GE(n_limited, 120);
  EXPECT_GE(n_moved, 20);
}

/// Where a limit ends a motion, and where it is stopped before that end.
TEST(ExecutorTerms, BoundAMotionAsTheHostDoes) {
  int n_below = 0, n_ended = 0, n_beyond = 0, n_earlier = 0;
  for (const TermCase& one : limit_cases()) {
    if (one.literal() || !one.name.starts_with("cubic, rule")) continue;
    SCOPED_TRACE(one.name);
    std::map<double, double> at_the_end;  // by the size of the motion: its bound without a stop level
    for (const double park : {0.0, 1e-4, 0.3}) {
      TermCase parked = one;
      parked.method = [&] {
        Method out = one.method();
        out.contact_options.min_gap_fraction = park;
        return out;
      };
      Both both(parked);
      const Positions x = both.first();
      for (const double size : {1e-4, 0.03, 0.1, 0.7, 20.0}) {
        both.linearise(x);
        const Positions dx = wave(one.scene, size);
        const double alpha = both.expect_same_bound(dx),
                     end = at_the_end.try_emplace(size, alpha).first->second;
        EXPECT_LE(alpha, end);
        n_below += alpha > 0 && alpha < 1;
        n_earlier += alpha < 0.99 * end;
        EXPECT_TRUE(both.expect_same_trial(x + alpha * dx));
        if (end == 1) continue;
        ++n_ended;
        both.linearise(x);
        n_beyond += !both.expect_same_trial(x + 1.01 * end * dx);
      }
    }
  }
  EXPECT_GT(n_ended, 60);
  EXPECT_EQ(n_beyond, n_ended);
  EXPECT_GE(n_below, n_ended);
  EXPECT_GT(n_earlier, 20);
}

/// Every choice of a step's Hessian at all its levels, some vertices with a large force.
TEST(ExecutorTerms, HaveEveryMatrixOfTheHost) {
  int n_matrices = 0, n_indefinite = 0;
  for (const TermCase& one : all_cases()) {
    if (one.name.starts_with("exponential") || one.name.starts_with("two_stage")) continue;
    if (one.name.starts_with("minimax")) continue;
    SCOPED_TRACE(one.name);
    std::vector<double> force(static_cast<std::size_t>(one.scene.n_vertices()));
    for (std::size_t v = 0; v < force.size(); ++v) force[v] = 1 + std::sin(5.0 * static_cast<double>(v));
    Eigen::MatrixXd exact, clamped;
    for (const StepHessian choice : all_step_hessians) {
      Both both(one, choice);
      exec::Buffer<double> force_there(both.executor, "force");
      force_there.upload(force);
      both.linearise(both.second());
      HessianRegularisation level({choice, StepHessian::blend});  // the levels of both
      for (;;) {
        const Eigen::MatrixXd expected = both.host.matrix(level, force);
        both.there.fill(TermSet::all(),
                        exec::hessian_request(choice, level.t(), level.threshold(), force_there.data()));
        ASSERT_GT(expected.cwiseAbs().maxCoeff(), 0);
        EXPECT_EQ(both.there.matrix(), expected) << to_string(choice) << " " << level.t();
        if (choice == StepHessian::clamped) clamped = expected;
        if (choice == StepHessian::blend && level.t() == 0) exact = expected;
        ++n_matrices;
        if (level.last() || choice == StepHessian::clamped || choice == StepHessian::absolute) break;
        level.raise(2);
      }
    }
    n_indefinite += exact != clamped;
  }
  EXPECT_GT(n_matrices, 500);
  EXPECT_GT(n_indefinite, 50);
}

TEST(ExecutorTerms, HaveTheSameBitsInEveryOrderAndForEveryPiece) {
  struct Found {
    Eigen::MatrixXd blended, some_clamped;
    Positions gradient;
    double change, carry, bound;
    bool operator==(const Found&) const = default;
  };
  std::vector<TermCase> cases = element_cases();
  for (TermCase& one : driven_cases()) cases.push_back(std::move(one));
  cases.push_back(limit_cases().back());
  for (const TermCase& one : cases) {
    SCOPED_TRACE(one.name);
    Method method = one.method();
    method.contact_options.min_gap_fraction = 1e-3;
    const Positions x = strained(one.scene, one.size), dx = wave(one.scene, 0.3);
    std::vector<double> sizes(one.scene.mass.size(), 0);  // N: some vertices have a large force
    for (std::size_t v = 0; v < sizes.size(); v += 7) sizes[v] = 1;
    const auto find = [&](exec::Executor& executor, exec::Index piece) {
      exec::Buffer<double> force(executor, "force");
      force.upload(sizes);
      OnExecutor there(executor, one.scene, method, step_frame(one.scene, one.c), piece);
      there.linearise(x);
      Found out;
      out.gradient = there.gradient();
      there.fill(TermSet::all(), {Projection::none, 0.25, -1, nullptr});
      out.blended = there.matrix();
      there.fill(TermSet::all(), {Projection::none, 0, 0.5, force.data()});
      out.some_clamped = there.matrix();
      EXPECT_TRUE(there.evaluate(x + 1e-4 * dx));
      const exec::Compensated change = there.change();
      out.change = change.sum, out.carry = change.carry;
      out.bound = there.bound(dx);
      return out;
    };
    TestedExecutor first;
    const Found expected = find(first, exec::ElementMatrix::default_piece);
    EXPECT_NE(expected.change, 0);
    EXPECT_GT(largest(expected.gradient), 1e-3);
    exec::Index piece = 1;
    for (const auto& executor : all_orders()) EXPECT_TRUE(find(*executor, piece = 2 * piece + 1) == expected);
    EXPECT_TRUE(find(first, 1) == expected);
  }
}

/// Free fall of vertices far from their prediction: the change of their loads is known in closed form.
TEST(ExecutorTerms, KeepTheDigitsOfTheLoads) {
  Scene scene = hinges_alone();
  scene.hinges = {};
  scene.gravity = Vec3d(0, 0, -10);
  const Method method = element_method();
  StepFrame frame = step_frame(scene);
  frame.x_tilde.array() += 1e6;
  TestedExecutor executor;
  OnExecutor there(executor, scene, method, frame);
  there.linearise(scene.x0);
  Positions to = scene.x0;
  to.row(2).array() += 0x1p-30;
  ASSERT_TRUE(there.evaluate(to));
  long double expected = 0;
  for (int v = 0; v < scene.n_vertices(); ++v) {
    const long double mass = scene.mass[static_cast<std::size_t>(v)];
    const long double weight = mass / (static_cast<long double>(frame.c) * frame.dt * frame.dt);
    const long double from = static_cast<long double>(scene.x0(2, v)) - frame.x_tilde(2, v);
    const long double step = static_cast<long double>(to(2, v)) - scene.x0(2, v);
    expected += weight * step * (from + step / 2) + mass * frame.load_factor * 10 * step;
  }
  ASSERT_LT(expected, -1e-5L);
  EXPECT_NEAR(there.change().value(), static_cast<double>(expected),
              1e-14 * std::abs(static_cast<double>(expected)));
}

TEST(ExecutorTerms, RefuseStatesBeyondALimit) {
  for (const bool solid : {false, true}) {
    const Scene scene = solid ? limited_solid(false) : cloth_scene("arap", true, 4);
    Method method = element_method();
    TestedExecutor executor;
    OnExecutor there(executor, scene, method, step_frame(scene));
    there.linearise(strained(scene));
    Positions beyond = scene.x0, nowhere = scene.x0;
    beyond.row(0) *= 1.6;
    nowhere(1, 7) = std::nan("");
    EXPECT_FALSE(there.evaluate(beyond));
    beyond.row(0) *= -1;  // inverted: stretches are sizes
    EXPECT_FALSE(there.evaluate(beyond));
    EXPECT_FALSE(there.evaluate(nowhere));
    EXPECT_TRUE(there.evaluate(strained(scene)));
    method.limit.literal = true;  // is read at every call
    EXPECT_TRUE(there.evaluate(beyond));
  }
}

/// What was measured of a refused trial is not taken for the iterate, and what was measured of an accepted one is.
TEST(ExecutorTerms, MeasureALimitWhereItIsAsked) {
  const Scene scene = cloth_scene("arap", false);
  for (const bool elastic : {false, true}) {
    Method method = element_method();
    if (elastic) method.limit_stiffness = elastic_limit();
    TestedExecutor executor;
    OnExecutor there(executor, scene, method, step_frame(scene)),
        fresh(executor, scene, method, step_frame(scene));
    const Positions x = strained(scene), to = strained(scene, 0.009);
    const auto matrix_of = [](OnExecutor& on) {
      on.fill(TermSet::all(), {});
      return on.matrix();
    };
    there.linearise(x);
    const Eigen::MatrixXd matrix = matrix_of(there);
    const double stretch = there.report().max_stretch.value;
    ASSERT_TRUE(there.evaluate(to));
    EXPECT_EQ(there.report().max_stretch.value, stretch);
    ASSERT_TRUE(there.evaluate(to));
    EXPECT_EQ(matrix_of(there), matrix);
    ASSERT_TRUE(there.evaluate(to));
    there.accept();
    EXPECT_NE(there.report().max_stretch.value, stretch);
    there.linearise(to);
    fresh.linearise(x), fresh.linearise(to);
    EXPECT_EQ(there.gradient(), fresh.gradient());
    EXPECT_EQ(matrix_of(there), matrix_of(fresh));
    EXPECT_NE(there.matrix(), matrix);
  }
}

TEST(ExecutorTerms, LeaveALimitOutWhereNothingIsLimited) {
  const Scene scene = cloth_scene("arap", true, 4);
  Method method = element_method();
  method.strain_limit = false;
  TestedExecutor executor;
  OnExecutor there(executor, scene, method, step_frame(scene));
  there.linearise(scene.x0);
  EXPECT_EQ(there.bound(wave(scene, 10)), 1);
  EXPECT_FALSE(there.report().max_stretch.finite());
}

TEST(ExecutorTerms, RefuseByItsNameWhatHasNoKernel) {
  const Scene scene = cloth_scene("arap", false, 3);
  TestedExecutor executor;
  const auto refused = [&](const Method& method) {
    try {
      const OnExecutor there(executor, scene, method);
    } catch (const ConfigError& error) {
      return error.violations()[0];
    }
    ADD_FAILURE() << "not refused";
    return Violation{};
  };
  Method shape = element_method(), policy = element_method();
  shape.limit.shape.name = "mine", shape.limit.shape.launches = nullptr;
  policy.limit_stiffness = std::make_unique<HostPolicy>();
  EXPECT_EQ(refused(shape).found, "mine");
  EXPECT_EQ(refused(policy).where, "stiffness_policy/name");
  EXPECT_EQ(refused(policy).found, "host_only");
  EXPECT_EQ(executor.memory().bytes(), 0u);
}

TEST(ExecutorTerms, AreCountedWithoutMemory) {
  const Scene scene = cloth_scene("arap", false, 8);
  const Method method = element_method();
  TestedExecutor host;
  exec::CountingExecutor counting;
  const OnExecutor there(host, scene, method), counted(counting, scene, method);
  EXPECT_GT(host.memory().bytes(), 10000u);
  EXPECT_EQ(host.memory().by_name(), counting.memory().by_name());
  for (const char* name : {"element matrix values", "limit stiffness", "hinge vertices"})
    EXPECT_EQ(host.memory().by_name().count(name), 1u) << name;
}

/// A vertex with a NaN coordinate; two neighbours of a rod that coincide.
TEST(ExecutorTerms, NameTheFirstElementThatIsNoNumber) {
  const auto broken = [](const Scene& scene, const Positions& x) {
    const Method method = element_method();
    TestedExecutor executor;
    OnExecutor there(executor, scene, method, step_frame(scene));
    there.linearise(x);
    return there.first_not_finite();
  };
  const Scene cloth = cloth_scene("arap", true, 4), bent = rods();
  for (const int v : {5, 15}) {  // 15: of the last triangle alone
    Positions x = strained(cloth);
    x(0, v) = std::nan("");
    const auto [membrane, element] = broken(cloth, x);
    EXPECT_EQ(membrane, "membrane");
    const auto& triangle = cloth.membranes[0].triangles[static_cast<std::size_t>(element)];
    EXPECT_NE(std::find(triangle.begin(), triangle.end(), v), triangle.end());
  }
  Positions y = bent.x0;
  y.col(9) = y.col(8);
  const auto [rod, corner] = broken(bent, y);
  ASSERT_EQ(rod, "rods");
  EXPECT_EQ(bent.rods.corners[static_cast<std::size_t>(corner)][2], 9);
}

}  // namespace
}  // namespace bb::exec_terms_test
