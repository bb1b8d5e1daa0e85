// Cusps of elements: where an element says it is at one its energy falls, to first order, along a direction and along its opposite,
// though its gradient may be 0; a hair away it shows nothing of the kind.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/energy/cloth_spring.hpp"
#include "core/energy/hinge.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/energy/rod_bend.hpp"
#include "core/energy/solid_model.hpp"
#include "core/energy/spring.hpp"
#include "tests/energy/energy_cases.hpp"

namespace bb::test::cusp_test {
namespace {

using Value = std::function<Long(const VecXl&)>;
using IsCusp = std::function<bool(const VecXd&)>;

/// E falls by more than a part of the step h on both sides of x along some seeded direction. h is small enough for first order.
bool falls_both_ways(const Value& value, const VecXd& x) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const Long h = 1e-7L, here = value(x.cast<Long>());
  for (int k = 0; k < 50; ++k) {
    VecXl way(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) way[i] = normal(random);
    const VecXl there = x.cast<Long>() + h * way, back = x.cast<Long>() - h * way;
    if (value(there) < here - 1e-3L * h && value(back) < here - 1e-3L * h) return true;
  }
  return false;
}

void expect_cusp(const Value& value, const IsCusp& is_cusp, const VecXd& at, const std::string& what) {
  SCOPED_TRACE(what);
  EXPECT_TRUE(is_cusp(at));
  EXPECT_TRUE(falls_both_ways(value, at));
}
void expect_smooth(const Value& value, const IsCusp& is_cusp, const VecXd& at, const std::string& what) {
  SCOPED_TRACE(what);
  EXPECT_FALSE(is_cusp(at));
  EXPECT_FALSE(falls_both_ways(value, at));
}

VecXd points(std::initializer_list<double> numbers) {
  VecXd out(static_cast<Eigen::Index>(numbers.size()));
  Eigen::Index i = 0;
  for (const double number : numbers) out[i++] = number;
  return out;
}

TEST(Cusps, springs_whose_ends_coincide) {
  const VecXd together = points({0.3, 0.1, 0.2, 0.3, 0.1, 0.2}),
              apart = points({0.3, 0.1, 0.2, 0.3, 0.1, 0.25});
  for (const double rest : {0.1, 0.0}) {
    const auto value = [&](const VecXl& x) { return spring_value<Long>(Points<Long, 2>(x).x, 5, rest); };
    const auto is_cusp = [&](const VecXd& x) {
      return spring_is_cusp<double>(Points<double, 2>(x).x, 5, rest);
    };
    if (rest > 0) expect_cusp(value, is_cusp, together, "spring");
    if (rest == 0) expect_smooth(value, is_cusp, together, "spring of no length");
    expect_smooth(value, is_cusp, apart, "spring apart");
  }
  EXPECT_FALSE(spring_is_cusp<double>(Points<double, 2>(together).x, 0, 0.1));
}

TEST(Cusps, springs_of_cloth_that_resist_compression) {
  const VecXd together = points({0, 0, 0, 0, 0, 0});
  for (const double compression : {3.0, 0.0}) {
    for (const double growing : {2.0, 0.0}) {
      const SpringLaw<double> law{4, 0, compression, growing, 10};
      const SpringLaw<Long> exact{4, 0, compression, growing, 10};
      const auto value = [&](const VecXl& x) {
        return cloth_spring_value<Long>(Points<Long, 2>(x).x, 0.1L, exact);
      };
      const auto is_cusp = [&](const VecXd& x) {
        return cloth_spring_is_cusp<double>(Points<double, 2>(x).x, 0.1, law);
      };
      const bool resists = compression + growing > 0;
      (resists ? expect_cusp : expect_smooth)(value, is_cusp, together, "cloth spring");
    }
  }
}

TEST(Cusps, rods_folded_back_or_straight_where_they_are_curved_at_rest) {
  const double pi = std::acos(-1.0);
  const VecXd folded = points({0, 0, 0, 1, 0, 0, 0.25, 0, 0}),
              straight = points({0, 0, 0, 1, 0, 0, 1.5, 0, 0}),
              bent = points({0, 0, 0, 1, 0, 0, 1.2, 0.7, 0});
  struct Case {
    double rest;
    VecXd at;
    bool cusp;
  };
  for (const Case& c : {Case{0, folded, true},
                        {1, folded, true},
                        {pi, folded, false},
                        {0, straight, false},
                        {1, straight, true},
                        {0, bent, false},
                        {1, bent, false}}) {
    const auto value = [&](const VecXl& x) { return rod_bend_value<Long>(Points<Long, 3>(x).x, 2, c.rest); };
    const auto is_cusp = [&](const VecXd& x) {
      return rod_bend_is_cusp<double>(Points<double, 3>(x).x, 2, c.rest);
    };
    (c.cusp ? expect_cusp : expect_smooth)(value, is_cusp, c.at, "rod at rest " + std::to_string(c.rest));
  }
}

TEST(Cusps, hinges_half_a_turn_from_rest) {
  const VecXd shut = points({0, 0, 0, 1, 0, 0, 0.4, 1, 0, 0.6, 0.8, 0}),
              flat = points({0, 0, 0, 1, 0, 0, 0.4, 1, 0, 0.6, -0.8, 0});
  for (const auto& [at, rest, cusp] : {std::tuple{shut, 0.0, true}, {flat, 0.0, false}, {shut, 1.0, false}}) {
    const auto value = [&, r = rest](const VecXl& x) {
      return hinge_energy<Long>(Points<Long, 4>(x).x, Long(2), Long(r)).energy;
    };
    const auto is_cusp = [&, r = rest](const VecXd& x) {
      return hinge_is_cusp<double>(Points<double, 4>(x).x, 2, r);
    };
    (cusp ? expect_cusp : expect_smooth)(value, is_cusp, at, "hinge at rest " + std::to_string(rest));
  }
}

/// Triangles that are squeezed to a line, and to a point.
TEST(Cusps, membranes_without_area_where_their_model_has_one) {
  const VecXd rest = points({0, 0, 0, 1, 0, 0, 0, 1, 0}), line = points({0, 0, 0, 1.2, 0, 0, 0.5, 0, 0}),
              column = points({0, 0, 0, 0, 0, 0, 0, 1.1, 0}),
              plain = points({0, 0, 0, 1.2, 0.1, 0, 0.3, 0.9, 0.4});
  int cusps = 0;
  for_each_model([&]<class Model>(std::string_view name) {
    const auto exact = triangle_rest<Long>(Points<Long, 3>(rest).x, Vec<Long, 3>(1, 0, 0));
    const auto shape = triangle_rest<double>(Points<double, 3>(rest).x, Vec3d(1, 0, 0));
    const MembraneModel<double>& model = *membrane_models<double>().find(name);
    const Value value = [&](const VecXl& x) {
      return membrane_value<Model, 3, Long>(exact, Points<Long, 3>(x).x, 3, 2);
    };
    const IsCusp is_cusp = [&](const VecXd& x) { return model.is_cusp(shape, Points<double, 3>(x).x, 3, 2); };
    expect_smooth(value, is_cusp, plain, std::string(name) + " plain");
    const bool smooth = name == "stvk";
    for (const VecXd& at : {line, column}) {
      const bool cusp = !smooth && (name != "baraff_witkin" || &at == &column || at == column);
      (cusp ? expect_cusp : expect_smooth)(value, is_cusp, at,
                                           std::string(name) + (at == line ? " line" : " column"));
      cusps += cusp;
    }
  });
  EXPECT_EQ(cusps, 7);
}

/// Tetrahedra turned inside out, the smallest two singular values of one size.
TEST(Cusps, solids_where_the_sum_of_the_smallest_singular_values_is_0) {
  const VecXd rest = points({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  const VecXd mirrored = points({0, 0, 0, 1.2, 0, 0, 0, 0.7, 0, 0, 0, -0.7}),
              inverted = points({0, 0, 0, 1.2, 0, 0, 0, 0.9, 0, 0, 0, -0.7});
  for (const SolidModel<double>& model : solid_models<double>()) {
    const auto shape = tetrahedron_rest<double>(Points<double, 4>(rest).x);
    const auto is_cusp = [&](const VecXd& x) { return model.is_cusp(shape, Points<double, 4>(x).x, 3, 2); };
    const Value value = [&](const VecXl& x) -> Long {
      return model.value(shape, Points<double, 4>(x).x, 3, 2);
    };
    const bool cusp = model.name == "corotational" || model.name == "arap";
    (cusp ? expect_cusp : expect_smooth)(value, is_cusp, mirrored, std::string(model.name));
    expect_smooth(value, is_cusp, inverted, std::string(model.name) + " inverted");
  }
}

}  // namespace
}  // namespace bb::test::cusp_test
