// Loads (inertia, weight, soft pins, drag of the air, a pressure) against closed forms in long double, with the same bits in every order of the host's
// executor: energies, gradients, Hessians, changes of states, in steps whose time, length and start change.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/energy/vertex_loads.hpp"
#include "core/math/lower_blocks.hpp"
#include "tests/energy/host_family.hpp"
#include "tests/energy/strip.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test::load_families_test {
namespace {

using Real = long double;
using RVec = Vec<Real, 3>;
using Reals = Eigen::Matrix<Real, 3, Eigen::Dynamic>;

/// A strip of more vertices than a block has threads, with every load, and prescribed vertices without mass.
Scene loaded_scene() {
  static const Strip strip(150);
  Scene scene;
  scene.rest = scene.x0 = strip.rest;
  const auto n = static_cast<std::size_t>(scene.n_vertices());
  for (std::size_t v = 0; v < n; ++v)
    scene.mass.push_back(v % 7 == 3 ? 0 : 0.1 + 0.01 * static_cast<double>(v));
  scene.body.assign(n, 0);
  for (std::size_t v = 40; v < n; ++v) scene.body[v] = 1;
  scene.bodies = {{"first", 0, 40}, {"second", 40, static_cast<int>(n) - 40}};
  scene.gravity_keys = {{0, Vec3d(0, 0, -8)}, {1, Vec3d(2, 0, -12)}};
  scene.surface_triangles = strip.triangles;
  scene.air = {0.7, 0.2, Vec3d::Zero(), {{0, Vec3d(1, -2, 0.5)}, {1, Vec3d(0, 4, 0)}}};
  scene.motions.resize(2);
  scene.motions[0].velocity = Vec3d(0.2, -0.1, 0.4);
  scene.pulls.push_back({{5, 9, 120}, 0, 40, {{0, 1}, {1, 0.2}}, {}});
  scene.pulls.push_back({{6, 7}, 1, 3, {}, {0.29, 2}});  // begins between middle and end of the first step
  scene.inflation.triangles = strip.triangles;
  for (std::size_t e = 0; e < strip.triangles.size(); ++e) {
    scene.inflation.pressure.push_back(e % 3 == 0 ? -1 : 1 + 0.1 * static_cast<double>(e));
    scene.inflation.keys.push_back(e % 3 == 0 ? 0 : -1);
  }
  scene.inflation.key_lists = {{{0, 20}, {1, 40}}};
  return scene;
}

/// A step with the columns that it points to.
struct Step {
  Positions x_n, x_tilde;
  double dt, c, load_factor, t_end;
  FamilyStep view() const { return {x_n.data(), x_tilde.data(), dt, c, load_factor, t_end, false}; }
};

Positions moved(const Positions& x, double size, double phase) {
  Positions out = x;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    out.data()[i] += size * std::sin(1.7 * static_cast<double>(i) + phase);
  return out;
}

RVec real(const Vec3d& v) { return v.cast<Real>(); }
/// Of two keys at 0 and 1 s.
template <class Value>
auto between(const Value& first, const Value& last, Real t) {
  return (first + t * (last - first)).eval();
}

/// Energy (J) of element e whose vertices are at p, written down once more.
using Energy = Real (*)(const Scene&, const Step&, std::size_t e, std::span<const int> v, const RVec* p);

Real inertia(const Scene& scene, const Step& step, std::size_t e, std::span<const int>, const RVec* p) {
  if (step.c == 0) return 0;
  const Real h = step.dt;
  return scene.mass[e] * (p[0] - real(step.x_tilde.col(static_cast<int>(e)))).squaredNorm() /
         (2 * step.c * h * h);
}
Real weight(const Scene& scene, const Step& step, std::size_t e, std::span<const int>, const RVec* p) {
  const RVec g = between(real(scene.gravity_keys[0].value), real(scene.gravity_keys[1].value), step.t_end);
  return -Real(step.load_factor) * scene.mass[e] * g.dot(p[0] - real(step.x_n.col(static_cast<int>(e))));
}
Real pull(const Scene& scene, const Step& step, std::size_t e, std::span<const int> v, const RVec* p) {
  const bool first = e < 3;
  const Real t = step.t_end, middle = t - Real(step.dt) / 2;
  const RVec way = first ? RVec(t * real(Vec3d(0.2, -0.1, 0.4))) : RVec::Zero();
  const Real k = first ? 40 * (1 - Real(0.8) * t) : middle > 0.29 ? 3 : 0;
  return k / 2 * (p[0] - real(scene.x0.col(v[0])) - way).squaredNorm();
}
Real air_drag(const Scene& scene, const Step& step, std::size_t, std::span<const int> v, const RVec* p) {
  const Real h = step.dt;
  const RVec wind =
      between(real(scene.air.wind_keys[0].value), real(scene.air.wind_keys[1].value), step.t_end);
  const RVec u = p[0] - real(step.x_n.col(v[0])) - h * wind;
  Real out = 0;
  for (const auto& t : scene.surface_triangles) {
    if (t[0] != v[0] && t[1] != v[0] && t[2] != v[0]) continue;
    const RVec a = real(step.x_n.col(t[0])), b = real(step.x_n.col(t[1])), c = real(step.x_n.col(t[2]));
    const RVec twice = (b - a).cross(c - a);
    const Real along = u.dot(twice.normalized());
    out += twice.norm() / 6 *
           (Real(scene.air.normal) * along * along +
            Real(scene.air.tangential) * (u.squaredNorm() - along * along));
  }
  return out / (2 * h);
}
Real inflation(const Scene& scene, const Step& step, std::size_t e, std::span<const int> v, const RVec* p) {
  const Body& body = scene.bodies[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(v[0])])];
  RVec centre = RVec::Zero();
  for (int i = 0; i < body.n_vertices; ++i)
    centre += real(step.x_n.col(body.first_vertex + i)) / body.n_vertices;
  const Real given = scene.inflation.pressure[e];
  const Real pressure = scene.inflation.keys[e] < 0 ? given : given * (20 + 20 * Real(step.t_end));
  return -pressure * (p[0] - centre).dot((p[1] - centre).cross(p[2] - centre)) / 6;
}

