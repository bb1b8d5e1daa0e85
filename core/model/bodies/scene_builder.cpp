#include "core/model/bodies/scene_builder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/input/memory.hpp"
#include "core/math/stop_request.hpp"
#include "core/model/bodies/film_checks.hpp"
#include "core/model/bodies/lumping.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/bodies/pin_selection.hpp"
#include "core/model/bodies/scene_checks.hpp"
#include "core/model/bodies/weights.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

void append_columns(Positions& all, const Positions& more) {
  const Eigen::Index n = all.cols();
  all.conservativeResize(3, n + more.cols());
  all.rightCols(more.cols()) = more;
}

}  // namespace

SceneBuilder::SceneBuilder(std::string name, bool planar, const Vec3d& gravity, std::string where)
    : where_(std::move(where)) {
  scene_.name = std::move(name);
  scene_.planar = planar;
  scene_.gravity = gravity;
  scene_.rest.resize(3, 0);
  scene_.x0.resize(3, 0);
  scene_.v0.resize(3, 0);
  if (!gravity.allFinite()) complain("gravity", "a non-finite value", "finite numbers");
  if (planar && gravity[2] != 0) complain("gravity", "a z component", "x and y only: the scene is planar");
}

void SceneBuilder::set_gravity(std::vector<GravityKey> keys) {
  for (const GravityKey& key : keys) {
    if (scene_.planar && key.value[2] != 0) {
      complain("gravity", "a z component", "x and y only: the scene is planar");
    }
  }
  if (!keys.empty()) scene_.gravity = keys.front().value;
  scene_.gravity_keys = std::move(keys);
}

void SceneBuilder::complain(const std::string& what, std::string found, std::string allowed) {
  violations_.push_back({where_ + ": " + what, std::move(found), std::move(allowed)});
}

void SceneBuilder::check_name(const std::string& what, const std::string& name) {
  if (name.empty()) complain(what, "no name", "a name");
  if (std::find(names_.begin(), names_.end(), name) != names_.end()) {
    complain(what + " \"" + name + '"', "a name used twice", "one body or obstacle a name");
  }
  names_.push_back(name);
}

void SceneBuilder::add_body(const BodySpec& spec) {
  heed_stop();
  check_name("body", spec.name);
  const std::size_t before = violations_.size();
  check_body(spec, scene_.planar, where_, violations_);
  require_room(spec);
  if (violations_.size() != before) return;
  const int first = scene_.n_vertices();
  const Positions& start = spec.start ? *spec.start : spec.mesh.vertices;
  append_vertices(spec, start);
  append_pins(spec, start, first);
  if (spec.kind == BodyKind::deformable) {
    append_masses(spec, first);
    append_elements(spec, first);
    if (spec.rest_film || !spec.material.shrink_keys.empty()) {
      scene_.rest_motions.push_back(
          {first, spec.mesh.n_vertices(), spec.rest_film, spec.material.shrink_keys});
    }
  }
  append_surface(spec, first);
}

void SceneBuilder::require_room(const BodySpec& spec) const {
  std::vector<MemoryItem> items{
      vertex_memory(static_cast<double>(scene_.n_vertices()) + spec.mesh.n_vertices())};
  for (const PartEntry& entry : part_entries()) {
    const std::vector<MemoryItem> more = entry.part.memory(scene_, spec.mesh);
    items.insert(items.end(), more.begin(), more.end());
  }
  require_memory(fmt::format("{}: body \"{}\"", where_, spec.name), items);
}

void SceneBuilder::append_vertices(const BodySpec& spec, const Positions& start) {
  const auto n = static_cast<std::size_t>(spec.mesh.n_vertices());
  const int body = static_cast<int>(scene_.bodies.size());
  scene_.bodies.push_back({spec.name, scene_.n_vertices(), static_cast<int>(n), spec.friction,
                           spec.restitution, spec.friction_static});
  append_columns(scene_.rest, spec.mesh.vertices);
  append_columns(scene_.x0, start);
  const Vec3d velocity = spec.kind == BodyKind::deformable ? spec.velocity : Vec3d(Vec3d::Zero());
  append_columns(scene_.v0, velocity.replicate(1, static_cast<Eigen::Index>(n)));
  scene_.mass.resize(scene_.mass.size() + n, 0.0);
  scene_.body.resize(scene_.body.size() + n, body);
  scene_.d_hat.resize(scene_.d_hat.size() + n, spec.d_hat);
  scene_.offset.resize(scene_.offset.size() + n, spec.offset);
  pin_of_.resize(pin_of_.size() + n, -1);
  held_.resize(pin_of_.size(), -1);
  groups_.push_back(spec.collision_group);
  weights_.push_back(spec.weights);
}

