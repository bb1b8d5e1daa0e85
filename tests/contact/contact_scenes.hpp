// Small scenes for the contact tests, as plain numbers.
#pragma once

#include <array>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/barrier/shape.hpp"
#include "core/contact/contact_system.hpp"
#include "core/contact/contact_terms.hpp"

namespace bb::test {

using Triangles = std::vector<std::array<int, 3>>;
using Edges = std::vector<std::array<int, 2>>;

inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Appends a body; its surface is all of it. Returns its first vertex.
inline int add_body(Scene& scene, const std::string& name, const std::vector<Vec3d>& vertices,
                    const Triangles& triangles, double d_hat, bool given = false, double offset = 0) {
  const int first = scene.n_vertices(), n = static_cast<int>(vertices.size());
  const int body = static_cast<int>(scene.bodies.size());
  scene.bodies.push_back({name, first, n});
  scene.rest.conservativeResize(3, first + n);
  for (int i = 0; i < n; ++i) {
    scene.rest.col(first + i) = vertices[at(i)];
    scene.mass.push_back(given ? 0 : 1);
    scene.body.push_back(body);
    scene.d_hat.push_back(d_hat);
    scene.offset.push_back(offset);
    scene.surface_vertices.push_back(first + i);
    if (given) scene.pins.push_back({first + i, 0});
  }
  if (given && scene.motions.empty()) scene.motions.push_back({});
  for (const auto& t : triangles) {
    scene.surface_triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  scene.x0 = scene.rest;
  scene.v0 = Positions::Zero(3, first + n);
  return first;
}

/// (nx + 1) x (ny + 1) vertices on z = 0, spacing h, each cell cut along the same diagonal.
inline std::pair<std::vector<Vec3d>, Triangles> grid(int nx, int ny, double h, Vec3d origin = Vec3d::Zero()) {
  std::vector<Vec3d> vertices;
  Triangles triangles;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) vertices.push_back(origin + h * Vec3d(i, j, 0));
  }
  const auto id = [nx](int i, int j) { return j * (nx + 1) + i; };
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  return {vertices, triangles};
}

/// Random triangles of size `size` in a box of size 1, three vertices each.
inline std::pair<std::vector<Vec3d>, Triangles> soup(int n_triangles, double size, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3d(unit(rng), unit(rng), unit(rng)); };
  std::vector<Vec3d> vertices;
  Triangles triangles;
  for (int t = 0; t < n_triangles; ++t) {
    const Vec3d centre = point();
    for (int k = 0; k < 3; ++k) vertices.push_back(centre + size * point());
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return {vertices, triangles};
}

/// Appends 12 loose triangles that nearly touch the ball (axis 0) or the bar round an axis at random places, 0.25 to 0.9
/// d_hat away: with a corner, a side or the middle; on a bar every third with a side along the axis.
inline void add_tangent_triangles(Scene& scene, const std::string& name, const Vec3d& centre, double radius,
                                  const Vec3d& axis, double d_hat, unsigned seed, double offset = 0) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Vec3d> vertices;
  Triangles triangles;
  for (int t = 0; t < 12; ++t) {
    Vec3d n(unit(rng), unit(rng), unit(rng));
    n = (n - axis.dot(n) * axis).normalized();
    const Vec3d u = (axis.isZero() ? n.unitOrthogonal() : axis), v = n.cross(u);
    const Vec3d foot = centre + n * (radius + offset + d_hat * (0.575 + 0.325 * unit(rng)));
    const double turn = t % 3 == 0 ? 0.02 * unit(rng) : 3 * unit(rng), c = std::cos(turn), s = std::sin(turn);
    const double shift = t % 2 == 0 ? 0 : 0.3 * unit(rng);
    for (const Eigen::Vector2d& p :
         {Eigen::Vector2d(-0.2, -0.1), Eigen::Vector2d(0.2, -0.1), Eigen::Vector2d(0, 0.2)}) {
      const double a = c * p[0] - s * p[1] + shift, b = s * p[0] + c * p[1];
      vertices.push_back(foot + a * u + b * v + 0.01 * (1 + unit(rng)) * n);
    }
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  add_body(scene, name, vertices, triangles, d_hat, false, offset);
}

inline Positions random_motion(const Positions& x, double size, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-size, size);
  Positions out = x;
  for (Eigen::Index i = 0; i < out.size(); ++i) out.data()[i] += unit(rng);
  return out;
}

/// Both tables of a state; candidates are updated at x.
struct Rows {
  ContactTable table;
  MollifiedTable mollified;
  double min_gap;
};
inline Rows rows_at(ContactSystem& contacts, const Positions& x) {
  Rows out;
  contacts.update_candidates(x, x);
  out.min_gap = contacts.find_rows(x, out.table, out.mollified);
  return out;
}

/// Index of the first row with these sorted vertices and kind, -1 when there is none.
inline int find_row(const ContactTable& t, const ContactKey& key, ContactKind kind) {
  for (std::size_t r = 0; r < t.size(); ++r) {
    if (t.key(r) == key && t.kind[r] == kind) return static_cast<int>(r);
  }
  return -1;
}

inline std::vector<ContactKey> keys_of(const ContactTable& t) {
  std::vector<ContactKey> out;
  for (std::size_t r = 0; r < t.size(); ++r) out.push_back(t.key(r));
  return out;
}

/// A shape of the tests' own: (d_hat - d)^2, or (d_hat - d)^3 where smoothness is needed.
enum class TestShape { quadratic, cubic };
template <class Table>
void evaluate(Table& t, double kappa, TestShape shape = TestShape::quadratic) {
  for (std::size_t r = 0; r < t.size(); ++r) {
    const double y = t.d_hat[r] - t.d[r];
    const bool cubic = shape == TestShape::cubic;
    t.kappa[r] = kappa;
    t.b[r] = cubic ? y * y * y / t.d_hat[r] : y * y;
    t.db[r] = cubic ? -3 * y * y / t.d_hat[r] : -2 * y;
    t.d2b[r] = cubic ? 6 * y / t.d_hat[r] : 2;
  }
}

/// B of rows at x whose barriers are evaluated.
inline double energy_of(const Rows& rows, const Positions& x) {
  std::vector<double> energy, mollified;
  contact_energies(rows.table, energy);
  mollified_energies(rows.mollified, x, mollified);
  double sum = 0;
  for (double e : energy) sum += e;
  for (double e : mollified) sum += e;
  return sum;
}

/// B at x with a given shape; also counts rows into *n_rows.
inline double barrier(ContactSystem& contacts, const Positions& x, double kappa,
                      TestShape shape = TestShape::quadratic, std::size_t* n_rows = nullptr) {
  Rows rows = rows_at(contacts, x);
  evaluate(rows.table, kappa, shape);
  evaluate(rows.mollified, kappa, shape);
  if (n_rows != nullptr) *n_rows = rows.table.size() + rows.mollified.size();
  return energy_of(rows, x);
}

/// A 4 x 4 grid of unit cells and a free vertex (25) at p.
inline Scene point_over_grid(const Vec3d& p, double d_hat, bool given = false, double offset = 0) {
  Scene scene;
  const auto [vertices, triangles] = grid(4, 4, 1.0);
  add_body(scene, "sheet", vertices, triangles, d_hat, given, offset);
  add_body(scene, "point", {p}, {}, d_hat);
  return scene;
}

}  // namespace bb::test
