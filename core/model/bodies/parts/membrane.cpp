// Membranes: the triangles of a body, their mass and surface; elements of the model that the body names, out of the registry of
// membrane models (core/energy/registry.inc).
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/parameters/registry.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/math/svd.hpp"
#include "core/model/bodies/lumping.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/bodies/plasticity.hpp"
#include "core/model/bodies/poisson_check.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

using nlohmann::json;

constexpr double config_youngs = 100;  // N/m, of a material that gives none

/// Lame parameters of a shell in plane stress, times the thickness, N/m:
///   mu = E t / (2 (1 + nu)), lambda = E t nu / (1 - nu^2).
struct LameParameters {
  double mu = 0, lambda = 0;  // N/m
};
LameParameters shell_lame(double youngs_per_width, double poisson) {
  return {youngs_per_width / (2 * (1 + poisson)), youngs_per_width * poisson / (1 - poisson * poisson)};
}

/// The one member `youngs` has two names: times thickness where there is none.
void add_youngs(Settings<Material>& out) {
  out.add_row(
      {"youngs_Pa", positive("Pa"), no_default, "Young's modulus; needs thickness_m."},
      [](const json* given, Material& m) { m.youngs = given ? given->get<double>() : config_youngs; },
      [](const Material& m) { return m.thickness ? json(m.youngs) : json(); });
  out.add_row(
      {"youngs_N_per_m", positive("N/m"), config_youngs, "Young's modulus times thickness."},
      [](const json* given, Material& m) { m.youngs = given ? given->get<double>() : m.youngs; },
      [](const Material& m) { return m.thickness ? json() : json(m.youngs); });
}

}  // namespace

template <>
Settings<ShrinkKey> list_of() {
  Settings<ShrinkKey> out("Factor on rest lengths at a time.");
  out.add("time_s", required(any_number("s")), "Later than that of the key before.", &ShrinkKey::time);
  out.add("factor", required(positive("1")),
          "Linear between keys, constant before the first and after the last.", &ShrinkKey::value);
  return out;
}

