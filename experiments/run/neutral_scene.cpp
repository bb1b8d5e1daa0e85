#include "experiments/run/neutral_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include "core/math/error.hpp"
#include "core/model/scene/contact_plan.hpp"
#include "experiments/run/runner.hpp"
#include "experiments/run/scene_json.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// Terms that the file states everything of.
const std::set<std::string_view> said = {"inertia", "external_force", "membrane", "hinges",
                                         "springs", "rods",           "contact",  "friction"};

/// Of the first n vertices.
json to_json(const Positions& x, int n) {
  json out = json::array();
  for (Eigen::Index i = 0; i < n; ++i) out.push_back(vector_json(Vec3d(x.col(i))));
  return out;
}

[[noreturn]] void refuse(const Scene& scene, std::string_view what, std::string_view allowed) {
  throw ConfigError("scene " + scene.name, std::string(what), std::string(allowed));
}

void check_terms(const Scene& scene, const Plan& plan) {
  for (const PlanItem& item : plan.terms) {
    const auto entry = static_cast<std::size_t>(&item - plan.terms.data());
    const std::string_view name = term_entries()[entry].name;
    if (item.needed && !said.contains(name)) {
      refuse(scene, fmt::format("{} ({})", name, item.reason),
             "membranes, hinges, rods, contact, friction, gravity and prescribed vertices: engines share no "
             "other term");
    }
  }
}

void check_motion(const Scene& scene) {
  if (scene.planar) refuse(scene, "a planar scene", "three dimensions");
  if (!scene.gravity_keys.empty()) refuse(scene, "gravity over time", "constant gravity");
  if (scene.damping.acts()) refuse(scene, "damping of velocities", "none");
  if (!scene.rest_motions.empty()) refuse(scene, "a rest shape that moves", "rest shapes that stay");
  for (const Pin& pin : scene.pins) {
    if (!pin.span.always()) refuse(scene, "a pin that lets go or takes hold", "pins that always hold");
  }
}

/// Whether bodies or obstacles have a coefficient of their own, or there are two of them.
bool has_one_friction(const RunConfig& config, const Scene& scene) {
  const auto own = [](const auto& one) { return one.friction || one.friction_static; };
  return !config.friction.mu_static && std::none_of(scene.bodies.begin(), scene.bodies.end(), own) &&
         std::none_of(scene.obstacles.begin(), scene.obstacles.end(), own);
}

/// Whether a column of rates or stiffnesses, which may be absent, has one.
bool acts(const std::vector<double>& column) {
  return std::any_of(column.begin(), column.end(), [](double value) { return value > 0; });
}

/// The one value of a body, within rounding.   Errors: ConfigError where it has two.
class OneOfEach {
 public:
  OneOfEach(const Scene& scene, std::string_view what) : scene_(scene), what_(what) {}
  void add(int vertex, double value) {
    const int body = scene_.body[static_cast<std::size_t>(vertex)];
    const auto [at, fresh] = values_.emplace(body, value);
    if (!fresh && std::abs(at->second - value) > 1e-12 * std::abs(value)) {
      refuse(scene_,
             fmt::format("body {} with two values of {}", scene_.bodies[static_cast<std::size_t>(body)].name,
                         what_),
             "one");
    }
  }
  double operator()(int body) const {
    const auto at = values_.find(body);
    return at == values_.end() ? 0.0 : at->second;
  }
  bool has(int body) const { return values_.contains(body); }

 private:
  const Scene& scene_;
  std::string what_;
  std::map<int, double> values_;
};

/// What engines have one number of for a body, and a scene may have many. A body without membranes has none of their three.
struct BodyNumbers {
  explicit BodyNumbers(const Scene& scene)
      : mu(scene, "lame_mu"),
        lambda(scene, "lame_lambda"),
        bending(scene, "bending"),
        offset(scene, "offset"),
        d_hat(scene, "d_hat"),
        rod_stretching(scene, "stiffness times length of the springs on lone edges"),
        rod_bending(scene, "bending times length of rods"),
        straight(scene, "rod_rest") {}
  OneOfEach mu, lambda, bending, offset, d_hat, rod_stretching, rod_bending, straight;
  std::map<int, std::string> model;
};

