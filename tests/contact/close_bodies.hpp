// Random scenes of few thick bodies of every kind at a wanted gap.
#pragma once

#include "tests/contact/true_pairs.hpp"

namespace bb::test {

enum class Piece { point, edge, strip, triangle, sheet };
enum class Wall { plane, ball, bar, in_ball, in_bar, tilted_bar };

/// A uniform number in [low, high); a random point of the box of half side `size` about the origin.
inline double between(std::mt19937_64& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}
inline Vec3d in_box(std::mt19937_64& rng, double size, bool planar = false) {
  const double x = between(rng, -size, size), y = between(rng, -size, size), z = between(rng, -size, size);
  return {x, y, planar ? 0 : z};
}

/// Appends a body of random shape, size about 1; thickness of its own, which differs from vertex to vertex every other
/// time. Returns its first vertex.
inline int add_piece(Scene& scene, Piece kind, std::mt19937_64& rng, double d_hat, bool given) {
  const int n[] = {1, 2, 3, 3, 4};
  std::vector<Vec3d> vertices;
  for (int k = 0; k < n[static_cast<int>(kind)]; ++k) vertices.push_back(in_box(rng, 0.7, scene.planar));
  Triangles triangles;
  const bool filled = kind == Piece::triangle || kind == Piece::sheet;
  if (filled) triangles.push_back({0, 1, 2});
  if (kind == Piece::sheet) {
    vertices[3] = vertices[1] + vertices[2] - vertices[0] + in_box(rng, 0.1, scene.planar);
    triangles.push_back({2, 1, 3});
  }
  const double offset = rng() % 4 == 0 ? 0 : d_hat * between(rng, 0.1, 3);
  const int first =
      add_body(scene, "piece", vertices, scene.planar ? Triangles{} : triangles, d_hat, given, offset);
  if (rng() % 2 == 0) {
    for (int v = first; v < scene.n_vertices(); ++v) scene.offset[at(v)] *= between(rng, 0.5, 1.5);
  }
  if (kind == Piece::edge || kind == Piece::strip) scene.surface_edges.push_back({first, first + 1});
  if (kind == Piece::strip) scene.surface_edges.push_back({first + 1, first + 2});
  if (scene.planar && filled) {
    if (scene.membranes.empty()) scene.membranes.emplace_back();
    for (const auto& t : triangles)
      scene.membranes[0].triangles.push_back({first + t[0], first + t[1], first + t[2]});
    const Edges loop =
        kind == Piece::sheet ? Edges{{0, 1}, {1, 3}, {3, 2}, {2, 0}} : Edges{{0, 1}, {1, 2}, {2, 0}};
    for (const auto& e : loop) scene.surface_edges.push_back({first + e[0], first + e[1]});
  }
  return first;
}

inline Obstacle random_wall(Wall kind, std::mt19937_64& rng, bool planar) {
  Obstacle o;
  o.name = "wall";
  o.point = in_box(rng, 0.5, planar);
  const bool straight = planar || kind == Wall::bar || kind == Wall::in_bar;
  if (kind == Wall::plane) {
    o.axis = (in_box(rng, 1, planar) + Vec3d(0, 0.1, 0)).normalized();
    return o;
  }
  const bool ball = kind == Wall::ball || kind == Wall::in_ball;
  o.kind = ball ? ObstacleKind::sphere : ObstacleKind::cylinder;
  o.inside = kind == Wall::in_ball || kind == Wall::in_bar;
  o.axis = straight ? Vec3d::UnitZ() : Vec3d(in_box(rng, 1) + Vec3d(0, 0, 1.5)).normalized();
  o.radius = o.inside ? between(rng, 3, 4) : between(rng, 0.2, 1);
  return o;
}

/// A scene whose least gap, of its two bodies or of its body and its obstacle, is `gap` (m) in x0; where it is.
struct CloseBodies {
  Scene scene;
  std::vector<TruePair> pairs;
  std::size_t closest = 0;
  Vec3d apart = Vec3d::Zero();  // direction in which the second body (the body) leaves, unit
  int moving = 0;               // its first vertex
};

namespace detail {
/// Moves the second body so that its gap becomes `gap`: along the direction of the closest points no other pair comes
/// closer than they do.
inline void bring_to(CloseBodies& out, double gap) {
  for (int round = 0; round < 3; ++round) {
    std::size_t which = 0;
    const double now = least_true_gap(out.scene, out.pairs, out.scene.x0, &which);
    TrueClosest closest;
    true_gap(out.scene, out.pairs[which], out.scene.x0, &closest);
    const TruePair& pair = out.pairs[which];
    const bool first_moves = pair.first[0] >= out.moving;
    Vec3d away = first_moves ? closest.from - closest.to : closest.to - closest.from;
    if (pair.obstacle >= 0 && out.scene.obstacles[at(pair.obstacle)].inside) away = -away;
    out.apart = away.normalized();
    out.scene.x0.rightCols(out.scene.x0.cols() - out.moving).colwise() += (gap - now) * out.apart;
    out.closest = which;
  }
}
}  // namespace detail

/// A direction in which the first edge or triangle of a body looks; any for a point.
inline Vec3d facing(const Scene& scene, Piece kind, int first, std::mt19937_64& rng) {
  const Vec3d any = in_box(rng, 1, scene.planar);
  if (kind == Piece::point) return any.normalized();
  const Vec3d u = scene.x0.col(first + 1) - scene.x0.col(first);
  if (!scene.planar && (kind == Piece::triangle || kind == Piece::sheet))
    return u.cross(Vec3d(scene.x0.col(first + 2) - scene.x0.col(first))).normalized();
  return Vec3d(any - u * (u.dot(any) / u.squaredNorm())).normalized();
}

/// Two bodies: the pieces; the second one given every third seed. d_hat 0.01 to 0.02 m.
inline CloseBodies close_bodies(Piece a, Piece b, double gap, unsigned seed, bool planar = false) {
  std::mt19937_64 rng(seed);
  CloseBodies out;
  out.scene.planar = planar;
  add_piece(out.scene, a, rng, between(rng, 0.01, 0.02), false);
  out.moving = add_piece(out.scene, b, rng, between(rng, 0.01, 0.02), seed % 3 == 0);
  // every other time an edge or a face of one looks at the other
  const Vec3d any = (in_box(rng, 1, planar) + Vec3d(0.1, 0, 0)).normalized();
  const Vec3d looks = rng() % 2 ? facing(out.scene, a, 0, rng) : facing(out.scene, b, out.moving, rng);
  out.scene.x0.rightCols(out.scene.x0.cols() - out.moving).colwise() += 8 * (rng() % 2 ? any : looks);
  // only pairs of the two bodies
  const int split = out.moving;
  for (const TruePair& p : TruePairs(out.scene).pairs) {
    if ((p.first[0] < split) != (p.second[0] < split)) out.pairs.push_back(p);
  }
  if (out.pairs.empty()) return out;
  detail::bring_to(out, gap);
  out.scene.rest = out.scene.x0;
  return out;
}

/// A body at an obstacle.
inline CloseBodies close_to_wall(Piece piece, Wall wall, double gap, unsigned seed, bool planar = false) {
  std::mt19937_64 rng(seed);
  CloseBodies out;
  out.scene.planar = planar;
  add_piece(out.scene, piece, rng, between(rng, 0.01, 0.02), false);
  out.scene.obstacles = {random_wall(wall, rng, planar)};
  const Obstacle& o = out.scene.obstacles[0];
  Vec3d side = planar ? Vec3d::UnitX() : o.axis.unitOrthogonal();
  if (o.kind == ObstacleKind::plane) side = o.axis;
  if (o.kind == ObstacleKind::sphere && !planar) side = in_box(rng, 1).normalized();
  if (!o.inside && o.kind != ObstacleKind::plane && rng() % 2) {
    side = facing(out.scene, piece, 0, rng);
    if (piece != Piece::point) {  // a place of the edge or the face itself, not its middle
      const int n = piece == Piece::edge || piece == Piece::strip ? 2 : 3;
      const Vec3d middle = out.scene.x0.leftCols(n).rowwise().mean();
      out.scene.x0.colwise() -= middle;
    }
  }
  out.scene.x0.colwise() += o.point + (o.inside ? 0.3 : 8) * side;
  for (const TruePair& p : TruePairs(out.scene).pairs) {
    if (p.obstacle >= 0) out.pairs.push_back(p);
  }
  detail::bring_to(out, gap);
  out.scene.rest = out.scene.x0;
  return out;
}

constexpr Piece all_pieces[] = {Piece::point, Piece::edge, Piece::strip, Piece::triangle, Piece::sheet};
constexpr Wall all_walls[] = {Wall::plane,   Wall::ball,   Wall::bar,
                              Wall::in_ball, Wall::in_bar, Wall::tilted_bar};

/// Calls f(CloseBodies) for every combination of pieces and of pieces and walls, in space and in the plane, at gaps from
/// 1e-6 to 1 d_hat, `n` seeds each.
template <class F>
void for_each_close_scene(unsigned n, unsigned first_seed, const F& f) {
  unsigned seed = first_seed;
  const auto gap = [&seed] {
    std::mt19937_64 rng(seed);
    return 0.01 * std::pow(10.0, between(rng, -6, 0));
  };
  for (const bool planar : {false, true}) {
    for (const Piece a : all_pieces) {
      for (const Piece b : all_pieces) {
        if (a > b || b == Piece::point) continue;
        for (unsigned k = 0; k < n; ++k, ++seed) f(close_bodies(a, b, gap(), seed, planar));
      }
      for (const Wall wall : all_walls) {
        if (planar && wall == Wall::tilted_bar) continue;
        for (unsigned k = 0; k < n; ++k, ++seed) f(close_to_wall(a, wall, gap(), seed, planar));
      }
    }
  }
}

/// Appends a scene, moved by `shift`; its bodies are other bodies.
inline void append(Scene& to, const Scene& from, const Vec3d& shift) {
  const int first = to.n_vertices(), n = from.n_vertices(), body = static_cast<int>(to.bodies.size());
  to.rest.conservativeResize(3, first + n);
  to.rest.rightCols(n) = from.rest.colwise() + shift;
  to.x0.conservativeResize(3, first + n);
  to.x0.rightCols(n) = from.x0.colwise() + shift;
  to.v0 = Positions::Zero(3, first + n);
  for (Body b : from.bodies) {
    b.first_vertex += first;
    to.bodies.push_back(b);
  }
  for (const int b : from.body) to.body.push_back(body + b);
  to.mass.insert(to.mass.end(), from.mass.begin(), from.mass.end());
  to.d_hat.insert(to.d_hat.end(), from.d_hat.begin(), from.d_hat.end());
  to.offset.insert(to.offset.end(), from.offset.begin(), from.offset.end());
  for (const int v : from.surface_vertices) to.surface_vertices.push_back(first + v);
  for (const auto& e : from.surface_edges) to.surface_edges.push_back({first + e[0], first + e[1]});
  const auto triangle = [first](const std::array<int, 3>& t) {
    return std::array{first + t[0], first + t[1], first + t[2]};
  };
  for (const auto& t : from.surface_triangles) to.surface_triangles.push_back(triangle(t));
  for (const auto& t : from.membrane_triangles()) {
    if (to.membranes.empty()) to.membranes.emplace_back();
    to.membranes[0].triangles.push_back(triangle(t));
  }
  for (const Pin& pin : from.pins) to.pins.push_back({first + pin.vertex, 0});
  if (to.motions.empty()) to.motions.push_back({});
  for (Obstacle o : from.obstacles) {
    o.point += shift;
    to.obstacles.push_back(o);
  }
}

/// Two edges, and every third time an edge and a bar, half of d_hat apart: nearly parallel, at an angle from a thousandth
/// of the mollifier's to ten times it, every fourth time close to it. Ends are given as the bits of `given` say.
inline CloseBodies near_parallel(unsigned seed, unsigned given = 0) {
  std::mt19937_64 rng(seed);
  const bool bar = seed % 3 == 0;
  CloseBodies out = bar ? close_to_wall(Piece::edge, Wall::tilted_bar, 1e-3, seed)
                        : close_bodies(Piece::edge, Piece::edge, 1e-3, seed);
  Positions& x = out.scene.x0;
  const Vec3d u = bar ? out.scene.obstacles[0].axis : (x.col(1) - x.col(0)).normalized();
  const Vec3d n = u.unitOrthogonal();
  const double part = seed % 4 == 0 ? 1 + 1e-3 * between(rng, -1, 1) : std::pow(10.0, between(rng, -3, 1));
  const double angle = std::asin(std::sqrt(1e-3)) * part;
  const Vec3d along = std::cos(angle) * u + std::sin(angle) * n.cross(u);
  const TruePair& edges = *std::find_if(out.pairs.begin(), out.pairs.end(), [](const TruePair& p) {
    return p.first.size() == 2 && p.second.size() != 1;
  });
  const double gap = edges.offset + 0.5 * edges.d_hat;
  const Vec3d from = bar ? Vec3d(out.scene.obstacles[0].point + out.scene.obstacles[0].radius * n)
                         : Vec3d((x.col(0) + x.col(1)) / 2);
  const int first = bar ? 0 : 2;
  x.col(first) = from + gap * n - 0.4 * along;
  x.col(first + 1) = from + gap * n + 0.5 * along;
  out.scene.rest = x;
  if (given == 0) return out;
  out.scene.pins.clear();
  for (int v = 0; v < out.scene.n_vertices(); ++v) {
    if ((given >> v & 1U) != 0) out.scene.pins.push_back({v, 0});
  }
  if (out.scene.motions.empty()) out.scene.motions.push_back({});
  return out;
}

/// Several pairs of close bodies, and bodies close to balls and bars, side by side; every ninth vertex given. Activation
/// distances times `reach`.
inline Scene mixed_scene(unsigned seed, bool planar = false, double reach = 1, int n = 6) {
  std::mt19937_64 rng(seed);
  Scene out;
  out.planar = planar;
  const Wall walls[] = {Wall::ball, Wall::bar};
  for (int k = 0; k < n; ++k) {
    const Piece a = all_pieces[rng() % 5], b = all_pieces[1 + rng() % 4];
    const double gap = 0.01 * std::pow(10.0, between(rng, -4, 0));
    const unsigned own = seed * 100 + static_cast<unsigned>(k);
    const CloseBodies close = k % 3 == 2 ? close_to_wall(b, walls[rng() % 2], gap, own, planar)
                                         : close_bodies(std::min(a, b), std::max(a, b), gap, own, planar);
    append(out, close.scene, Vec3d(30 * k, 0, 0) - Vec3d(close.scene.x0.col(0)));
  }
  for (double& d : out.d_hat) d *= reach;
  std::vector<std::uint8_t> given(at(out.n_vertices()), 0);
  for (const Pin& pin : out.pins) given[at(pin.vertex)] = 1;
  for (int v = 4; v < out.n_vertices(); v += 9) {
    if (given[at(v)] == 0) out.pins.push_back({v, 0});
  }
  return out;
}

/// The second body comes towards the first by `way` (m), all vertices of both stray by `stray`.
inline Positions approach(const CloseBodies& bodies, double way, double stray, unsigned seed) {
  std::mt19937_64 rng(seed + 77);
  Positions out = bodies.scene.x0;
  for (int v = 0; v < out.cols(); ++v) {
    out.col(v) += in_box(rng, stray, bodies.scene.planar);
    if (v >= bodies.moving) out.col(v) -= way * bodies.apart;
  }
  return out;
}

}  // namespace bb::test