namespace {

/// Whether something of the material is along the warp axis.
bool has_direction(const Material& m) { return is_anisotropic(m.model) || m.shrinks_along_warp(); }

void check_warp_axis(const Complaints& complain, const Material& m, bool planar) {
  if (!m.warp_axis) return;
  const Vec3d& axis = *m.warp_axis;
  const std::string found = fmt::format("[{}, {}, {}]", axis[0], axis[1], axis[2]);
  if (!has_direction(m)) {
    complain("/material/warp_axis", found,
             "nothing: the model " + m.model + " has no direction, and shrinking neither");
  } else if (!(std::abs(axis.norm() - 1) < 1e-9)) {
    complain("/material/warp_axis", found, "a unit vector");
  } else if (planar && axis[2] != 0) {
    complain("/material/warp_axis", found, "z = 0: the scene is planar");
  }
}

/// Shrinking and creep where there is nothing that they act on, or something that they leave out.
void check_rest(const Complaints& complain, const BodySpec& spec) {
  const Material& m = spec.material;
  const auto refuse = [&](const char* key, double found, const std::string& allowed) {
    complain(std::string("/material/") + key, fmt::format("{}", found), allowed);
  };
  const char* shrink = m.shrink_warp != 1 ? "shrink_warp" : "shrink_weft";
  const double factor = m.shrink_warp != 1 ? m.shrink_warp : m.shrink_weft;
  for (const ShrinkKey& key : m.shrink_keys) {
    if (key.value > 0 && std::isfinite(key.value)) continue;
    refuse("shrink_schedule", key.value, "factors > 0");
  }
  if (m.shrinks() && m.springs > 0) {
    refuse(shrink, factor,
           "1 with springs_N_per_m, whose lengths are those of the mesh; shrink_schedule shrinks them");
  } else if (m.shrinks() && m.model == "none" && !m.has_sides() && !m.has_diagonals()) {
    refuse(shrink, factor, "1 without a membrane model and without springs of cloth: nothing shrinks");
  }
  if (m.membrane_yield > 0 && m.creep_rate(m.membrane_creep) == 0) {
    refuse("membrane_yield", m.membrane_yield,
           "0 without membrane_creep_per_s or plasticity: nothing yields");
  }
  check_plasticity(complain, m);
  if (m.membrane_creep > 0 && m.model == "none") {
    refuse("membrane_creep_per_s", m.membrane_creep, "0 without a membrane model");
  }
}

/// The warp axis needs a part in the plane of every triangle that has an energy.
void check_warp(const BodySpec& spec, const Vec3d& warp, const BodyElements& to) {
  for (std::size_t t = 0; t < spec.mesh.triangles.size(); ++t) {
    if (to.all_prescribed(to.in_scene(spec.mesh.triangles[t]))) continue;
    const Vec3d normal = area_vector(spec.mesh.vertices, spec.mesh.triangles[t]).normalized();
    if ((warp - normal.dot(warp) * normal).norm() > 1e-6) continue;
    return to.complain("/material/warp_axis",
                       fmt::format("[{}, {}, {}], the normal of triangle {}", warp[0], warp[1], warp[2], t),
                       "an axis that is normal to no triangle of the rest shape");
  }
}

/// Appends what a triangle of the scene at rest has in the columns that stay empty where no body needs them. The
/// first edge as warp direction is that of an empty column.
void append_options(const Material& m, const Scene& scene, MembranePart& part) {
  const std::size_t n = part.triangles.size();
  if (has_direction(m) || !part.warp.empty()) {
    while (part.warp.size() < n) {
      const auto& t = part.triangles[part.warp.size()];
      part.warp.emplace_back(scene.rest.col(t[1]) - scene.rest.col(t[0]));
    }
    if (has_direction(m)) part.warp.back() = m.warp_axis.value_or(Vec3d::UnitX());
  }
  if (m.shrinks() || !part.shrink.empty()) {
    part.shrink.resize(n, Vec2d(1, 1));
    part.shrink.back() = Vec2d(m.shrink_warp, m.shrink_weft);
  }
  const double creep = m.creep_rate(m.membrane_creep);
  if (creep > 0 || !part.creep.empty()) {
    part.yield.resize(n, 0.0);
    part.creep.resize(n, 0.0);
    part.yield.back() = m.membrane_yield;
    part.creep.back() = creep;
  }
}

/// Largest singular value of F, minus 1, of every surface triangle; 0 for one that only moves.
std::vector<double> stretches(const Scene& scene, const Positions& x) {
  std::vector<double> out;
  out.reserve(scene.surface_triangles.size());
  for (const auto& [a, b, c] : scene.surface_triangles) {
    const Vec3d rest[3] = {scene.rest.col(a), scene.rest.col(b), scene.rest.col(c)};
    const Vec3d now[3] = {x.col(a), x.col(b), x.col(c)};
    const auto shape = triangle_rest<double>(rest, Vec3d(rest[1] - rest[0]));
    out.push_back(svd_3x2<double>(deformation_gradient<3, double>(shape, now)).sigma.maxCoeff() - 1);
  }
  return out;
}

/// The warp direction of a model that depends on one: `warp_axis`, x by default, as of a body of a scene. Others take the first edge
/// of the rest triangle as their frame, and no warp_axis.
template <class T>
Vec<T, 3> warp_of(Fields& fields, const MembraneModel<T>& model, const Vec<T, 3>& first_edge) {
  if (!model.anisotropic) {
    if (fields.has("warp_axis")) {
      fields.complain("warp_axis", "an axis",
                      "nothing: the model " + std::string(model.name) + " has no direction");
    }
    return first_edge;
  }
  Vec<T, 3> axis = Vec<T, 3>::UnitX();
  if (!fields.has("warp_axis")) return axis;
  const std::vector<double> given = fields.list("warp_axis", 3, kFinite);
  for (int k = 0; k < 3; ++k) axis[k] = static_cast<T>(given[static_cast<std::size_t>(k)]);
  if (!fields.wrong() && std::abs(axis.norm() - 1) > T(1e-6))
    fields.complain("warp_axis", "no unit vector", "a unit vector");
  return axis;
}

template <class T>
ElementAnswer triangle_answer(Fields& fields, const MembraneModel<T>& model) {
  const FieldPoints<T, 3> rest(fields, "rest"), x(fields, "x");
  const T mu = static_cast<T>(fields.number("lame_mu", kNonNegative));
  const T lambda = static_cast<T>(fields.number("lame_lambda", kFinite));
  const Vec<T, 3> warp = warp_of<T>(fields, model, rest.x[1] - rest.x[0]);
  const TriangleRest<T> triangle = triangle_rest<T>(rest.x, warp);
  const Vec<T, 3> normal = (rest.x[1] - rest.x[0]).cross(rest.x[2] - rest.x[0]);
  const T size = normal.norm(), cosine = size > T(0) ? warp.dot(normal) / (warp.norm() * size) : T(1);
  const bool usable = triangle.area > T(0) && triangle.dm_inv.allFinite();
  if (fields.wrong()) {
    // complained of
  } else if (!(size > T(0)) || !normal.allFinite() || (!model.anisotropic && !usable)) {
    fields.complain("rest", "a triangle without area", "three points that are not on one line");
  } else if (!usable || std::abs(cosine) > T(1) - T(1e-6)) {
    fields.complain("warp_axis", "the normal of the triangle at rest",
                    "an axis with a part in its plane (default: x)");
  }
  fields.finish();
  return cusp_answer(model.is_cusp(triangle, x.x, mu, lambda),
                     element_answer<T, 9>(model.terms(triangle, x.x, mu, lambda, Projection::none),
                                          model.terms(triangle, x.x, mu, lambda, Projection::psd)));
}

/// Rest shapes that follow.
void add_creep(Settings<Material>& out) {
  out.add("membrane_yield", non_negative("1"),
          "Stretch |sigma - 1| beyond which the rest shape of a triangle follows. Needs "
          "membrane_creep_per_s or "
          "plasticity.",
          &Material::membrane_yield);
  out.add("membrane_creep_per_s", non_negative("1/s"),
          "Rate at which what is beyond membrane_yield decays, since the rest shape follows. 0: it stays.",
          &Material::membrane_creep);
  out.add(
      "plasticity", number_in(0, 1, "1"),
      "Share of what is beyond a yield (membrane_yield, bending_yield_rad, cloth_yield) that the rest "
      "shape takes in plasticity_step_s, of triangles, hinges and springs of cloth alike, whatever dt is. "
      "0: it stays.",
      &Material::plasticity);
  out.add("plasticity_step_s", positive("s"),
          "Time in which the rest shape takes that share: the dt of a program that blends by it once a step.",
          &Material::plasticity_step);
}

class Membrane final : public Part {
 public:
  void add_keys(Settings<Material>& out) const override {
    out.add("model", any_text(), "A membrane model (`bench list membranes`), or none (springs only).",
            &Material::model);
    out.add(
        "warp_axis", computed(direction(), "x, where the model or shrinking has a direction"),
        "Warp direction in the coordinates of the scene at rest, turned into the plane of every triangle.",
        &Material::warp_axis);
    add_youngs(out);
    out.add("thickness_m", positive("m"), "Thickness that multiplies youngs_Pa; contact ignores it.",
            &Material::thickness);
    out.add("poisson", open_high(open_low(number_in(-1, 1, "1"))),
            "Poisson's ratio, plane stress. Some models want more (`bench list membranes`).",
            &Material::poisson);
    out.add("shrink_warp", positive("1"),
            "Factor on rest lengths of triangles and cloth springs along the warp direction; mass and strain "
            "limit are of the mesh "
            "as it is.",
            &Material::shrink_warp);
    out.add("shrink_weft", positive("1"), "The same at right angles to the warp direction.",
            &Material::shrink_weft);
    out.nest_all(
        "shrink_schedule",
        "A factor on all rest lengths of the body over time: of triangles, springs, rods and tetrahedra, on "
        "top of the "
        "other two.",
        1, 10000, settings_of<ShrinkKey>(), [](auto& m) -> auto& { return m.shrink_keys; });
    add_creep(out);
    out.add("density_kg_per_m2", non_negative("kg/m^2"), "Mass per area of triangles.", &Material::density);
    out.add("lumping", word({"barycentric", "mixed_voronoi", "uniform"}),
            "How that mass is split: a third of a triangle at each corner; what is closest to a corner "
            "(obtuse: half, a quarter, a quarter), and drag of the air and a pressure with it; the same at "
            "every vertex of a triangle (drag and pressure: thirds).",
            &Material::lumping);
  }
  std::string_view keys_doc() const override {
    return "Young's modulus either in Pa with a thickness, or already multiplied by the thickness in N/m.";
  }
  void settle(const GivenMaterial& given, const Complaints& complain, Material& m) const override {
    if (!m.warp_axis && has_direction(m)) m.warp_axis = Vec3d::UnitX();
    if (!given.complete) return;  // one of the two may be there and wrong
    const bool pascal = given.object.contains("youngs_Pa"), thick = given.object.contains("thickness_m");
    if (pascal && given.object.contains("youngs_N_per_m")) {
      complain("", "youngs_Pa and youngs_N_per_m", "one of the two");
    } else if (pascal != thick) {
      complain("", pascal ? "youngs_Pa without thickness_m" : "thickness_m without youngs_Pa",
               "youngs_Pa with thickness_m, or youngs_N_per_m alone");
    }
  }
  void check(const BodySpec& spec, bool planar, const Complaints& complain) const override {
    const Material& m = spec.material;
    complain.model("/material/model", m.model, membrane_models<double>().names());
    check_poisson(complain, "", membrane_models<double>().find(m.model), m.poisson);
    check_warp_axis(complain, m, planar);
    check_rest(complain, spec);
    complain.number("/material/youngs", m.youngs, m.youngs > 0, "a number > 0");  // under either name
  }

