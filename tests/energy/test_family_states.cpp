// Families: rest shapes that shrink over time and creep at once, and which elements of a state have a cusp.
#include <gtest/gtest.h>

#include "core/energy/hinge.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/energy/solid_model.hpp"
#include "tests/energy/host_family.hpp"
#include "tests/energy/strip.hpp"

namespace bb::test::family_states_test {
namespace {

constexpr double at_half = 0.5;  // s, when the factor of halving() is 1/2

/// A factor: 1 at the start, 1/2 at half a second.
Scene halving(const Positions& rest) { return scaled_rest(rest, {{0, 1}, {at_half, 0.5}}); }

/// Elements whose rest shapes have half the size creep in a state of half the size as the whole ones in the whole state; both bits
/// are the same, since the factor is a power of two. Energies go with the square of the size.
void expect_creeps_as_the_whole(const HostFamily::Make& whole_of, const HostFamily::Make& half_of,
                                const Positions& x) {
  const double dt = 0.02;
  const Positions half_x = 0.5 * x;
  HostFamily whole(whole_of), half(half_of);
  const std::vector<double> at_start = whole.memory(), stretched = whole.values(x);
  half->change_step({.t_end = at_half});
  whole.step(x, dt, 2);
  half.step(half_x, dt, 2, at_half);
  const std::vector<double> crept = whole.memory();
  ASSERT_EQ(crept.size(), at_start.size());
  for (std::size_t i = 0; i + 3 < crept.size(); i += 4) {
    EXPECT_FALSE(std::equal(&crept[i], &crept[i] + 4, &at_start[i])) << i;
  }
  EXPECT_EQ(half.memory(), crept);
  const std::vector<double> of_whole = whole.values(x), of_half = half.values(half_x);
  for (std::size_t e = 0; e < of_whole.size(); ++e) {
    EXPECT_EQ(of_half[e], 0.25 * of_whole[e]);
    EXPECT_LT(of_whole[e], stretched[e]);  // what creeps gives way
    EXPECT_GT(of_whole[e], 0);
  }
}

TEST(FamilyStates, ClothSpringsShrinkAndCreepAtOnce) {
  const Strip strip(40);
  const std::size_t n = strip.triangles.size();
  ClothSpringPart part;
  for (const auto& t : strip.triangles) {
    part.pairs.push_back({t[0], t[1]});
    part.rest_length.push_back(0.7 * (strip.deformed.col(t[0]) - strip.deformed.col(t[1])).norm());
  }
  part.tension.assign(n, 3), part.tension_growing.assign(n, 2), part.compression.assign(n, 1);
  part.compression_growing.assign(n, 0.5), part.exponent.assign(n, 4), part.softening.assign(n, 0);
  part.yield.assign(n, 0.02), part.creep.assign(n, 5);
  const Scene shrunk = halving(strip.rest);
  const auto half = [&](const FamilyPlace& place) {
    return cloth_spring_family(place, part, MovingRest(shrunk));
  };
  expect_creeps_as_the_whole([&](const FamilyPlace& place) { return cloth_spring_family(place, part); }, half,
                             strip.deformed);
}

TEST(FamilyStates, MembranesShrinkAndCreepAtOnce) {
  const Strip strip(40);
  const std::size_t n = strip.triangles.size();
  MembranePart part;
  part.triangles = strip.triangles;
  part.lame_mu.assign(n, 2), part.lame_lambda.assign(n, 1);
  part.yield.assign(n, 0.01), part.creep.assign(n, 5);
  for (const auto& model : membrane_models<double>()) {
    SCOPED_TRACE(model.name);
    part.model = model.name;
    const Scene shrunk = halving(strip.rest);
    const auto half = [&](const FamilyPlace& place) {
      return membrane_family(place, part, shrunk.rest, false, MovingRest(shrunk));
    };
    const Positions x = 1.2 * strip.deformed;
    expect_creeps_as_the_whole(membranes_of(part, strip.rest), half, x);
  }
}

TEST(FamilyStates, ColumnsOfClothSpringsHaveOneNumberAnElement) {
  const std::vector<double> one = {1};
  const ClothSpringPart good = {{{0, 1}}, one, one, one, one, one, one, one, one, one};
  const auto made = [](const ClothSpringPart& part) {
    return HostFamily([&](const FamilyPlace& place) { return cloth_spring_family(place, part); }).size();
  };
  EXPECT_EQ(made(good), 1U);
  int columns = 0;
  for (const auto column :
       {&ClothSpringPart::rest_length, &ClothSpringPart::tension, &ClothSpringPart::tension_growing,
        &ClothSpringPart::compression, &ClothSpringPart::compression_growing, &ClothSpringPart::exponent,
        &ClothSpringPart::softening, &ClothSpringPart::yield, &ClothSpringPart::creep}) {
    for (const std::vector<double>& wrong : {std::vector<double>{}, std::vector<double>{1, 1}}) {
      ClothSpringPart part = good;
      part.*column = wrong;
      EXPECT_THROW(made(part), ConfigError) << columns;
    }
    ++columns;
  }
  EXPECT_EQ(columns, 9);
}

/// Elements that the function of one element names; all of them, as the family says.
template <class Asked>
std::size_t expect_cusps(const HostFamily& family, const Positions& x, const Asked& asked) {
  std::vector<std::size_t> expected;
  for (std::size_t e = 0; e < family.size(); ++e) {
    if (asked(e)) expected.push_back(e);
  }
  EXPECT_EQ(family.cusps(x), expected);
  return expected.size();
}

/// Triangle 3 as a point, 10 as a segment, 17 turned over in the plane, 24 folded onto one edge.
Positions bad_triangles(const Strip& strip, const std::vector<std::array<int, 3>>& lone) {
  Positions x(3, static_cast<Eigen::Index>(3 * lone.size()));
  for (std::size_t e = 0; e < lone.size(); ++e) {
    for (int k = 0; k < 3; ++k) {
      x.col(lone[e][static_cast<std::size_t>(k)]) =
          strip.rest.col(strip.triangles[e][static_cast<std::size_t>(k)]);
    }
  }
  const auto at = [&x](int e, int k) { return x.col(3 * e + k); };
  at(3, 1) = at(3, 2) = at(3, 0);
  at(10, 2) = 0.5 * (at(10, 0) + at(10, 1));
  at(17, 1).swap(at(17, 2));
  at(24, 2) = at(24, 1);
  return x;
}

TEST(FamilyStates, MembranesNameTheTrianglesAtACusp) {
  const Strip strip(40);
  const std::size_t n = strip.triangles.size();
  MembranePart part;
  Positions rest(3, static_cast<Eigen::Index>(3 * n));
  for (std::size_t e = 0; e < n; ++e) {
    const int first = static_cast<int>(3 * e);
    part.triangles.push_back({first, first + 1, first + 2});
    for (int k = 0; k < 3; ++k)
      rest.col(first + k) = strip.rest.col(strip.triangles[e][static_cast<std::size_t>(k)]);
  }
  part.lame_mu.assign(n, 2), part.lame_lambda.assign(n, 1);
  const Positions x = bad_triangles(strip, part.triangles);
  std::size_t found = 0;
  for (const auto& model : membrane_models<double>()) {
    part.model = model.name;
    for (const bool planar : {false, true}) {
      SCOPED_TRACE(part.model + (planar ? " in the plane" : ""));
      found += expect_cusps(HostFamily(membranes_of(part, rest, planar)), x, [&](std::size_t e) {
        const int v = static_cast<int>(3 * e);
        const Vec3d at_rest[3] = {rest.col(v), rest.col(v + 1), rest.col(v + 2)};
        const Vec3d here[3] = {x.col(v), x.col(v + 1), x.col(v + 2)};
        const Vec3d warp = at_rest[1] - at_rest[0];
        return planar ? model.is_cusp_planar(planar_triangle_rest<double>(at_rest, warp), here, 2, 1)
                      : model.is_cusp(triangle_rest<double>(at_rest, warp), here, 2, 1);
      });
    }
  }
  EXPECT_GT(found, 2U);
}

TEST(FamilyStates, HingesNameThoseThatAreFoldedHalfATurn) {
  const Positions flat = (Positions(3, 4) << 0, 1, 0.5, 0.5, 0, 0, 1, -1, 0, 0, 0, 0).finished();
  Positions folded = flat;
  folded.col(3) = flat.col(2);
  for (const double growing : {0.0, 2.0}) {
    SCOPED_TRACE(growing);
    HingePart part;
    part.hinges = {{0, 1, 2, 3}};
    part.stiffness = {growing > 0 ? 0.0 : 3.0}, part.rest_angle = {0};
    part.exponential = {growing}, part.exponent = {1.5}, part.yield = {0}, part.creep = {0};
    const HostFamily family(hinges_of(part));
    EXPECT_EQ(family.cusps(folded), std::vector<std::size_t>{0});
    EXPECT_EQ(family.cusps(flat), std::vector<std::size_t>{});
  }
}

}  // namespace
}  // namespace bb::test::family_states_test