struct Load {
  const char* name;
  MadeFamily (*make)(const FamilyPlace&, const Scene&);
  Energy energy;
  bool on_vertices, closed;
};
const Load loads[] = {{"inertia", inertia_family, inertia, true, true},
                      {"weight", weight_family, weight, true, true},
                      {"pull", pull_family, pull, false, true},
                      {"air drag", air_drag_family, air_drag, false, true},
                      {"inflation", inflation_family, inflation, false, false}};

HostFamily::Make on(const Load& load, const Scene& scene) {
  return [&load, &scene](const FamilyPlace& place) { return load.make(place, scene); };
}

/// One element of a load at x. Its energy is of second degree in every coordinate, so differences of any size are exact.
struct Exact {
  const Load& load;
  const Scene& scene;
  const Step& step;
  std::size_t e;
  std::span<const int> v;
  std::vector<RVec> p;

  Exact(const Load& of, const Scene& all, const Step& in, const ElementFamily& family, std::size_t element,
        const Positions& x)
      : load(of), scene(all), step(in), e(element) {
    const auto w = static_cast<std::size_t>(family.width());
    v = family.vertices().subspan(w * e, w);
    for (const int vertex : v) p.push_back(real(x.col(vertex)));
  }
  Real energy() const { return load.energy(scene, step, e, v, p.data()); }
  Real moved_by(std::size_t i, Real a, std::size_t j = 0, Real b = 0) const {
    std::vector<RVec> to = p;
    to[i / 3][static_cast<Eigen::Index>(i % 3)] += a;
    to[j / 3][static_cast<Eigen::Index>(j % 3)] += b;
    return load.energy(scene, step, e, v, to.data());
  }
  Real gradient(std::size_t i) const { return (moved_by(i, 1) - moved_by(i, -1)) / 2; }
  Real hessian(std::size_t i, std::size_t j) const {
    return (moved_by(i, 1, j, 1) - moved_by(i, 1, j, -1) - moved_by(i, -1, j, 1) + moved_by(i, -1, j, -1)) /
           4;
  }
};

/// Energies, gradients and exact Hessians at x against the closed form. How many numbers other than 0 were compared.
std::size_t expect_exact(const Load& load, const Scene& scene, const Step& step, const HostFamily& family,
                         const ElementFamily& of, const Positions& x) {
  constexpr double tolerance = 1e-12;
  LocalTerms out;
  family.derivatives(x, Projection::none, out);
  EXPECT_EQ(family.values(x), out.energy);
  EXPECT_EQ(out.hess.empty(), load.energy == weight);
  std::size_t compared = 0;
  const auto near = [&](double found, Real exact, Real size) {
    EXPECT_LE(std::abs(Real(found) - exact), tolerance * size) << load.name;
    compared += exact != 0;
  };
  const auto n = 3 * static_cast<std::size_t>(of.width());
  for (std::size_t e = 0; e < family.size(); ++e) {
    const Exact exact(load, scene, step, of, e, x);
    near(out.energy[e], exact.energy(), std::abs(exact.energy()) + Real(1e-3));
    if (e > 2 && e % 5 != 0) continue;
    Real largest = 1e-3;
    for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(exact.gradient(i)));
    for (std::size_t i = 0; i < n; ++i) near(out.grad[n * e + i], exact.gradient(i), largest);
    if (out.hess.empty()) continue;
    const Eigen::MatrixXd hess = from_lower_blocks(&out.hess[n_lower_numbers(n / 3) * e], of.width());
    Real steepest = 1e-3;
    for (std::size_t i = 0; i < n; ++i) steepest = std::max(steepest, std::abs(exact.hessian(i, i)));
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        near(hess(static_cast<int>(i), static_cast<int>(j)), exact.hessian(i, j),
             std::max(steepest, largest));
      }
    }
  }
  return compared;
}

