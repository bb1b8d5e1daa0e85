#include "core/model/scene/contact_plan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/math/at.hpp"

namespace bb {
namespace {

using Flags = std::vector<char>;

bool is_set(const Flags& flags, int vertex) { return flags[static_cast<std::size_t>(vertex)] != 0; }

/// Vertices, each counted once.
struct VertexSet {
  Flags has;
  std::size_t n = 0;

  explicit VertexSet(const Scene& scene) : has(static_cast<std::size_t>(scene.n_vertices()), 0) {}
  void insert(int vertex) {
    char& flag = has[static_cast<std::size_t>(vertex)];
    n += flag == 0;
    flag = 1;
  }
};

/// How many primitives of one kind there are, on how many vertices, and whether one of them can move.
struct PrimitiveCount {
  std::size_t n = 0, n_vertices = 0;
  bool free = false;
};

template <std::size_t N>
void add(const std::vector<std::array<int, N>>& list, const Flags& is_free, VertexSet& vertices,
         PrimitiveCount& out) {
  out.n += list.size();
  for (const auto& primitive : list) {
    for (const int vertex : primitive) {
      vertices.insert(vertex);
      out.free = out.free || is_set(is_free, vertex);
    }
  }
  out.n_vertices = vertices.n;
}

PrimitiveCount count_points(const Scene& scene, const Flags& is_free, VertexSet& vertices) {
  PrimitiveCount out;
  for (const int v : scene.surface_vertices) {
    vertices.insert(v);
    out.free = out.free || is_set(is_free, v);
  }
  out.n = out.n_vertices = vertices.n;
  return out;
}

// Sides of triangles count in space, where they are in pairs of edges.
PrimitiveCount count_edges(const Scene& scene, const Flags& is_free) {
  PrimitiveCount out;
  VertexSet vertices(scene);
  add(scene.surface_edges, is_free, vertices, out);
  if (!scene.planar) {
    add(scene.surface_triangles, is_free, vertices, out);
    out.n += 2 * scene.surface_triangles.size();
  }
  return out;
}

PrimitiveCount count_triangles(const Scene& scene, const Flags& is_free) {
  PrimitiveCount out;
  VertexSet vertices(scene);
  add(scene.surface_triangles, is_free, vertices, out);
  return out;
}

/// Edges that are no side of a triangle, each once.
PrimitiveCount count_lone_edges(const Scene& scene, const Flags& is_free) {
  PrimitiveCount out;
  VertexSet vertices(scene);
  add(lone_edges(scene), is_free, vertices, out);
  return out;
}

/// Counts of bodies by what they can touch.
struct Bodies {
  int deformable = 0;         // bodies with at least one free vertex
  int given = 0;              // bodies without
  bool pairs_in_one = false;  // a deformable body with vertices that are not neighbours
};

/// surface: vertices of the surface.
Bodies count_bodies(const Scene& scene, const Flags& is_free, const VertexSet& surface,
                    const PrimitiveCount& lone) {
  // so many vertices of one body never make a pair
  const int few = scene.planar ? 1 : lone.n > 0 ? 2 : 3;
  Bodies out;
  const auto some = [](const Flags& flags, const Body& body) {
    const auto begin = flags.begin() + body.first_vertex;
    return std::any_of(begin, begin + body.n_vertices, [](char f) { return f != 0; });
  };
  for (const Body& body : scene.bodies) {
    if (!some(surface.has, body)) continue;  // an obstacle's point
    const bool deformable = some(is_free, body);
    ++(deformable ? out.deformable : out.given);
    out.pairs_in_one = out.pairs_in_one || (deformable && body.n_vertices > few);
  }
  return out;
}

void plan_pairs(const Scene& scene, const PrimitiveCount& points, const PrimitiveCount& lone,
                const Flags& is_free, ContactPlan& plan) {
  if (scene.planar && scene.planar_pairs == PlanarPairs::vertex_vertex) {
    plan.point_point = points.n > 1 && points.free;
    return;
  }
  const PrimitiveCount edges = count_edges(scene, is_free);
  if (scene.planar) {
    plan.point_edge = edges.n > 0 && points.n > 2 && (points.free || edges.free);
    return;
  }
  const PrimitiveCount triangles = count_triangles(scene, is_free);
  plan.point_triangle = triangles.n > 0 && points.n > 3 && (points.free || triangles.free);
  plan.edge_edge = edges.n > 1 && edges.n_vertices > 3 && edges.free;
  plan.point_edge = lone.n > 0 && points.n > 2 && (points.free || lone.free);
}

/// How many pairs do less than collide in full; "1 static, 2 off" of those that the scene names.
PlanItem plan_collisions(const Collisions& of) {
  std::string text;
  for (const auto& [kind, word] : {std::pair{CollisionKind::ccd, "ccd"},
                                   {CollisionKind::audited, "audited"},
                                   {CollisionKind::static_test, "static"},
                                   {CollisionKind::proximity, "proximity"},
                                   {CollisionKind::off, "off"}}) {
    const auto n = std::count_if(of.pairs.begin(), of.pairs.end(),
                                 [kind = kind](const CollisionPair& p) { return p.kind == kind; });
    if (n > 0) text += fmt::format("{}{} {}", text.empty() ? "pairs of bodies: " : ", ", n, word);
  }
  if (!of.group.empty()) text += text.empty() ? "collision groups" : ", and collision groups";
  return plan_item(of.chosen(), text, "every pair of bodies collides in full (ccd)");
}

/// Whether a body that can move has a body, itself or another, that it is not `off` with.
bool bodies_meet(const Scene& scene, const Flags& is_free) {
  if (!scene.collisions.chosen()) return true;
  const int n = static_cast<int>(scene.bodies.size());
  for (int a = 0; a < n; ++a) {
    const Body& body = scene.bodies[static_cast<std::size_t>(a)];
    const auto begin = is_free.begin() + body.first_vertex;
    if (std::none_of(begin, begin + body.n_vertices, [](char f) { return f != 0; })) continue;
    for (int b = 0; b < n; ++b) {
      if (scene.collisions.kind(a, b) != CollisionKind::off) return true;
    }
  }
  return false;
}

// In a planar scene a cylinder that stands on the plane is a disk.
bool has_axis_outside(const Scene& scene) {
  return std::any_of(scene.obstacles.begin(), scene.obstacles.end(), [&](const Obstacle& o) {
    const bool disk = scene.planar && o.axis[2] * o.axis[2] > 0.25;
    return o.kind == ObstacleKind::cylinder && !o.inside && !disk;
  });
}

}  // namespace

std::vector<std::array<int, 2>> lone_edges(const Scene& scene) {
  const auto ascending = [](int a, int b) { return a < b ? std::array{a, b} : std::array{b, a}; };
  std::vector<std::array<int, 2>> edges, lone;
  edges.reserve(scene.surface_edges.size());
  for (const auto& e : scene.surface_edges) edges.push_back(ascending(e[0], e[1]));
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  if (edges.empty()) return lone;
  std::vector<std::size_t> start(static_cast<std::size_t>(scene.n_vertices()) + 1, 0);  // by lower vertex
  for (const auto& e : edges) ++start[static_cast<std::size_t>(e[0]) + 1];
  for (std::size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
  Flags is_side(edges.size(), 0);
  for (const auto& t : scene.surface_triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::array<int, 2> side = ascending(t[k], t[(k + 1) % 3]);
      const auto lower = edges.begin() + static_cast<std::ptrdiff_t>(start[at(side[0])]),
                 upper = edges.begin() + static_cast<std::ptrdiff_t>(start[at(side[0]) + 1]);
      const auto found = std::lower_bound(lower, upper, side);
      if (found != upper && *found == side) is_side[static_cast<std::size_t>(found - edges.begin())] = 1;
    }
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!is_side[i]) lone.push_back(edges[i]);
  }
  return lone;
}

