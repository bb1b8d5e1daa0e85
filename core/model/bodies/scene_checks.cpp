#include "core/model/bodies/scene_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/model/bodies/film_checks.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/bodies/weights.hpp"
#include "core/model/mesh/bounds.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

/// Keys of a part that the mesh has nothing for; returns whether there are any. What switches elements off may stand, and
/// what follows from another key is not reported of it too.
bool refuse_without_subject(const Complaints& complain, const BodySpec& spec, const Part& part) {
  Settings<Material> keys("");
  part.add_keys(keys);
  const ParameterList list = keys.rows();
  const Material usual;
  const std::size_t before = complain.out.size();
  for (const bool computed : {false, true}) {
    if (complain.out.size() > before) return true;
    for (const Parameter& row : list.rows) {
      const std::string_view lacks = part.lacks(spec.mesh, row.name);
      if (lacks.empty() || row.rule.computed.empty() == computed) continue;
      const nlohmann::json value = keys.write_one(row.name, spec.material);
      const bool as_usual = value == to_json(row.fallback) || value == keys.write_one(row.name, usual);
      if (as_usual || value.is_null() || value == 0 || value == "none") continue;
      complain("/material/" + row.name, value.dump(), fmt::format("nothing: {}", lacks));
    }
  }
  return complain.out.size() > before;
}

void check_material(const Complaints& complain, const BodySpec& spec, bool planar) {
  settings_of<Material>().check_numbers(
      spec.material, [&complain](const std::string& name, double value, const std::string& allowed) {
        complain.number("/material/" + name, value, false, allowed);
      });
  for (const PartEntry& entry : part_entries()) {
    if (!refuse_without_subject(complain, spec, entry.part)) entry.part.check(spec, planar, complain);
  }
  const std::optional<StrainLimitSpec>& limit = spec.material.limit;
  if (!limit) return;
  complain.number("/limit/onset", limit->onset, limit->onset >= 0, "a number >= 0");
  complain.number("/limit/width", limit->width, limit->width > 0, "a number > 0");
}

void check_friction(const Complaints& report, const char* key, const std::optional<double>& mu) {
  if (mu) report.number(key, *mu, *mu >= 0, "a number >= 0");
}

void check_restitution(const Complaints& report, const std::optional<double>& e) {
  if (e) report.number("/restitution", *e, *e >= 0 && *e <= 1, "a number in [0, 1]");
}

/// Every corner is a vertex, every volume positive, and no face belongs to three.
void check_tetrahedra(const Complaints& report, const TriangleMesh& mesh) {
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const auto& corners = mesh.tetrahedra[t];
    const auto [low, high] = std::minmax_element(corners.begin(), corners.end());
    if (*low < 0 || *high >= mesh.n_vertices()) {
      return report("/mesh", fmt::format("tetrahedron {} with an unknown vertex", t),
                    fmt::format("vertices 0 to {}", mesh.n_vertices() - 1));
    }
    const double volume = tetrahedron_volume(mesh.vertices, corners);
    if (volume > 0 && std::isfinite(volume)) continue;
    return report("/mesh", fmt::format("tetrahedron {} of {:g} m^3", t, volume),
                  "volume > 0: corner 3 on the side to which 0 1 2 runs counter-clockwise");
  }
  const int crowded = solid_faces(mesh.tetrahedra).crowded;
  if (crowded < 0) return;
  report("/mesh", fmt::format("tetrahedron {} with a face that two others have too", crowded),
         "faces of one or two tetrahedra");
}

void check_mesh(const Complaints& report, const BodySpec& spec, bool planar) {
  const int n = spec.mesh.n_vertices();
  if (n == 0) report("/mesh", "no vertex", "at least one vertex");
  if (!within_bounds(spec.mesh.vertices))
    report("/mesh", "a coordinate that is too large", allowed_coordinates());
  if (spec.start && spec.start->cols() != n) {
    report("/start", "positions that do not fit the mesh", "one position a vertex");
  } else if (spec.start && !within_bounds(*spec.start)) {
    report("/start", "a coordinate that is too large", allowed_coordinates());
  }
  const auto out_of_range = [n](const auto& element) {
    return std::any_of(element.begin(), element.end(), [n](int v) { return v < 0 || v >= n; });
  };
  if (std::any_of(spec.mesh.triangles.begin(), spec.mesh.triangles.end(), out_of_range) ||
      std::any_of(spec.mesh.segments.begin(), spec.mesh.segments.end(), out_of_range)) {
    report("/mesh", "an element with an unknown vertex", fmt::format("vertices 0 to {}", n - 1));
  } else if (std::any_of(spec.mesh.triangles.begin(), spec.mesh.triangles.end(),
                         [&](const auto& t) { return !(area_vector(spec.mesh.vertices, t).norm() > 0); })) {
    report("/mesh", "a triangle of zero area", "triangles of positive area");
  }
  check_tetrahedra(report, spec.mesh);
  const auto off_plane = [](const Positions& x) { return x.cols() > 0 && !x.row(2).isZero(0); };
  if (planar && (off_plane(spec.mesh.vertices) || (spec.start && off_plane(*spec.start)))) {
    report("/mesh", "a vertex with z != 0", "z = 0: the scene is planar");
  }
}