struct Steps {
  Scene scene = loaded_scene();
  Step first{moved(scene.x0, 0.01, 0.2), moved(scene.x0, 0.02, 0.9), 0.05, 0.7, 0.9, 0.3};
  Step later{first.x_n, moved(scene.x0, 0.03, 1.4), 0.02, 0.7, 0.4, 0.6};
  Step next{moved(scene.x0, 0.02, 2.2), moved(scene.x0, 0.02, 0.1), 0.04, 0.5, 1, 0.8};
  Step still{first.x_n, first.x_tilde, 0.05, 0, 1, 0.3};  // quasi-static
  Positions x = moved(scene.x0, 0.05, 0.4);

  void go_through(ElementFamily& family) const {
    family.begin_step(next.view());
    family.begin_step(first.view());
    family.change_step(later.view());
  }
};

TEST(LoadFamilies, have_the_closed_form_of_every_step) {
  const Steps steps;
  for (const Load& load : loads) {
    SCOPED_TRACE(load.name);
    HostFamily family(on(load, steps.scene));
    EXPECT_EQ(family->on_vertices(), load.on_vertices);
    const auto expect = [&](const Step& step, std::size_t least) {
      EXPECT_GE(expect_exact(load, steps.scene, step, family, *family, steps.x), least);
    };
    family->begin_step(steps.first.view());
    expect(steps.first, 10);
    family->change_step(steps.later.view());
    expect(steps.later, 10);
    family->begin_step(steps.next.view());
    expect(steps.next, 10);
    family->begin_step(steps.still.view());
    expect(steps.still, load.energy == inertia ? 0 : 10);
  }
}

/// What acts within a span acts in the whole step whose middle is in it; where no step is made, in the one that would begin.
TEST(LoadFamilies, pull_where_the_middle_of_their_step_is_in_their_span) {
  const Steps steps;
  HostFamily pulls(on(loads[2], steps.scene));
  const auto acts = [&](double t_end, double dt, bool at_start) {
    FamilyStep step = steps.first.view();
    step.t_end = t_end, step.dt = dt, step.at_start = at_start;
    pulls->begin_step(step);
    const std::vector<double> energy = pulls.values(steps.x);
    EXPECT_GT(energy[0], 0);
    EXPECT_EQ(energy[3] > 0, energy[4] > 0);
    return energy[3] > 0;
  };
  // the span is 0.29 to 2
  EXPECT_TRUE(acts(0.32, 0.05, false));
  EXPECT_FALSE(acts(0.31, 0.05, false));
  EXPECT_TRUE(acts(0.29, 0.05, true));
  EXPECT_TRUE(acts(0.27, 0.05, true));
  EXPECT_FALSE(acts(0.26, 0.05, true));
  EXPECT_FALSE(acts(2, 0.05, true));
  EXPECT_TRUE(acts(2, 0.05, false));
}

/// Weights are those of the step's own length and factor, whichever of them has changed.
TEST(LoadFamilies, weigh_inertia_by_the_length_and_the_factor_of_each_step) {
  Steps steps;
  HostFamily family(on(loads[0], steps.scene));
  for (const auto& [dt, c] : {std::pair{0.05, 0.7}, {0.02, 0.7}, {0.02, 0.3}, {0.02, 0.0}, {0.05, 0.7}}) {
    steps.first.dt = dt, steps.first.c = c;
    family->change_step(steps.first.view());
    EXPECT_GE(expect_exact(loads[0], steps.scene, steps.first, family, *family, steps.x), c == 0 ? 0 : 10);
  }
}