PlanItem plan_item(bool needed, std::string yes, std::string no) {
  return {needed, std::move(needed ? yes : no)};
}

ContactPlan plan_contact(const Scene& scene, Mollifier mollifier) {
  Flags is_free(static_cast<std::size_t>(scene.n_vertices()), 1);
  for (const Pin& pin : scene.pins) {
    if (pin.span.always()) is_free[static_cast<std::size_t>(pin.vertex)] = 0;
  }
  VertexSet surface(scene);
  const PrimitiveCount points = count_points(scene, is_free, surface);
  const PrimitiveCount lone = count_lone_edges(scene, is_free);
  const Bodies bodies = count_bodies(scene, is_free, surface, lone);
  ContactPlan plan;
  plan.collisions = plan_collisions(scene.collisions);
  const bool meet = bodies_meet(scene, is_free);
  if (meet) plan_pairs(scene, points, lone, is_free, plan);
  const bool pairs = plan.point_point || plan.point_edge || plan.point_triangle || plan.edge_edge;
  plan.broad_phase =
      plan_item(pairs, "pairs of surfaces", meet ? "no pair of surfaces" : "all pairs of bodies are off");
  const bool mollify = mollifier != Mollifier::none;
  const bool axes = has_axis_outside(scene) && count_edges(scene, is_free).free;
  plan.mollifier =
      plan_item((plan.edge_edge || axes) && mollify,
                plan.edge_edge ? "edge pairs may be parallel" : "edges may be parallel to a cylinder",
                mollify ? "no edge-edge pairs" : "contact.mollifier is none");
  plan.self_contact = plan_item(
      pairs && (bodies.pairs_in_one || bodies.deformable > 1),
      fmt::format("{} deformable bodies", bodies.deformable),
      meet ? "one deformable body without two elements that share no vertex" : "all pairs of bodies are off");
  plan.given_surfaces = plan_item(pairs && bodies.given > 0 && bodies.deformable > 0,
                                  fmt::format("{} prescribed bodies", bodies.given), "no prescribed body");
  plan.obstacles = plan_item(!scene.obstacles.empty() && points.free,
                             fmt::format("{} analytic obstacles", scene.obstacles.size()),
                             scene.obstacles.empty() ? "no analytic obstacle" : "no free surface vertex");
  return plan;
}

}  // namespace bb