int SceneBuilder::motion_index(PrescribedMotion motion, int first_vertex) {
  motion.first_vertex = first_vertex;
  for (std::size_t i = 0; i < scene_.motions.size(); ++i) {
    if (same_motion(scene_.motions[i], motion)) return static_cast<int>(i);
  }
  scene_.motions.push_back(std::move(motion));
  return static_cast<int>(scene_.motions.size()) - 1;
}

void SceneBuilder::pin_vertex(const std::string& body, const Pin& pin) {
  const auto v = static_cast<std::size_t>(pin.vertex);
  if (pin_of_[v] >= 0) {
    const Pin& other = scene_.pins[static_cast<std::size_t>(pin_of_[v])];
    const bool same_span = other.span.hold == pin.span.hold && other.span.release == pin.span.release;
    if (other.motion != pin.motion || !same_span) {
      complain("pins of body \"" + body + '"',
               fmt::format("two {} for scene vertex {}", same_span ? "motions" : "spans of time", pin.vertex),
               "one motion, hold_s and release_s");
    }
    return;
  }
  pin_of_[v] = static_cast<int>(scene_.pins.size());
  if (pin.span.always()) held_[v] = pin_of_[v];
  scene_.pins.push_back(pin);
  if (pin.span.hold > 0) return;  // it starts free
  const PrescribedMotion& motion = scene_.motions[static_cast<std::size_t>(pin.motion)];
  if (motion.film) scene_.x0.col(pin.vertex) = pin_pose(scene_, pin, 0);  // to the last digit
  scene_.v0.col(pin.vertex) = motion.start_velocity(pin.vertex, scene_.x0.col(pin.vertex));
}

void SceneBuilder::append_pins(const BodySpec& spec, const Positions& start, int first) {
  if (spec.kind == BodyKind::rigid) {
    const int motion = motion_index(spec.motion, first);
    std::vector<int> all(static_cast<std::size_t>(spec.mesh.n_vertices()));
    std::iota(all.begin(), all.end(), 0);
    check_film_start({fmt::format("{}: body \"{}\"", where_, spec.name), violations_}, "/motion", spec.motion,
                     start, all);
    for (int v = 0; v < spec.mesh.n_vertices(); ++v) pin_vertex(spec.name, {first + v, motion});
    return;
  }
  for (std::size_t p = 0; p < spec.pins.size(); ++p) {
    const std::vector<int> selected = select_vertices(spec.pins[p], spec, start, scene_.planar);
    if (selected.empty()) {
      complain(fmt::format("pins/{} of body \"{}\"", p, spec.name), "no vertex selected",
               "at least one vertex");
      continue;
    }
    const int motion = motion_index(spec.pins[p].motion, first);
    if (!spec.pins[p].pull && !(spec.pins[p].span.hold > 0)) {
      check_film_start({fmt::format("{}: body \"{}\"", where_, spec.name), violations_},
                       fmt::format("/pins/{}/motion", p), spec.pins[p].motion, start, selected);
    }
    Pull pull{{}, motion, spec.pins[p].pull.value_or(0), spec.pins[p].pull_factors, spec.pins[p].span, {}};
    for (const int v : selected) {
      if (v >= spec.mesh.n_vertices()) {
        complain(fmt::format("pins/{} of body \"{}\"", p, spec.name), fmt::format("vertex {}", v),
                 fmt::format("0 to {}", spec.mesh.n_vertices() - 1));
      } else if (spec.pins[p].pull) {
        pull.vertices.push_back(first + v);
      } else {
        pin_vertex(spec.name, {first + v, motion, spec.pins[p].span});
      }
    }
    if (!spec.pins[p].pull) continue;
    pull.weights = mix_of(spec, spec.pins[p].mix, pull.vertices, first);
    scene_.pulls.push_back(std::move(pull));
  }
  check_pulls(spec.name);
}

void SceneBuilder::check_pulls(const std::string& body) {
  for (const Pull& pull : scene_.pulls) {
    for (const int v : pull.vertices) {
      if (pin_of_[static_cast<std::size_t>(v)] < 0) continue;
      return complain("pins of body \"" + body + '"', fmt::format("scene vertex {} prescribed and pulled", v),
                      "one of both");
    }
  }
}

void SceneBuilder::append_masses(const BodySpec& spec, int first) {
  const AddMass add = [&](int v, double mass) {
    const auto vertex = static_cast<std::size_t>(first) + static_cast<std::size_t>(v);
    if (held_[vertex] < 0) scene_.mass[vertex] += mass;
  };
  for (const PartEntry& entry : part_entries()) entry.part.add_masses(spec, add);
}