/// Columns of pieces: tests/executor/test_family_columns.cpp.
TEST(LoadFamilies, have_the_same_bits_on_every_executor) {
  const Steps steps;
  for (const Load& load : loads) {
    SCOPED_TRACE(load.name);
    LocalTerms expected, found;
    HostFamily plain(on(load, steps.scene));
    steps.go_through(*plain);
    plain.derivatives(steps.x, Projection::psd, expected);
    EXPECT_GT(*std::max_element(expected.grad.begin(), expected.grad.end()), 1e-3);
    const auto expect_same = [&](HostFamily& family) {
      steps.go_through(*family);
      family.derivatives(steps.x, Projection::psd, found);
      EXPECT_EQ(found.energy, expected.energy);
      EXPECT_EQ(found.grad, expected.grad);
      EXPECT_EQ(found.hess, expected.hess);
      if (load.on_vertices) {
        EXPECT_THROW(family->gradients({0, 1}, nullptr, nullptr, nullptr), std::logic_error);
        EXPECT_THROW(family->hessians({0, 1}, {}, nullptr, nullptr), std::logic_error);
      }
    };
    {
      const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
      HostFamily one(on(load, steps.scene));
      expect_same(one);
    }
    for (const exec::Order order :
         {exec::Order::threads, exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
      HostFamily family(on(load, steps.scene), Precision::full, order);
      expect_same(family);
    }
  }
}

/// Change and magnitude of all elements from x to `to`, as an array of pairs (stride 2) or as columns.
std::vector<ValueChange<double>> changes(HostFamily& family, const Positions& x, const Positions& to) {
  const std::size_t n = family.size();
  std::vector<ValueChange<double>> out(n);
  std::vector<double> columns(2 * n);
  family->changes(x.data(), to.data(), &out[0].change, &out[0].magnitude, 2);
  family->changes(x.data(), to.data(), columns.data(), columns.data() + n, 1);
  for (std::size_t e = 0; e < n; ++e) {
    EXPECT_EQ(columns[e], out[e].change);
    EXPECT_EQ(columns[n + e], out[e].magnitude);
  }
  return out;
}

/// Also of motions so small that both energies are equal to their last place.
TEST(LoadFamilies, change_as_their_closed_forms_do_however_small_the_motion_is) {
  const Steps steps;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  for (const Load& load : loads) {
    SCOPED_TRACE(load.name);
    HostFamily family(on(load, steps.scene));
    EXPECT_EQ(family->has_changes(), load.closed);
    if (!load.closed) continue;
    family->begin_step(steps.first.view());
    std::size_t changed = 0;
    for (const double size : {1e-2, 1e-6, 1e-10}) {
      const Positions to = moved(steps.x, size, 3);
      const std::vector<ValueChange<double>> found = changes(family, steps.x, to);
      for (std::size_t e = 0; e < found.size(); ++e) {
        const Real before = Exact(load, steps.scene, steps.first, *family, e, steps.x).energy(),
                   after = Exact(load, steps.scene, steps.first, *family, e, to).energy();
        // rounding of the step, of the force that it meets, and of long double in the difference
        const Real force = (std::abs(before) + std::abs(after)) / Real(0.01);
        EXPECT_LE(std::abs(found[e].change - (after - before)), 64 * eps * size * force + 1e-17L * force)
            << e;
        EXPECT_GE(found[e].magnitude * (1 + 8 * eps), std::abs(found[e].change));
        const auto size_of = static_cast<double>(std::abs(before) + std::abs(after));
        if (load.energy != weight) {
          EXPECT_NEAR(found[e].magnitude, size_of, 1e-13 * size_of);
        }
        changed += found[e].change != 0;
      }
    }
    EXPECT_GT(changed, 8U);
  }
}

/// Inertia, weight and pulls are in double whatever the precision; a pressure follows it.
TEST(LoadFamilies, are_in_double_but_for_the_pressure) {
  const Steps steps;
  for (const Load& load : loads) {
    SCOPED_TRACE(load.name);
    HostFamily full(on(load, steps.scene)), single(on(load, steps.scene), Precision::single);
    full->begin_step(steps.first.view()), single->begin_step(steps.first.view());
    LocalTerms in_double, found;
    full.derivatives(steps.x, Projection::psd, in_double);
    single.derivatives(steps.x, Projection::psd, found);
    EXPECT_EQ(single.values(steps.x), found.energy);
    const bool same = load.energy != inflation;
    EXPECT_EQ(found.energy == in_double.energy, same);
    EXPECT_EQ(found.grad == in_double.grad, same);
    for (std::size_t i = 0; i < found.grad.size() && !same; ++i) {
      EXPECT_EQ(double(float(found.grad[i])), found.grad[i]);
      EXPECT_NEAR(found.grad[i], in_double.grad[i], 1e-4);
    }
  }
}

}  // namespace
}  // namespace bb::test::load_families_test
