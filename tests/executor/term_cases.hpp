// Scenes with stencils that stay, one for every kind of element, load and strain limit, at a state where all of them act.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "barriers/shapes/registry.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/energy/solid_model.hpp"
#include "core/model/bodies/lumping.hpp"
#include "core/model/bodies/scene_builder.hpp"
#include "core/model/mesh/generators.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "core/newton/method.hpp"
#include "tests/barriers/limit_policies.hpp"

namespace bb::test {

inline Method element_method(const char* shape = "cubic") {
  Method out;
  out.contact = {require_shape("cubic"), Argument::gap};
  PolicyConfig policy;
  policy.parameters["kappa_N_per_m"] = 40.0;
  out.stiffness = make_policy(policy);
  out.limit = {require_shape(shape), Argument::gap};
  out.limit_stiffness = fixed_limit(30);
  out.solid_limit_stiffness = fixed_limit(500);
  return out;
}

struct TermCase {
  std::string name;
  Scene scene;
  double size = 0.006;  // m, how far vertices are from rest
  double c = 0.7;       // 0: without inertia, which would hide small terms
  std::function<Method()> method = [] { return element_method(); };
  std::vector<std::string> terms = {};  // which it is there for
  double stretch = 1;                   // of the second state, of both where literal
  bool literal() const { return method().limit.literal; }
};

inline Scene scene_of(const std::vector<BodySpec>& bodies, bool planar = false,
                      const Vec3d& gravity = Vec3d(0, 0, -10)) {
  SceneBuilder builder("case", planar, planar ? Vec3d(0, -10, 0) : gravity, "test");
  for (const BodySpec& body : bodies) builder.add_body(body);
  return builder.finish();
}

inline BodySpec with_pins(BodySpec body, const std::vector<int>& indices) {
  PinSpec pin;
  pin.indices = indices;
  body.pins.push_back(pin);
  return body;
}

/// A cloth with every kind of element, a corner and an edge of it prescribed; in the plane without bending.
inline Scene cloth_scene(const char* model, bool planar, int n = 5) {
  BodySpec body;
  body.name = "cloth";
  body.mesh = grid_mesh(n, n, 1.0, 1.3);
  if (!planar) {  // rest angles that are not 0
    for (Eigen::Index v = 0; v < body.mesh.vertices.cols(); ++v)
      body.mesh.vertices(2, v) = 0.05 * std::sin(3.0 * static_cast<double>(v));
  }
  body.material.model = model;
  if (is_anisotropic(model)) body.material.warp_axis = Vec3d(0.8, 0.6, 0);
  body.material.density = 0.3;
  body.material.youngs = 20;
  body.material.bending = planar ? 0 : 0.01;
  body.material.springs = 3;
  body.material.limit = StrainLimitSpec{0.001, 0.2};
  body.d_hat = 0.01;
  return scene_of({with_pins(body, {0, 1, n * n - 1})}, planar);
}

/// By themselves, so that no stiffer element hides what differs.
inline Scene hinges_alone() {
  Scene out = cloth_scene("arap", false, 6);
  out.membranes.clear();
  out.springs = {};
  out.limit = {};
  out.gravity.setZero();
  return out;
}

/// A helix, and a rod that is straight at rest, so that its corners have theta0 = 0.
inline Scene rods() {
  BodySpec body;
  body.name = "helix";
  body.mesh = helix_mesh(24, 1.5, 0.2, 0.1);
  body.material.line_density = 0.3;
  body.material.rod_stretching = 50;
  body.material.rod_bending = 0.02;
  body.d_hat = 0.001;
  BodySpec straight = body;
  straight.name = "rod";
  straight.mesh = rod_mesh(6, Vec3d(1, 0, 0), Vec3d(1, 1, 0.5));
  return scene_of({with_pins(body, {0, 1}), with_pins(straight, {0, 1})});
}

inline BodySpec block(const std::string& model, const std::string& name, double height) {
  BodySpec body;
  body.name = name;
  body.mesh = solid_box_mesh({2, 3, 2}, Vec3d(0.4, 0.5, 0.3));
  body.mesh.vertices.row(2).array() += height;
  body.material.solid_model = model;
  body.material.solid_youngs = 200;
  body.material.solid_density = 3;
  body.d_hat = 0.01;
  return with_pins(body, {0, 1});
}

/// A block whose limit acts where it is strained(), and a cloth beside it.
inline Scene limited_solid(bool with_cloth) {
  BodySpec cloth;
  cloth.name = "cloth";
  cloth.mesh = grid_mesh(3, 3, 0.5, 0.5);
  cloth.mesh.vertices.row(2).array() += 3;
  cloth.material.density = 0.3;
  cloth.material.youngs = 20;
  cloth.material.limit = StrainLimitSpec{0.001, 0.2};
  cloth.d_hat = 0.01;
  BodySpec solid = block("stable_neo_hookean", "block", 0);
  solid.pins.clear();
  solid.material.limit = StrainLimitSpec{0.001, 0.5, true};
  return with_cloth ? scene_of({cloth, solid}) : scene_of({solid});
}

/// A sheet without elements of its own.
inline BodySpec bare_sheet(const char* name) {
  BodySpec out;
  out.name = name;
  out.mesh = grid_mesh(5, 4, 1.0, 0.8);
  for (Eigen::Index v = 0; v < out.mesh.vertices.cols(); ++v)
    out.mesh.vertices(2, v) = 0.1 * std::sin(3.0 * static_cast<double>(v));
  out.material.model = "none";
  out.material.density = 0.3;
  out.d_hat = 1e-3;
  return out;
}
template <class Set>
Scene sheet_with(const Set& set) {
  BodySpec sheet = bare_sheet("sheet");
  set(sheet.material);
  return scene_of({sheet}, false, Vec3d::Zero());
}

/// A weight group of every vertex, and a mix of it that grows.
inline std::vector<WeightShare> weigh(BodySpec& body) {
  WeightGroup& group = body.weights.emplace_back();
  group.name = "waves";
  for (Eigen::Index v = 0; v < body.mesh.vertices.cols(); ++v)
    group.weight.push_back(0.5 + 0.5 * std::cos(2.0 * static_cast<double>(v)));
  return {{"waves", 1, {{0, 0.2}, {1, 1}}}};
}

/// weighted: by a mix over time.
inline Scene pulled(bool weighted = false) {
  BodySpec sheet = bare_sheet("sheet");
  const std::vector<WeightShare> mix = weigh(sheet);
  for (const int v : {3, 12}) {
    PinSpec& pin = sheet.pins.emplace_back();
    pin.indices = {v, v + 1};
    pin.pull = 4.0 * v;
    if (weighted) pin.mix = mix;
    pin.pull_factors = {{0, 1}, {1, 0.25}};
    pin.motion.velocity = Vec3d(0.2, -0.1, 0.4);
    pin.motion.angular_velocity = 0.7;
  }
  return scene_of({sheet}, false, Vec3d::Zero());
}

/// The vertex that is held has no mass, and so no drag.
inline Scene in_wind(Lumping lumping = Lumping::barycentric) {
  SceneBuilder builder("in wind", false, Vec3d::Zero(), "test");
  builder.set_air({0.9, 0.2, Vec3d::Zero(), {{0, Vec3d(1, 2, -1)}, {1, Vec3d(0, -3, 5)}}});
  BodySpec sheet = with_pins(bare_sheet("sheet"), {0});
  sheet.material.lumping = lumping;
  builder.add_body(sheet);
  return builder.finish();
}

/// strength (N) of each, if any.
inline Scene stitched(std::optional<double> strength = std::nullopt) {
  SceneBuilder builder("stitched", false, Vec3d::Zero(), "test");
  builder.add_body(bare_sheet("lower"));
  BodySpec upper = bare_sheet("upper");
  upper.mesh.vertices.row(2).array() += 0.3;
  builder.add_body(upper);
  builder.add_stitch({"lower", "upper", {0, 3, 7}, {1, 3, 6}, 6, 0, strength}, "/stitches/0");
  builder.add_stitch({"lower", "upper", {11, 15}, {11, 14}, 9, 0.5}, "/stitches/1");  // pushes
  return builder.finish();
}

/// Two balls, one with a pressure that changes. weighted: that one by a mix over time, split as its mass is.
inline Scene inflated(bool weighted = false) {
  std::vector<BodySpec> balls;
  for (const int i : {0, 1}) {
    BodySpec& ball = balls.emplace_back(bare_sheet("ball"));
    ball.name += std::to_string(i);
    ball.mesh = icosphere_mesh(i + 1, 0.5);
    ball.mesh.vertices.row(0).array() += 2 * i;
    if (i == 0) ball.pressure = 30;
    if (i == 1) ball.pressure_keys = {{0, 20}, {1, 40}};
    if (i == 0 || !weighted) continue;
    ball.mesh.vertices.row(1) *= 2.5;
    ball.material.lumping = Lumping::mixed_voronoi;
    ball.pressure_mix = weigh(ball);
  }
  return scene_of(balls, false, Vec3d::Zero());
}

/// Elements and loads: every membrane in space and in the plane, hinges, rods, every solid.
inline std::vector<TermCase> element_cases() {
  std::vector<TermCase> out;
  for (const MembraneModel<double>& model : membrane_models<double>()) {
    for (const bool planar : {false, true}) {
      out.push_back({std::string(model.name) + (planar ? " in the plane" : ""),
                     cloth_scene(model.name.data(), planar, 4)});
      out.back().terms = {"inertia", "external_force", "membrane", "springs", "strain_limit"};
    }
  }
  out.push_back({"hinges", hinges_alone(), 0.3, 0});  // some triangles turn over
  out.back().terms = {"hinges"};
  out.push_back({"rods", rods(), 0.05});
  out.back().terms = {"rods"};
  for (const SolidModel<double>& model : solid_models<double>()) {
    const std::string name(model.name);
    out.push_back({name, scene_of({block(name, "block", 0)}), 0.08});
    out.back().terms = {"tetrahedra"};
  }
  out.push_back({"two models", scene_of({block("stvk", "one", 0), block("arap", "other", 2)}), 0.08});
  return out;
}

/// What is given as a function of time or moves its rest shape.
inline std::vector<TermCase> driven_cases() {
  std::vector<TermCase> out;
  const auto add = [&out](const char* name, const char* term, Scene scene) {
    out.push_back({name, std::move(scene), 0.05, 0});
    out.back().terms = {term};
  };
  add("pulls", "pull", pulled());
  add("drag", "air_drag", in_wind());
  add("pressure", "inflation", inflated());
  add("weighted pulls", "pull", pulled(true));
  add("split drag", "air_drag", in_wind(Lumping::mixed_voronoi));
  add("weighted pressure", "inflation", inflated(true));
  add("stitches", "stitch", stitched());
  add("stitches that break", "stitch", stitched(2.0));
  add("springs of cloth", "cloth_springs", sheet_with([](Material& m) {
        m.cloth_tension = 3, m.cloth_tension_growing = 2, m.cloth_compression = 1;
        m.cloth_compression_growing = 0.5, m.cloth_exponent = 4;
      }));
  add("springs that shrink and creep", "cloth_springs", sheet_with([](Material& m) {
        m.cloth_tension = 3, m.cloth_compression = 1, m.cloth_tension_growing = 1;
        m.cloth_yield = 0.01, m.cloth_creep = 5, m.shrink_keys = {{0, 1}, {1, 0.7}};
      }));
  add("bending that grows", "hinges", sheet_with([](Material& m) {
        m.bending = 0.01, m.bending_exponential = 0.02, m.bending_exponent = 3;
      }));
  add("bending that creeps", "hinges",
      sheet_with([](Material& m) { m.bending = 0.01, m.bending_yield = 0.02, m.bending_creep = 4; }));
  add("bending whose rest shape moves", "hinges", sheet_with([](Material& m) {
        m.bending = 0.01, m.bending_creep = 4, m.shrink_keys = {{0, 1}, {1, 0.7}};
      }));
  add("bending that grows and creeps", "hinges", sheet_with([](Material& m) {
        m.bending = 0.01, m.bending_exponential = 0.02, m.bending_yield = 0.02, m.bending_creep = 4;
      }));
  add("triangles that shrink and creep", "membrane", sheet_with([](Material& m) {
        m.model = "arap", m.youngs = 20, m.membrane_yield = 0.01, m.membrane_creep = 5;
        m.shrink_keys = {{0, 1}, {1, 0.7}};
      }));
  return out;
}

/// Strain limits of triangles in space and in the plane and of tetrahedra, with and without triangles beside them: every barrier in every
/// form, every rule of the stiffness.
inline std::vector<TermCase> limit_cases() {
  struct Form {
    std::string name;
    std::function<Method()> method;
  };
  std::vector<Form> forms;
  for (const char* shape : {"log", "log_squared", "quadratic", "cubic", "two_stage", "exponential",
                            "minimax_bounded", "minimax"}) {
    for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
      for (const bool literal : {false, true}) {
        forms.push_back({std::string(shape) + (argument == Argument::gap ? "" : " of the squared gap") +
                             (literal ? ", literal" : ""),
                         [=] {
                           Method out = element_method(shape);
                           out.limit.argument = argument, out.limit.literal = literal;
                           return out;
                         }});
      }
    }
  }
  const auto add_rule = [&forms](const char* shape, const ElasticityInclusive& rule) {
    forms.push_back({std::string(shape) + ", rule " + std::to_string(forms.size()), [=] {
                       Method out = element_method(shape);
                       out.limit_stiffness = elastic_limit(rule, 1.7);
                       out.solid_limit_stiffness = elastic_limit(rule, 1.3);
                       return out;
                     }});
  };
  constexpr auto dropped = KappaDerivative::dropped, included = KappaDerivative::included;
  for (const MassTerm mass : {MassTerm::paper, MassTerm::inertia, MassTerm::scaled, MassTerm::none})
    add_rule("cubic", {mass, true, Refresh::per_iteration, 0.01, dropped});
  add_rule("cubic", {MassTerm::paper, false, Refresh::per_step, 0.01, dropped});
  for (const char* shape : {"quadratic", "cubic"})
    add_rule(shape, {MassTerm::paper, true, Refresh::per_step, 0.01, included});
  std::vector<TermCase> out;
  for (const Form& form : forms) {
    out.push_back({form.name, cloth_scene("corotational", false, 4)});
    out.push_back({form.name + " in the plane", cloth_scene("corotational", true, 4)});
    out.push_back({form.name + " of solids", limited_solid(false)});
    out.push_back({form.name + " of solids beside cloth", limited_solid(true)});
    for (std::size_t i = out.size() - 4; i < out.size(); ++i) {
      out[i].method = form.method, out[i].terms = {"strain_limit"};
      const bool solid = i + 2 >= out.size();
      if (solid)
        out[i].size = 0.004, out[i].stretch = 1.07;  // so that all three stretches of elements are limited
      if (out[i].literal()) out[i].stretch = solid ? 1.7 : 1.3;  // beyond the limit
    }
  }
  return out;
}

