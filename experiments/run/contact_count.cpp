#include "experiments/run/contact_count.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <vector>

#include "core/contact/contact_system.hpp"
#include "core/math/at.hpp"
#include "core/math/stop_request.hpp"

namespace bb {
namespace {

constexpr std::size_t parts_of_surface = 128;

/// The surface near a place, with vertices of its own numbers: what contact reads of a scene.
struct Near {
  Scene scene;
  std::vector<char> inner;  // [n] whose rows are all there
};

/// Distances that decide what is near, m.
struct Reach {
  double edge = 0, contact = 0;  // longest edge of the surface, farthest contact

  Reach() = default;
  explicit Reach(const Scene& scene) {
    const auto add = [&](int a, int b) { edge = std::max(edge, (scene.x0.col(a) - scene.x0.col(b)).norm()); };
    for (const auto& e : scene.surface_edges) add(e[0], e[1]);
    for (const auto& t : scene.surface_triangles) add(t[0], t[1]), add(t[1], t[2]), add(t[2], t[0]);
    for (const int v : scene.surface_vertices)
      contact = std::max(contact, scene.d_hat[at(v)] + 2 * scene.offset[at(v)]);
  }
  static Reach everywhere() {
    Reach out;
    out.edge = std::numeric_limits<double>::infinity();
    return out;
  }
  double inner() const { return 2 * edge; }
  /// A row of an inner vertex ends there: its primitive, the gap, the other primitive.
  double outer() const { return inner() + 2 * edge + contact; }
};

template <std::size_t N>
void append_inside(const std::vector<std::array<int, N>>& from, const std::vector<int>& number,
                   std::vector<std::array<int, N>>& to) {
  for (const auto& primitive : from) {
    std::array<int, N> own{};
    bool inside = true;
    for (std::size_t k = 0; k < N; ++k) inside = (own[k] = number[at(primitive[k])]) >= 0 && inside;
    if (inside) to.push_back(own);
  }
}

/// number: [n_vertices] of the scene, -1 everywhere before and after.
Near near_place(const Scene& scene, const Vec3d& place, const Reach& reach, std::vector<int>& number) {
  Near out;
  std::vector<int> vertices;
  for (const int v : scene.surface_vertices) {
    const double away = (scene.x0.col(v) - place).lpNorm<Eigen::Infinity>();
    if (away > reach.outer()) continue;
    number[at(v)] = static_cast<int>(vertices.size());
    vertices.push_back(v);
    out.inner.push_back(away <= reach.inner());
  }
  Scene& own = out.scene;
  own.planar = scene.planar, own.planar_pairs = scene.planar_pairs;
  own.bodies = scene.bodies, own.collisions = scene.collisions;
  own.rest.resize(3, static_cast<Eigen::Index>(vertices.size()));
  own.x0.resize(3, own.rest.cols());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::size_t v = at(vertices[i]);
    own.rest.col(static_cast<Eigen::Index>(i)) = scene.rest.col(vertices[i]);
    own.x0.col(static_cast<Eigen::Index>(i)) = scene.x0.col(vertices[i]);
    own.body.push_back(scene.body[v]), own.d_hat.push_back(scene.d_hat[v]);
    own.offset.push_back(scene.offset[v]), own.surface_vertices.push_back(static_cast<int>(i));
  }
  for (const Pin& pin : scene.pins) {
    if (number[at(pin.vertex)] < 0) continue;
    own.pins.push_back(pin);
    own.pins.back().vertex = number[at(pin.vertex)];
  }
  append_inside(scene.surface_edges, number, own.surface_edges);
  append_inside(scene.surface_triangles, number, own.surface_triangles);
  for (const int v : vertices) number[at(v)] = -1;
  return out;
}

/// Rows of the scene whose vertex with the lowest number is one of `owner`.
std::size_t rows_of(const Scene& scene, const ContactPlan& plan, const ContactOptions& options,
                    const std::vector<char>& owner) {
  ContactSystem contacts(scene, options, plan);
  contacts.update_candidates(scene.x0, scene.x0);
  ContactTable rows;
  MollifiedTable mollified;
  contacts.find_rows(scene.x0, rows, mollified);
  std::size_t n = 0;
  const auto count = [&](const std::vector<int>& stencil) {
    for (std::size_t r = 0; 4 * r < stencil.size(); ++r) {
      int lowest = scene.n_vertices();
      for (std::size_t k = 0; k < 4; ++k) {
        if (stencil[4 * r + k] >= 0) lowest = std::min(lowest, stencil[4 * r + k]);
      }
      n += owner[at(lowest)] != 0;
    }
  };
  count(rows.stencil), count(mollified.stencil);
  return n;
}

}  // namespace

StartContacts contacts_at_start(const Scene& scene, const ContactPlan& plan, const ContactOptions& options,
                                std::size_t most_counted) {
  StartContacts out;
  const std::size_t n = scene.surface_vertices.size();
  if (n == 0 || !plan.broad_phase.needed) return out;
  ContactPlan surfaces = plan;
  surfaces.obstacles.needed = false;
  const Reach reach(scene);
  std::vector<int> number(at(scene.n_vertices()), -1);
  std::size_t rows = 0;
  if (n <= most_counted) {
    const Near all = near_place(scene, Vec3d::Zero(), Reach::everywhere(), number);
    rows = rows_of(all.scene, surfaces, options, all.inner);
    out.sampled = n;
  } else {
    std::mt19937_64 random(1);
    for (std::size_t k = 0; k < parts_of_surface; ++k) {
      heed_stop();
      const std::size_t first = k * n / parts_of_surface, last = (k + 1) * n / parts_of_surface;
      const int v = scene.surface_vertices[first + random() % (last - first)];
      const Near part = near_place(scene, scene.x0.col(v), reach, number);
      rows += rows_of(part.scene, surfaces, options, part.inner);
      out.sampled += static_cast<std::size_t>(std::count(part.inner.begin(), part.inner.end(), 1));
    }
  }
  out.a_vertex = static_cast<double>(rows) / static_cast<double>(out.sampled);
  out.total = out.a_vertex * static_cast<double>(n);
  return out;
}

}  // namespace bb