  std::string_view lacks(const TriangleMesh& mesh, std::string_view key) const override {
    if (key == "shrink_schedule") return "";  // of whatever the body is made of
    return mesh.triangles.empty() ? "the body has no triangle" : "";
  }

  std::vector<MemoryItem> memory(const Scene& scene, const TriangleMesh& mesh) const override {
    return {triangle_memory(static_cast<double>(scene.surface_triangles.size() + mesh.triangles.size()))};
  }
  void add_surface(const TriangleMesh& mesh, BodySurface& out) const override {
    out.mesh.triangles.insert(out.mesh.triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
  }

  void add_masses(const BodySpec& spec, const AddMass& add) const override {
    lump_triangles(spec.mesh, spec.material.lumping, spec.material.density, add);
  }
  void add_elements(const BodySpec& spec, BodyElements& to) const override {
    const Material& material = spec.material;
    if (spec.mesh.triangles.empty()) return;
    if (has_direction(material)) check_warp(spec, material.warp_axis.value_or(Vec3d::UnitX()), to);
    if (material.model == "none") return;
    const LameParameters lame = shell_lame(material.youngs_per_width(), material.poisson);
    MembranePart& part = of_model(material.model, to.scene.membranes);
    for (const auto& local : spec.mesh.triangles) {
      const auto t = to.in_scene(local);
      if (to.all_prescribed(t)) continue;
      part.triangles.push_back(t);
      const double factor = to.stiffness.of(StiffnessKind::membrane, local);
      part.lame_mu.push_back(factor * lame.mu);
      part.lame_lambda.push_back(factor * lame.lambda);
      append_options(material, to.scene, part);
    }
  }

  std::size_t size(const Scene& scene) const override { return scene.membrane_triangles().size(); }
  std::string_view elements() const override { return "triangles"; }
  std::string_view no_elements() const override { return "no membrane element"; }
  void add_families(const Scene& scene, const FamilyPlace& place,
                    std::vector<MadeFamily>& out) const override {
    for (const MembranePart& part : scene.membranes) {
      if (!part.triangles.empty())
        out.push_back(membrane_family(place, part, scene.rest, scene.planar, MovingRest(scene)));
    }
  }
  void add_frame_fields(const Scene& scene, const Positions& x, FrameFields& out) const override {
    out.of_triangles.push_back({"stretch", stretches(scene, x)});
  }

  std::vector<std::string> element_names() const override { return membrane_models<double>().names(); }
  ElementAnswer element(const std::string& name, Fields& fields) const override {
    return in_scalar_of(
        fields, [&]<class T>() { return triangle_answer<T>(fields, *membrane_models<T>().find(name)); });
  }
};

}  // namespace

const Part& parts::membrane::part() {
  static const Membrane part;
  return part;
}

}  // namespace bb