inline std::vector<TermCase> all_cases() {
  std::vector<TermCase> out = element_cases();
  for (const auto more : {driven_cases, limit_cases}) {
    for (TermCase& one : more()) out.push_back(std::move(one));
  }
  return out;
}

/// Away from rest, compressed one way and stretched the other, so that elements have negative eigenvalues and the
/// limit acts; in the plane where the scene is.
inline Positions strained(const Scene& scene, double size = 0.006) {
  Positions x = scene.x0;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x.data()[i] += size * std::sin(1.7 * static_cast<double>(i) + 0.4);
  x.row(0) *= 0.97;
  x.row(1) *= 1.05;
  if (scene.planar) x.row(2) = scene.x0.row(2);
  return x;
}

inline Positions wave(const Scene& scene, double size) {
  Positions dx(3, scene.n_vertices());
  for (Eigen::Index i = 0; i < dx.size(); ++i)
    dx.data()[i] = size * std::cos(2.9 * static_cast<double>(i) + 1);
  if (scene.planar) dx.row(2).setZero();
  return dx;
}

inline StepFrame step_frame(const Scene& scene, double c = 0.7) {
  StepFrame frame;
  frame.x_n = scene.x0;
  frame.x_tilde = scene.x0 + 0.01 * wave(scene, 1);
  frame.dt = 0.05;
  frame.c = c;
  frame.load_factor = 0.9;
  frame.t_end = 0.3;
  return frame;
}

}  // namespace bb::test