void check_step(const Complaints& report, const std::string& what, const MotionStep& motion) {
  const bool finite = motion.velocity.allFinite() && motion.center.allFinite() && motion.axis.allFinite() &&
                      std::isfinite(motion.angular_velocity) && std::isfinite(motion.start);
  if (!finite || std::isnan(motion.end)) report(what, "a non-finite motion", "finite numbers");
  if (!(motion.end >= motion.start)) report(what, "an end before the start", "end >= start");
  if (std::abs(motion.axis.norm() - 1) > 1e-9) report(what, "an axis of another length", "a unit axis");
  const bool to_an_end = motion.smooth || motion.scale != 1;
  if (to_an_end && motion.keyframes.empty() && !(motion.end > motion.start && std::isfinite(motion.end))) {
    report(what, "a scale, or smooth, without an end", "a finite end > start");
  }
  report.number(what + "/scale", motion.scale, motion.scale > 0, "a number > 0");
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    const Keyframe& key = motion.keyframes[k];
    const bool good = within_bounds(key.translation) && std::isfinite(key.angle) && std::isfinite(key.time);
    if (!good)
      report(what + "/keyframes", "a keyframe that is not finite or too far out", allowed_coordinates());
    report.number(what + "/keyframes/scale", key.scale, key.scale > 0, "a number > 0");
    if (k > 0 && !(key.time > motion.keyframes[k - 1].time)) {
      report(what + "/keyframes", fmt::format("time {:g} after {:g}", key.time, motion.keyframes[k - 1].time),
             "times that increase (s)");
    }
  }
}

void check_in_plane(const Complaints& report, const std::string& what, const MotionStep& step) {
  const bool out_of_plane =
      step.velocity[2] != 0 || std::any_of(step.keyframes.begin(), step.keyframes.end(),
                                           [](const Keyframe& k) { return k.translation[2] != 0; });
  if (out_of_plane) report(what, "a way with a z component", "0: the scene is planar");
  if (step.most_turning() > 0 && step.axis.cross(Vec3d(Vec3d::UnitZ())).norm() > 1e-9) {
    report(what, "a rotation out of the plane", "a rotation about z: the scene is planar");
  }
}

void check_motion(const Complaints& report, const std::string& what, const PrescribedMotion& motion,
                  bool planar) {
  motion.for_each_step([&](const MotionStep& step) {
    check_step(report, what, step);
    if (planar) check_in_plane(report, what, step);
  });
}

/// Of what is where its motion states: it begins where it is.
void check_given_motion(const Complaints& report, const std::string& what, const PrescribedMotion& motion,
                        bool planar) {
  check_motion(report, what, motion, planar);
  motion.for_each_step([&](const MotionStep& step) {
    if (step.begins_at_start()) return;
    report(what + (step.keyframes.empty() ? "/start" : "/keyframes"),
           "another place than that of the start at the time 0",
           "no way, no angle and scale 1 at the time 0: vertices that are prescribed do not jump");
  });
}

void check_pull(const Complaints& report, const PinSpec& pin) {
  const HoldSpan& span = pin.span;
  if (pin.pull) report.number("/pins/pull", *pin.pull, *pin.pull > 0, "a number > 0");
  if (!(span.release > span.hold)) {
    report("/pins/release", fmt::format("{:g}", span.release),
           fmt::format("a number > {:g}, when it begins to hold (s)", span.hold));
  }
}

/// An obstacle keeps its size, its normal and its axis.
void check_obstacle_motion(const Complaints& report, const Obstacle& obstacle, bool planar) {
  check_given_motion(report, "/motion", obstacle.motion, planar);
  if (obstacle.motion.changes_size()) report("/motion", "a scale", "1: obstacles keep their size");
  obstacle.motion.for_each_step([&](const MotionStep& step) {
    const bool turns = step.most_turning() > 0;
    if (turns && obstacle.kind != ObstacleKind::sphere && step.axis.cross(obstacle.axis).norm() > 1e-9) {
      report("/motion", "a rotation that turns its axis",
             obstacle.kind == ObstacleKind::plane ? "a rotation about the plane's normal"
                                                  : "a rotation about the direction of the cylinder's axis");
    }
  });
}

/// How far apart two free vertices of a body are, across the axis of a cylinder, at least, m: the farthest from the first,
/// and the farthest from that.
double least_width(const Scene& scene, const Body& body, const std::vector<int>& pin_of, const Obstacle& o) {
  const auto apart = [&](int a, int b) {
    const Vec3d r = scene.x0.col(a) - scene.x0.col(b);
    return o.kind == ObstacleKind::sphere ? r.norm() : r.cross(o.axis).norm();
  };
  int first = -1;
  double width = 0;
  for (int sweep = 0; sweep < 2; ++sweep) {
    int farthest = first;
    for (int v = body.first_vertex; v < body.first_vertex + body.n_vertices; ++v) {
      if (pin_of[static_cast<std::size_t>(v)] >= 0) continue;
      if (farthest < 0) first = farthest = v;
      if (apart(v, first) <= width) continue;
      width = apart(v, first);
      farthest = v;
    }
    first = farthest;
  }
  return width;
}