using Edge = std::array<int, 2>;
Edge sorted(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

double rest_length(const Scene& scene, int a, int b) {
  return (scene.rest.col(a) - scene.rest.col(b)).norm();
}

/// A rod of engines has E A and E I: elements have them over their lengths.
void add_rods(const Scene& scene, const std::vector<Edge>& segments, BodyNumbers& numbers) {
  std::set<Edge> lone;
  for (const auto& [a, b] : segments) lone.insert(sorted(a, b));
  for (std::size_t k = 0; k < scene.springs.edges.size(); ++k) {
    const auto [a, b] = scene.springs.edges[k];
    if (!lone.contains(sorted(a, b))) refuse(scene, "springs on edges of triangles", "springs of rods");
    numbers.rod_stretching.add(a, scene.springs.stiffness[k] * rest_length(scene, a, b));
  }
  for (std::size_t k = 0; k < scene.rods.corners.size(); ++k) {
    const auto [a, v, b] = scene.rods.corners[k];
    const double length = 0.5 * (rest_length(scene, a, v) + rest_length(scene, v, b));
    numbers.rod_bending.add(v, scene.rods.stiffness[k] * length);
    numbers.straight.add(v, scene.rods.straight[k] != 0 || scene.rods.rest_angle[k] == 0 ? 1 : 0);
  }
}

void add_membranes(const Scene& scene, BodyNumbers& numbers) {
  for (const MembranePart& part : scene.membranes) {
    if (part.model == "baraff_witkin" || !part.shrink.empty() || !part.creep.empty())
      refuse(scene, "a membrane of " + part.model + " that is anisotropic, shrinks or creeps",
             "an isotropic elastic membrane");
    for (std::size_t k = 0; k < part.triangles.size(); ++k) {
      const int vertex = part.triangles[k][0];
      numbers.mu.add(vertex, part.lame_mu[k]);
      numbers.lambda.add(vertex, part.lame_lambda[k]);
      numbers.model.emplace(scene.body[static_cast<std::size_t>(vertex)], part.model);
    }
  }
}

void add_hinges(const Scene& scene, BodyNumbers& numbers) {
  const HingePart& hinges = scene.hinges;
  if (acts(hinges.exponential) || acts(hinges.creep)) {
    refuse(scene, "hinges that stiffen or creep", "elastic hinges");
  }
  for (std::size_t k = 0; k < hinges.hinges.size(); ++k)
    numbers.bending.add(hinges.hinges[k][0], hinges.stiffness[k]);
}

json body_json(const Body& body, int id, const BodyNumbers& numbers) {
  json row = {{"name", body.name},
              {"first_vertex", body.first_vertex},
              {"vertices", body.n_vertices},
              {"half_thickness_m", numbers.offset(id)},
              {"d_hat_m", numbers.d_hat(id)}};
  if (numbers.mu.has(id)) {
    row["membrane"] = {{"model", numbers.model.at(id)},
                       {"lame_mu_N_per_m", numbers.mu(id)},
                       {"lame_lambda_N_per_m", numbers.lambda(id)}};
  }
  row["hinge_J"] = numbers.bending(id);
  if (numbers.rod_stretching.has(id)) {
    row["rod"] = {{"stretching_N", numbers.rod_stretching(id)}, {"bending_N_m2", numbers.rod_bending(id)}};
    if (numbers.rod_bending(id) > 0) row["rod"]["straight"] = numbers.straight(id) == 1;
  }
  return row;
}

/// Errors: ConfigError for materials that engines do not share, and for bodies of several.
json bodies_json(const Scene& scene, const std::vector<Edge>& segments) {
  BodyNumbers numbers(scene);
  add_membranes(scene, numbers);
  add_hinges(scene, numbers);
  add_rods(scene, segments, numbers);
  for (int i = 0; i < scene.n_body_vertices(); ++i) {
    const auto v = static_cast<std::size_t>(i);
    numbers.offset.add(i, scene.offset[v]);
    numbers.d_hat.add(i, scene.d_hat[v]);
  }
  json out = json::array();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].first_vertex >= scene.n_body_vertices()) break;  // of obstacles that move
    out.push_back(body_json(scene.bodies[b], static_cast<int>(b), numbers));
  }
  return out;
}

/// Points of one that moves are those at the start and at the end of every step.
json obstacles_json(const Scene& scene, const TimeConfig& time) {
  json out = json::array();
  for (const Obstacle& o : scene.obstacles) {
    json row = obstacle_json(o);
    const auto pin = std::find_if(scene.pins.begin(), scene.pins.end(),
                                  [&o](const Pin& one) { return one.vertex == o.vertex; });
    for (int step = 0; pin != scene.pins.end() && step <= time.steps; ++step)
      row["points_m"].push_back(vector_json(pin_pose(scene, *pin, step * time.dt)));
    out.push_back(row);
  }
  return out;
}

/// Of prescribed vertices, at the start and at the end of every step.
json given_json(const Scene& scene, double dt, int steps) {
  std::vector<Pin> pins = scene.pins;
  std::erase_if(pins, [&scene](const Pin& pin) { return pin.vertex >= scene.n_body_vertices(); });
  json vertices = json::array(), positions = json::array();
  for (const Pin& pin : pins) vertices.push_back(pin.vertex);
  const bool rests = std::all_of(pins.begin(), pins.end(), [&scene](const Pin& pin) {
    return scene.motions[static_cast<std::size_t>(pin.motion)].is_static();
  });
  for (int step = 0; step <= (rests ? 0 : steps); ++step) {
    json frame = json::array();
    for (const Pin& pin : pins) frame.push_back(vector_json(pin_pose(scene, pin, step * dt)));
    positions.push_back(frame);
  }
  return {{"vertices", vertices}, {"positions_m", positions}};
}

}  // namespace

json neutral_scene(const RunConfig& config, const Scene& scene, const Plan& plan) {
  check_terms(scene, plan);
  check_motion(scene);
  if (!has_one_friction(config, scene))
    refuse(scene, "frictions of bodies, or a static one", "one friction/mu");
  const int n = scene.n_body_vertices();
  const std::vector<Edge> segments = lone_edges(scene);
  json triangles = json::array();
  for (const auto& t : scene.surface_triangles) triangles.push_back(t);
  json out = {{"schema", "barrierbench.engine_scene/1"},
              {"name", run_label(config)},
              {"dt_s", config.time.dt},
              {"steps", config.time.steps},
              {"gravity_m_s2", vector_json(scene.gravity)},
              {"positions_m", to_json(scene.x0, n)},
              {"rest_m", to_json(scene.rest, n)},
              {"velocities_m_s", to_json(scene.v0, n)},
              {"mass_kg", std::vector<double>(scene.mass.begin(), scene.mass.begin() + n)},
              {"triangles", triangles},
              {"bodies", bodies_json(scene, segments)},
              {"given", given_json(scene, config.time.dt, config.time.steps)},
              {"obstacles", obstacles_json(scene, config.time)}};
  if (!segments.empty()) out["segments"] = segments;
  if (config.friction.mu > 0) out["friction"] = config.friction.mu;
  return out;
}

}  // namespace bb