void SceneBuilder::append_elements(const BodySpec& spec, int first) {
  const Complaints complain{fmt::format("{}: body \"{}\"", where_, spec.name), violations_};
  const StiffnessFactors stiffness(spec);
  BodyElements to{scene_, first, held_, complain, stiffness};
  for (const PartEntry& entry : part_entries()) entry.part.add_elements(spec, to);
  if (!spec.material.limit) return;
  for (const auto& local : spec.mesh.triangles) {
    const auto t = to.in_scene(local);
    if (to.all_prescribed(t)) continue;
    scene_.limit.triangles.push_back(t);
    scene_.limit.onset.push_back(spec.material.limit->onset);
    scene_.limit.width.push_back(spec.material.limit->width);
    scene_.limit.mass.push_back(spec.material.density * area_vector(spec.mesh.vertices, local).norm());
  }
  if (!spec.material.limit->solids) return;
  for (const auto& local : spec.mesh.tetrahedra) {
    const auto t = to.in_scene(local);
    if (to.all_prescribed(t)) continue;
    scene_.solid_limit.tetrahedra.push_back(t);
    scene_.solid_limit.onset.push_back(spec.material.limit->onset);
    scene_.solid_limit.width.push_back(spec.material.limit->width);
    scene_.solid_limit.mass.push_back(spec.material.solid_density *
                                      tetrahedron_volume(spec.mesh.vertices, local));
  }
}

void SceneBuilder::append_surface(const BodySpec& spec, int first) {
  BodySurface surface;
  surface.enclosed.assign(static_cast<std::size_t>(spec.mesh.n_vertices()), 0);
  for (const PartEntry& entry : part_entries()) entry.part.add_surface(spec.mesh, surface);
  const auto in_scene = [first](auto vertices) {
    for (int& v : vertices) v += first;
    return vertices;
  };
  append_load_parts(spec, surface.mesh.triangles, scene_.surface_triangles.size(), scene_.corner_parts);
  for (const auto& t : surface.mesh.triangles) scene_.surface_triangles.push_back(in_scene(t));
  closed_.push_back(surface.mesh.segments.empty() && !surface.mesh.triangles.empty() &&
                    !open_side(surface.mesh.triangles));
  if (spec.pressure != 0 || !spec.pressure_keys.empty()) append_pressure(spec, surface.mesh.triangles, first);
  if (!scene_.planar) {
    for (const auto& e : unique_edges(surface.mesh)) scene_.surface_edges.push_back(in_scene(e));
  } else {  // whatever pairs contact makes of them
    for (const auto& e : boundary_edges(surface.mesh.triangles)) scene_.surface_edges.push_back(in_scene(e));
    for (const auto& s : surface.mesh.segments) scene_.surface_edges.push_back(in_scene(s));
  }
  for (int v = 0; v < spec.mesh.n_vertices(); ++v) {
    if (surface.enclosed[static_cast<std::size_t>(v)] == 0) scene_.surface_vertices.push_back(first + v);
  }
}

void SceneBuilder::add_obstacle(const Obstacle& obstacle) {
  check_name("obstacle", obstacle.name);
  check_obstacle(obstacle, scene_.planar, where_, violations_);
  scene_.obstacles.push_back(obstacle);
}

/// Without mass, elements and surface. Its contact distances are those of the first vertex, so that no least or largest one
/// changes; nothing reads them.
void SceneBuilder::append_obstacle_vertices() {
  for (Obstacle& obstacle : scene_.obstacles) {
    if (obstacle.motion.is_static()) continue;
    obstacle.vertex = scene_.n_vertices();
    scene_.body.push_back(static_cast<int>(scene_.bodies.size()));
    scene_.bodies.push_back({obstacle.name, obstacle.vertex, 1, obstacle.friction, obstacle.restitution,
                             obstacle.friction_static});
    append_columns(scene_.rest, obstacle.point);
    append_columns(scene_.x0, obstacle.point);
    append_columns(scene_.v0, Vec3d(Vec3d::Zero()));
    scene_.mass.push_back(0);
    scene_.d_hat.push_back(scene_.d_hat.front());
    scene_.offset.push_back(0);
    pin_of_.push_back(-1);
    held_.push_back(-1);
    pin_vertex(obstacle.name, {obstacle.vertex, motion_index(obstacle.motion, obstacle.vertex)});
  }
}

Scene SceneBuilder::finish() {
  heed_stop();
  if (scene_.n_vertices() > 0) append_obstacle_vertices();
  if (violations_.empty()) append_collisions();
  check_scene(scene_, held_, where_, violations_);
  if (!violations_.empty()) throw ConfigError(std::move(violations_));
  return std::move(scene_);
}

}  // namespace bb
