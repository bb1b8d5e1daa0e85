// Films of bodies in a scene: where prescribed vertices start and go, and what is refused of a film by name.
#include <gtest/gtest.h>

#include "tests/bodies/bodies.hpp"

namespace bb::films_test {
namespace {

using namespace test;

/// From a mesh to the same mesh where f takes it, within a second.
template <class F>
std::shared_ptr<const Film> film_to(const Positions& x, const F& f, double noise = 0) {
  Positions first = x, last = x;
  first(0, 0) += noise;
  for (Eigen::Index v = 0; v < x.cols(); ++v) last.col(v) = f(Vec3d(x.col(v)));
  return std::make_shared<const Film>(Film({0, 1}, {first, last}, FilmInterpolation::linear));
}
Vec3d raised(const Vec3d& x) { return x + Vec3d(0, 0, 3 * x[0]); }

TEST(Films, TakeEveryVertexOfABodyAlong) {
  BodySpec box = rigid_box("box");
  box.motion.film = film_to(box.mesh.vertices, raised, 1e-9);
  const Scene scene = scene_of({cloth("cloth", 1), box, cloth("last", 2)});
  const int first = scene.bodies[1].first_vertex;
  ASSERT_GT(first, 0);
  ASSERT_EQ(static_cast<int>(scene.pins.size()), box.mesh.n_vertices());
  for (const Pin& pin : scene.pins) {
    const Vec3d start = box.mesh.vertices.col(pin.vertex - first);
    EXPECT_LT((pin_pose(scene, pin, 0.5) - (start + raised(start)) / 2).norm(), 1e-8);
    EXPECT_EQ(pin_pose(scene, pin, 0), Vec3d(scene.x0.col(pin.vertex)))
        << "to the bit, whatever the mesh says";
    EXPECT_LT((scene.v0.col(pin.vertex) - (raised(start) - start)).norm(), 1e-8);
  }
  EXPECT_NE(scene.x0(0, first), box.mesh.vertices(0, 0)) << "the noise of the film is in no body";
}

TEST(Films, OfPinsAreOfTheWholeMeshAndMoveTheirVerticesAlone) {
  BodySpec sheet = cloth("sheet", 1);
  PinSpec pin;
  pin.indices = {2, 5};
  pin.motion.film = film_to(sheet.mesh.vertices, raised);
  sheet.pins = {pin};
  const Scene scene = scene_of({cloth("first"), sheet});
  ASSERT_EQ(scene.pins.size(), 2u);
  const int first = scene.bodies[1].first_vertex;
  for (std::size_t k = 0; k < 2; ++k) {
    const int own = pin.indices[k];
    EXPECT_EQ(scene.pins[k].vertex, first + own);
    const Vec3d there = raised(sheet.mesh.vertices.col(own));
    EXPECT_LT((pin_pose(scene, scene.pins[k], 2) - there).norm(), 1e-15);
  }
}

TEST(Films, AreRefusedByName) {
  const BodySpec box = rigid_box("box");
  const auto of = [&box](std::shared_ptr<const Film> film) {
    BodySpec body = box;
    body.motion.film = std::move(film);
    return complaint({cloth("cloth", 1), body});
  };
  const Positions& x = box.mesh.vertices;
  const auto expect = [](const std::string& found, const std::vector<std::string>& words) {
    for (const std::string& word : words)
      EXPECT_NE(found.find(word), std::string::npos) << word << " in: " << found;
  };
  EXPECT_EQ(of(film_to(x, raised)), "");
  expect(of(film_to(x.leftCols(5), raised)), {"box", "/motion/film", "5 vertices", "8, as the mesh"});
  expect(of(film_to(Positions(x.colwise() + Vec3d(0, 0, 0.1)), raised)),
         {"vertex", "0.1 m from where", "do not jump"});
  expect(of(film_to(Positions(1000 * x), raised)), {"1000 times as large", "unit may be another"});
  expect(of(film_to(x, [](const Vec3d&) { return Vec3d(NAN, 0, 0); })), {"NaN", "at 1 s", "finite"});
  BodySpec flat = cloth("flat");
  PinSpec pin;
  pin.all = true;
  pin.motion.film = film_to(flat.mesh.vertices, raised);
  flat.pins = {pin};
  BodySpec other = cloth("other");
  expect(complaint({flat, other}, {}, true), {"z != 0 at 1 s", "planar"});
}

}  // namespace
}  // namespace bb::films_test
