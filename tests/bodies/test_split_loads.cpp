// Drag of the air and a pressure that are split among the corners of a triangle as its mass is, and weighted: forces on every vertex against
// closed forms, their sums, derivatives against differences.
#include <gtest/gtest.h>

#include <cmath>

#include "core/energy/families/families.hpp"
#include "core/math/lower_blocks.hpp"
#include "core/model/bodies/lumping.hpp"
#include "core/model/mesh/topology.hpp"
#include "tests/bodies/bodies.hpp"
#include "tests/energy/host_family.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::split_loads_test {
namespace {

using namespace test;

constexpr double pressure = 70, dt = 0.02, t_end = 0.5;  // Pa, s

/// A closed surface of acute and obtuse triangles, which comes after another body, and two groups.
BodySpec balloon(Lumping lumping) {
  BodySpec body;
  body.name = "balloon";
  body.mesh = icosphere_mesh(1, 0.5);
  body.mesh.vertices.row(0) *= 2.5;
  body.d_hat = 0.01;
  body.material.lumping = lumping;
  body.pressure = pressure;
  std::vector<double> left, top;
  for (Eigen::Index v = 0; v < body.mesh.vertices.cols(); ++v) {
    left.push_back(body.mesh.vertices(0, v) < 0 ? 0.75 : 0.125);
    top.push_back(body.mesh.vertices(2, v) > 0.1);
  }
  body.weights = {{"left", left}, {"top", top}};
  return body;
}

/// Their mixed weight at t_end: 0.6 left + 0.25 top.
std::vector<WeightShare> shares() { return {{"left", 0.6, {}}, {"top", 1, {{0, 0}, {2, 1}}}}; }
double mixed(const BodySpec& body, int v) {
  const auto i = static_cast<std::size_t>(v);
  return 0.6 * body.weights[0].weight[i] + 0.25 * body.weights[1].weight[i];
}

Scene behind_a_cloth(const BodySpec& body) {
  SceneBuilder builder("test", false, down, "test");
  builder.set_air({0.7, 0.2, Vec3d(1, -2, 3), {}});
  builder.add_body(cloth("before", 9));
  builder.add_body(body);
  return builder.finish();
}

Positions moved(const Positions& x, double size) {
  Positions out = x;
  for (Eigen::Index i = 0; i < x.size(); ++i) out.data()[i] += size * std::sin(1.7 * static_cast<double>(i));
  return out;
}

Positions forces(const HostFamily& family, ElementFamily& of, const Positions& x) {
  LocalTerms terms;
  family.derivatives(x, Projection::none, terms);
  Positions out = Positions::Zero(3, x.cols());
  const auto vertices = of.vertices();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (int c = 0; c < 3; ++c) out(c, vertices[i]) -= terms.grad[3 * i + static_cast<std::size_t>(c)];
  }
  return out;
}

Vec3d area_at(const Positions& x, const std::array<int, 3>& t) {
  return 0.5 * (x.col(t[1]) - x.col(t[0])).cross(Vec3d(x.col(t[2]) - x.col(t[0])));
}

/// force(triangle of the body, numbered as in the scene; corner) on every vertex of the scene.
template <class Force>
Positions summed(const Scene& scene, const BodySpec& body, const Force& force) {
  const int first = scene.bodies[1].first_vertex;
  Positions out = Positions::Zero(3, scene.n_vertices());
  for (const auto& local : body.mesh.triangles) {
    const CornerParts parts = load_parts(body.mesh.vertices, local, body.material.lumping);
    const std::array<int, 3> t{local[0] + first, local[1] + first, local[2] + first};
    for (std::size_t k = 0; k < 3; ++k) out.col(t[k]) += force(t, local, k, parts[k]);
  }
  return out;
}

void expect_same(const Positions& found, const Positions& expected, double least) {
  EXPECT_GT(expected.cwiseAbs().maxCoeff(), least);
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
}

