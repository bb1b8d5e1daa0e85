#include "experiments/run/neutral_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>

#include "core/math/error.hpp"
#include "experiments/run/runner.hpp"
#include "experiments/run/scene_json.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// Terms that the file states everything of.
const std::set<std::string_view> said = {"inertia", "external_force", "membrane", "hinges", "contact"};

json to_json(const Positions& x) {
  json out = json::array();
  for (Eigen::Index i = 0; i < x.cols(); ++i) out.push_back(vector_json(Vec3d(x.col(i))));
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
             "membranes, hinges, contact, gravity and prescribed vertices: engines share no other term");
    }
  }
}

void check_motion(const Scene& scene) {
  if (scene.planar) refuse(scene, "a planar scene", "three dimensions");
  if (!scene.gravity_keys.empty()) refuse(scene, "gravity over time", "constant gravity");
  if (scene.damping.acts()) refuse(scene, "damping of velocities", "none");
  if (!scene.rest_motions.empty()) refuse(scene, "a rest shape that moves", "rest shapes that stay");
  for (const Obstacle& o : scene.obstacles) {
    if (o.vertex >= 0) refuse(scene, "obstacle " + o.name + " moves", "obstacles that rest");
  }
  for (const Pin& pin : scene.pins) {
    if (!pin.span.always()) refuse(scene, "a pin that lets go or takes hold", "pins that always hold");
  }
}

/// Whether a column of rates or stiffnesses, which may be absent, has one.
bool acts(const std::vector<double>& column) {
  return std::any_of(column.begin(), column.end(), [](double value) { return value > 0; });
}

/// The one value of a body.   Errors: ConfigError where it has two.
class OneOfEach {
 public:
  OneOfEach(const Scene& scene, std::string_view what) : scene_(scene), what_(what) {}
  void add(int vertex, double value) {
    const int body = scene_.body[static_cast<std::size_t>(vertex)];
    const auto [at, fresh] = values_.emplace(body, value);
    if (!fresh && at->second != value) {
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
        d_hat(scene, "d_hat") {}
  OneOfEach mu, lambda, bending, offset, d_hat;
  std::map<int, std::string> model;
};

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
  return row;
}

/// Errors: ConfigError for materials that engines do not share, and for bodies of several.
json bodies_json(const Scene& scene) {
  BodyNumbers numbers(scene);
  add_membranes(scene, numbers);
  add_hinges(scene, numbers);
  for (int i = 0; i < scene.n_vertices(); ++i) {
    const auto v = static_cast<std::size_t>(i);
    numbers.offset.add(i, scene.offset[v]);
    numbers.d_hat.add(i, scene.d_hat[v]);
  }
  json out = json::array();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    out.push_back(body_json(scene.bodies[b], static_cast<int>(b), numbers));
  return out;
}

json obstacles_json(const Scene& scene) {
  json out = json::array();
  for (const Obstacle& o : scene.obstacles) out.push_back(obstacle_json(o));
  return out;
}

/// Of prescribed vertices, at the start and at the end of every step.
json given_json(const Scene& scene, double dt, int steps) {
  json vertices = json::array(), positions = json::array();
  for (const Pin& pin : scene.pins) vertices.push_back(pin.vertex);
  const bool rests = std::all_of(scene.pins.begin(), scene.pins.end(), [&scene](const Pin& pin) {
    return scene.motions[static_cast<std::size_t>(pin.motion)].is_static();
  });
  for (int step = 0; step <= (rests ? 0 : steps); ++step) {
    json frame = json::array();
    for (const Pin& pin : scene.pins) frame.push_back(vector_json(pin_pose(scene, pin, step * dt)));
    positions.push_back(frame);
  }
  return {{"vertices", vertices}, {"positions_m", positions}};
}

}  // namespace

json neutral_scene(const RunConfig& config, const Scene& scene, const Plan& plan) {
  check_terms(scene, plan);
  check_motion(scene);
  json triangles = json::array();
  for (const auto& t : scene.surface_triangles) triangles.push_back(t);
  return {{"schema", "barrierbench.engine_scene/1"},
          {"name", run_label(config)},
          {"dt_s", config.time.dt},
          {"steps", config.time.steps},
          {"gravity_m_s2", vector_json(scene.gravity)},
          {"positions_m", to_json(scene.x0)},
          {"rest_m", to_json(scene.rest)},
          {"velocities_m_s", to_json(scene.v0)},
          {"mass_kg", scene.mass},
          {"triangles", triangles},
          {"bodies", bodies_json(scene)},
          {"given", given_json(scene, config.time.dt, config.time.steps)},
          {"obstacles", obstacles_json(scene)}};
}

}  // namespace bb