/// What is inside a sphere or a cylinder has to fit in, wherever it starts.
void check_room(const Scene& scene, const std::vector<int>& pin_of, const Complaints& report) {
  for (const Obstacle& o : scene.obstacles) {
    if (!o.inside || o.kind == ObstacleKind::plane) continue;
    for (const Body& body : scene.bodies) {
      const double offset = scene.offset[static_cast<std::size_t>(body.first_vertex)];
      const bool any_free =
          std::any_of(pin_of.begin() + body.first_vertex,
                      pin_of.begin() + body.first_vertex + body.n_vertices, [](int pin) { return pin < 0; });
      const double width = least_width(scene, body, pin_of, o), room = 2 * (o.radius - offset);
      if (!any_free || width < room) continue;
      report(fmt::format("body \"{}\" inside obstacle \"{}\"", body.name, o.name),
             fmt::format("{:.6g} m across", width),
             fmt::format("less than {:.6g} m: twice the radius less the body's offset", room));
    }
  }
}

}  // namespace

void check_body(const BodySpec& spec, bool planar, const std::string& where, std::vector<Violation>& out) {
  const Complaints report{fmt::format("{}: body \"{}\"", where, spec.name), out};
  check_mesh(report, spec, planar);
  report.number("/d_hat", spec.d_hat, spec.d_hat > 0, "a number > 0");
  report.number("/offset", spec.offset, spec.offset >= 0, "a number >= 0");
  check_friction(report, "/friction", spec.friction);
  check_friction(report, "/friction_static", spec.friction_static);
  check_restitution(report, spec.restitution);
  if (!spec.velocity.allFinite()) report("/velocity", "a non-finite value", "finite numbers");
  if (planar && spec.velocity[2] != 0) report("/velocity", "a z component", "0: the scene is planar");
  if (spec.kind == BodyKind::rigid) {
    check_given_motion(report, "/motion", spec.motion, planar);
    check_film(report, "/motion", spec.motion, spec, planar);
  } else {
    check_material(report, spec, planar);
    check_rest_film(report, spec, planar);
    check_weights(report, spec);
    for (const PinSpec& pin : spec.pins) {
      (pin.pull ? check_motion : check_given_motion)(report, "/pins/motion", pin.motion, planar);
      check_film(report, "/pins/motion", pin.motion, spec, planar);
      check_pull(report, pin);
    }
  }
}

void check_obstacle(const Obstacle& obstacle, bool planar, const std::string& where,
                    std::vector<Violation>& out) {
  const Complaints report{fmt::format("{}: obstacle \"{}\"", where, obstacle.name), out};
  if (!within_bounds(obstacle.point))
    report("/point", "a coordinate that is too large", allowed_coordinates());
  if (obstacle.kind != ObstacleKind::sphere && !(std::abs(obstacle.axis.norm() - 1) <= 1e-9)) {
    report("/axis", "an axis of another length", "a unit vector");
  }
  if (obstacle.kind != ObstacleKind::plane) {
    report.number("/radius", obstacle.radius, obstacle.radius > 0 && obstacle.radius <= max_coordinate,
                  "a number > 0 and <= 1e15 m");
  }
  check_friction(report, "/friction", obstacle.friction);
  check_friction(report, "/friction_static", obstacle.friction_static);
  check_restitution(report, obstacle.restitution);
  check_obstacle_motion(report, obstacle, planar);
  if (!planar) return;
  if (obstacle.kind == ObstacleKind::plane && obstacle.axis[2] != 0) {
    report("/axis", "a normal with a z component", "a normal in the x-y plane: the scene is planar");
  }
  if (obstacle.kind == ObstacleKind::sphere && obstacle.point[2] != 0) {
    report("/point", "a centre with z != 0", "z = 0: the scene is planar");
  }
}

void check_scene(const Scene& scene, const std::vector<int>& pin_of, const std::string& where,
                 std::vector<Violation>& out) {
  const Complaints report{where + ": ", out};
  if (scene.bodies.empty() && out.empty()) return report("scene", "no body", "at least one deformable body");
  if (!out.empty()) return;  // bodies were left out: what follows would mislead
  if (static_cast<int>(scene.pins.size()) == scene.n_vertices()) {
    report("scene", "no free vertex", "at least one vertex that is never prescribed");
  }
  for (const Body& body : scene.bodies) {
    int n_bad = 0, first_bad = -1;
    for (int v = body.first_vertex; v < body.first_vertex + body.n_vertices; ++v) {
      const auto i = static_cast<std::size_t>(v);
      if (pin_of[i] >= 0 || (scene.mass[i] > 0 && std::isfinite(scene.mass[i]))) continue;
      if (n_bad++ == 0) first_bad = v - body.first_vertex;
    }
    if (n_bad > 0) {
      report(fmt::format("body \"{}\"", body.name),
             fmt::format("{} free vertices without mass, the first is {}", n_bad, first_bad),
             "positive mass: density > 0 and every free vertex in an element");
    }
  }
  check_room(scene, pin_of, report);
}

}  // namespace bb