TEST(SplitLoads, have_parts_of_a_triangle_as_its_mass_has) {
  const TriangleMesh mesh = balloon(Lumping::mixed_voronoi).mesh;
  std::vector<double> mass(static_cast<std::size_t>(mesh.n_vertices())), load = mass;
  lump_triangles(mesh, Lumping::mixed_voronoi, 1,
                 [&](int v, double m) { mass[static_cast<std::size_t>(v)] += m; });
  double farthest = 0;
  for (const auto& t : mesh.triangles) {
    const CornerParts parts = load_parts(mesh.vertices, t, Lumping::mixed_voronoi);
    EXPECT_NEAR(parts[0] + parts[1] + parts[2], 1, 1e-14);
    for (std::size_t k = 0; k < 3; ++k) {
      load[static_cast<std::size_t>(t[k])] += parts[k] * area_vector(mesh.vertices, t).norm();
      farthest = std::max(farthest, std::abs(parts[k] - 1.0 / 3));
    }
    EXPECT_EQ(load_parts(mesh.vertices, t, Lumping::uniform), (CornerParts{1.0 / 3, 1.0 / 3, 1.0 / 3}));
  }
  for (std::size_t v = 0; v < mass.size(); ++v) EXPECT_NEAR(load[v], mass[v], 1e-14);
  EXPECT_GT(farthest, 0.1);
}

TEST(SplitLoads, are_thirds_without_a_column_where_no_body_splits_otherwise) {
  const Scene thirds = behind_a_cloth(balloon(Lumping::uniform));
  EXPECT_TRUE(thirds.corner_parts.empty());
  EXPECT_TRUE(thirds.inflation.parts.empty());
  const Scene split = behind_a_cloth(balloon(Lumping::mixed_voronoi));
  ASSERT_EQ(split.corner_parts.size(), split.surface_triangles.size());
  EXPECT_EQ(split.corner_parts.front(), (CornerParts{1.0 / 3, 1.0 / 3, 1.0 / 3}));  // of the cloth
  EXPECT_EQ(3 * split.corner_parts.front()[0], 1);  // so that its drag keeps its bits
  EXPECT_EQ(split.inflation.parts.size(), split.inflation.triangles.size());
}

/// A body that splits by thirds keeps its bits, whatever the others do.
TEST(SplitLoads, change_no_bit_of_a_body_of_thirds) {
  std::vector<std::vector<double>> gradients;
  for (const Lumping lumping : {Lumping::barycentric, Lumping::mixed_voronoi}) {
    const Scene scene = behind_a_cloth(balloon(lumping));
    HostFamily family([&](const FamilyPlace& place) { return air_drag_family(place, scene); });
    const Positions x = moved(scene.x0, 0.03);
    family->begin_step({.x_n = scene.x0.data(), .dt = dt, .t_end = t_end});
    LocalTerms terms;
    family.derivatives(x, Projection::none, terms);
    gradients.push_back(terms.grad);
  }
  const std::size_t of_cloth = 3 * 12;
  const auto first = [of_cloth](const std::vector<double>& all) {
    return std::vector<double>(all.begin(), all.begin() + of_cloth);
  };
  EXPECT_GT(std::abs(gradients[0][0]), 1e-3);
  EXPECT_EQ(first(gradients[0]), first(gradients[1]));
  EXPECT_NE(gradients[0], gradients[1]);
}

TEST(SplitLoads, drag_on_a_corner_is_that_of_its_part) {
  const auto found = [](Lumping lumping, Positions* expected) {
    const BodySpec body = balloon(lumping);
    const Scene scene = behind_a_cloth(body);
    HostFamily family([&](const FamilyPlace& place) { return air_drag_family(place, scene); });
    const Positions x_n = moved(scene.x0, 0.02), x = moved(scene.x0, 0.03);
    family->begin_step({.x_n = x_n.data(), .dt = dt, .t_end = t_end});
    *expected = summed(scene, body, [&](const auto& t, const auto&, std::size_t k, double part) -> Vec3d {
      const Vec3d area = area_at(x_n, t), u = (x.col(t[k]) - x_n.col(t[k])) / dt - scene.air.wind;
      const Vec3d along = u.dot(area.normalized()) * area.normalized();
      return -part * area.norm() * (0.7 * along + 0.2 * (u - along));
    });
    return Positions(forces(family, *family, x).rightCols(body.mesh.n_vertices()));
  };
  Positions split, thirds;
  const Positions by_split = found(Lumping::mixed_voronoi, &split),
                  by_thirds = found(Lumping::barycentric, &thirds);
  const auto n = by_split.cols();
  expect_same(by_split, split.rightCols(n), 0.1);
  expect_same(by_thirds, thirds.rightCols(n), 0.1);
  EXPECT_GT((by_split - by_thirds).cwiseAbs().maxCoeff(), 0.02);
}

