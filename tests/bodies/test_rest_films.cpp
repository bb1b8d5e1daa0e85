// Rest shapes that are films: at any time every kind of element is the one of a body whose rest shape is that frame, and what has crept
// stays with it.
#include <gtest/gtest.h>

#include <functional>

#include "core/energy/families/element_family.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "tests/bodies/bodies.hpp"
#include "tests/energy/host_family.hpp"

namespace bb::rest_films_test {
namespace {

using namespace test;

/// A shape that changes lengths, areas, volumes and angles.
Positions curled(const Positions& x) {
  Positions out = x;
  for (Eigen::Index v = 0; v < x.cols(); ++v) {
    out.col(v) += Vec3d(0.3 * x(0, v), 0.1 * x(1, v) * x(0, v), 0.4 * x(0, v) * x(0, v) + 0.1 * x(1, v));
  }
  return out;
}

struct Kind {
  const char* name;
  BodySpec body;
};

std::vector<Kind> kinds() {
  std::vector<Kind> out;
  const auto sheet = [&out](const char* name, const std::function<void(Material&)>& change) {
    BodySpec body = cloth("body");
    body.material.model = "none";
    change(body.material);
    out.push_back({name, body});
  };
  sheet("membrane", [](Material& m) { m.model = "stable_neo_hookean"; });
  sheet("hinges", [](Material& m) { m.bending = 0.1; });
  sheet("growing hinges", [](Material& m) { m.bending = 0.1, m.bending_exponential = 0.1; });
  sheet("springs", [](Material& m) { m.springs = 10; });
  sheet("springs of cloth",
        [](Material& m) { m.cloth_tension = 10, m.cloth_compression = 5, m.cloth_shear = 2; });
  BodySpec rod = cloth("body");
  rod.mesh = helix_mesh(12, 1.5, 0.3, 0.2);
  rod.material.line_density = 0.1, rod.material.rod_bending = 1e-2;
  out.push_back({"rods", rod});
  BodySpec solid = cloth("body");
  solid.mesh = solid_box_mesh({2, 2, 2}, Vec3d(1, 1, 1));
  out.push_back({"solids", solid});
  return out;
}

using Families = std::vector<std::unique_ptr<ElementFamily>>;

Families families_of(const Scene& scene, exec::HostExecutor& executor) {
  Families out;
  for (const PartEntry& entry : part_entries()) entry.part.add_families(scene, {executor}, out);
  return out;
}

std::vector<double> energies(Families& families, const Positions& x) {
  std::vector<double> out;
  for (const auto& family : families) {
    std::vector<double> energy(static_cast<std::size_t>(family->size()));
    family->values(x.data(), energy.data());
    out.insert(out.end(), energy.begin(), energy.end());
  }
  return out;
}

BodySpec filmed(BodySpec body) {
  const Positions first = body.mesh.vertices;
  body.rest_film =
      std::make_shared<const Film>(Film({1, 2}, {first, curled(first)}, FilmInterpolation::linear));
  return body;
}

TEST(RestFilms, MakeEveryKindOfElementThatOfTheFrame) {
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const BodySpec body = filmed(kind.body);
    BodySpec later = kind.body;
    later.mesh.vertices = curled(kind.body.mesh.vertices);
    const Scene moving = scene_of({cloth("first", 5), body}), there = scene_of({cloth("first", 5), later}),
                before = scene_of({cloth("first", 5), kind.body});
    EXPECT_EQ(moving.mass, before.mass);
    exec::HostExecutor executor;
    Families of_film = families_of(moving, executor), of_frame = families_of(there, executor),
             of_start = families_of(before, executor);
    Positions x = moving.rest;
    x.row(0) *= 1.1;
    x.row(2) += 0.2 * x.row(1).cwiseProduct(x.row(0));
    const std::vector<double> start = energies(of_start, x), end = energies(of_frame, x);
    EXPECT_EQ(energies(of_film, x), start) << "to the bit, in its first frame";
    for (const auto& family : of_film) family->begin_step({.t_end = 2});
    const std::vector<double> found = energies(of_film, x);
    double difference = 0, change = 0, size = 0;
    for (std::size_t e = 0; e < end.size(); ++e) {
      difference = std::max(difference, std::abs(found[e] - end[e]));
      change = std::max(change, std::abs(end[e] - start[e]));
      size = std::max(size, std::abs(end[e]));
    }
    ASSERT_GT(change, 1e-6 * size) << "the film changes nothing";
    // the stiffness of rods is that of their lengths at the start
    if (std::string(kind.name) != "rods") {
      EXPECT_LT(difference, 1e-13 * size);
    }
    for (const auto& family : of_film) family->begin_step({.t_end = 0.5});
    EXPECT_EQ(energies(of_film, x), start) << "and back";
  }
}

TEST(RestFilms, MoveTheAnglesOfRodsButOfStraightOnes) {
  for (const bool straight : {false, true}) {
    BodySpec rod = kinds()[5].body;
    rod.material.rod_bending = 1e-2;
    if (straight) rod.material.rod_rest = parts::rods::RestAngle::straight;
    const Scene moving = scene_of({filmed(rod)});
    exec::HostExecutor executor;
    Families families = families_of(moving, executor);
    for (const auto& family : families) family->begin_step({.t_end = 2});
    Families bends;
    for (auto& family : families) {
      if (family->width() == 3) bends.push_back(std::move(family));
    }
    ASSERT_EQ(bends.size(), 1u);
    const std::vector<double> there = energies(bends, curled(moving.rest));
    const double most = *std::max_element(there.begin(), there.end());
    if (straight) {
      EXPECT_GT(most, 1e-4) << "bent against its straight rest";
    } else {
      EXPECT_LT(most, 1e-25) << "at rest where the film is";
    }
  }
}

TEST(RestFilms, KeepWhatHasCrept) {
  BodySpec body = cloth("body");
  body.material.model = "none";
  body.material.bending = 0.1, body.material.bending_creep = 1e9;
  body.material.cloth_tension = body.material.cloth_compression = 10, body.material.cloth_creep = 1e9;
  const Scene moving = scene_of({filmed(body)});
  exec::HostExecutor executor;
  Families families = families_of(moving, executor);
  Positions x = moving.rest;  // folded and stretched; it creeps until this is its rest shape
  x.row(0) *= 1.2;
  x.row(2) += 0.3 * x.row(0).cwiseProduct(x.row(0));
  for (const auto& family : families) {
    family->end_step(x.data(), 1);
    family->begin_step({.t_end = 1});
  }
  for (const double energy : energies(families, x)) EXPECT_LT(energy, 1e-20);
  for (const auto& family : families) family->begin_step({.t_end = 2});
  const std::vector<double> moved = energies(families, x);
  EXPECT_GT(*std::max_element(moved.begin(), moved.end()), 1e-3) << "the film moved on";
  for (const auto& family : families) family->begin_step({.t_end = 1});
  for (const double energy : energies(families, x)) EXPECT_LT(energy, 1e-20) << "and what crept is kept";
}

TEST(RestFilms, AreRefusedByName) {
  BodySpec body = filmed(cloth("body"));
  EXPECT_EQ(complaint({body}), "");
  body.material.limit = StrainLimitSpec{};
  EXPECT_NE(complaint({body}).find("/rest_film: found a strain limit"), std::string::npos)
      << complaint({body});
  body = cloth("body");
  Positions flat = body.mesh.vertices;
  flat.row(0).setZero();
  body.rest_film =
      std::make_shared<const Film>(Film({0, 0.5}, {body.mesh.vertices, flat}, FilmInterpolation::linear));
  EXPECT_NE(complaint({body}).find("triangle 0 without area at 0.5 s"), std::string::npos)
      << complaint({body});
  BodySpec solid = kinds()[6].body;
  Positions inverted = solid.mesh.vertices;
  inverted.row(0) *= -1;
  solid.rest_film = std::make_shared<const Film>(
      Film({0, 0.5}, {solid.mesh.vertices, inverted}, FilmInterpolation::linear));
  EXPECT_NE(complaint({solid}).find("tetrahedron 0 of -"), std::string::npos) << complaint({solid});
}

}  // namespace
}  // namespace bb::rest_films_test