/// Where every vertex has the same velocity the force on a triangle is the same however it is split.
TEST(SplitLoads, drag_keeps_the_sum_of_its_forces) {
  std::vector<Vec3d> sums;
  for (const Lumping lumping : {Lumping::barycentric, Lumping::mixed_voronoi}) {
    const Scene scene = behind_a_cloth(balloon(lumping));
    HostFamily family([&](const FamilyPlace& place) { return air_drag_family(place, scene); });
    family->begin_step({.x_n = scene.x0.data(), .dt = dt, .t_end = t_end});
    sums.emplace_back(forces(family, *family, scene.x0).rowwise().sum());
  }
  EXPECT_GT(sums[0].norm(), 1);
  EXPECT_LT((sums[1] - sums[0]).norm(), 1e-13 * sums[0].norm());
}

/// At the start of the step, from which areas and normals are.
TEST(SplitLoads, pressure_on_a_corner_is_that_of_its_part_and_weight) {
  for (const bool weighted : {false, true}) {
    for (const Lumping lumping : {Lumping::barycentric, Lumping::mixed_voronoi}) {
      BodySpec body = balloon(lumping);
      if (weighted) body.pressure_mix = shares();
      const Scene scene = behind_a_cloth(body);
      const Positions x_n = moved(scene.x0, 0.02);
      HostFamily family([&](const FamilyPlace& place) { return inflation_family(place, scene); });
      family->begin_step({.x_n = x_n.data(), .dt = dt, .t_end = 1e9});  // of another time
      family->change_step({.x_n = x_n.data(), .dt = dt, .t_end = t_end});
      const Positions expected =
          summed(scene, body, [&](const auto& t, const auto& local, std::size_t, double part) -> Vec3d {
            double weight = 1;
            if (weighted)
              weight = (mixed(body, local[0]) + mixed(body, local[1]) + mixed(body, local[2])) / 3;
            return part * weight * pressure * area_at(x_n, t);
          });
      const Positions found = forces(family, *family, x_n);
      expect_same(found, expected, 1);
      if (!weighted) {
        EXPECT_LT(found.rowwise().sum().norm(), 1e-12);  // a closed surface
      } else {
        EXPECT_GT(found.rowwise().sum().norm(), 1);
      }
    }
  }
}

/// Away from the start of the step, whichever way the surface is seen.
TEST(SplitLoads, pressure_has_the_gradient_and_hessian_of_its_energy) {
  BodySpec body = balloon(Lumping::mixed_voronoi);
  body.pressure_mix = shares();
  for (auto& t : body.mesh.triangles) std::swap(t[0], t[1]);
  const Scene scene = behind_a_cloth(body);
  HostFamily family([&](const FamilyPlace& place) { return inflation_family(place, scene); });
  family->begin_step({.x_n = scene.x0.data(), .dt = dt, .t_end = t_end});
  const Positions x = moved(scene.x0, 0.05);
  const auto vertices = family->vertices();
  LocalTerms terms;
  family.derivatives(x, Projection::none, terms);
  EXPECT_EQ(family.values(x), terms.energy);
  double largest = 0;
  for (const std::size_t e : {0U, 17U, 54U}) {
    for (std::size_t i = 0; i < 9; ++i) {
      Positions more = x, less = x;
      const int v = vertices[3 * e + i / 3];
      constexpr double h = 1e-4;
      more(static_cast<int>(i % 3), v) += h, less(static_cast<int>(i % 3), v) -= h;
      const double slope = (family.values(more)[e] - family.values(less)[e]) / (2 * h);
      EXPECT_NEAR(terms.grad[9 * e + i], slope, 1e-9);
      largest = std::max(largest, std::abs(slope));
      LocalTerms up, down_;
      family.derivatives(more, Projection::none, up);
      family.derivatives(less, Projection::none, down_);
      const Eigen::MatrixXd hess = from_lower_blocks(&terms.hess[n_lower_numbers(3) * e], 3);
      for (std::size_t j = 0; j < 9; ++j) {
        EXPECT_NEAR(hess(static_cast<int>(i), static_cast<int>(j)),
                    (up.grad[9 * e + j] - down_.grad[9 * e + j]) / (2 * h), 1e-8);
      }
    }
  }
  EXPECT_GT(largest, 0.1);
}

}  // namespace
}  // namespace bb::split_loads_test
