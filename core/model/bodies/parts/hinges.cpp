// Hinges: bending of every edge between two triangles.
#include "core/energy/hinge.hpp"

#include <fmt/format.h>

#include "core/energy/families/families.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

class Hinges final : public Part {
 public:
  void add_keys(Settings<Material>& out) const override {
    out.add("bending_J", non_negative("J"), "Stiffness of every hinge.", &Material::bending);
    out.add("bending_exponential_J", non_negative("J"),
            "Beside bending_J, a stiffness that has this value at rest and grows exponentially with the "
            "angle from it.",
            &Material::bending_exponential);
    out.add("bending_exponent_per_rad", positive("1/rad"),
            "Growth of bending_exponential_J: e-fold every 1 over this.", &Material::bending_exponent);
    out.add("bending_yield_rad", non_negative("rad"),
            "Angle from rest beyond which the rest angle of a hinge follows. Needs bending_creep_per_s or "
            "plasticity.",
            &Material::bending_yield);
    out.add(
        "bending_creep_per_s", non_negative("1/s"),
        "Rate at which what is beyond bending_yield_rad decays, since the rest angle follows. 0: it stays.",
        &Material::bending_creep);
  }
  void check(const BodySpec& spec, bool planar, const Complaints& complain) const override {
    const Material& m = spec.material;
    if (planar && m.bending > 0) {
      complain("/material/bending_J", fmt::format("{}", m.bending), "0: the scene is planar");
    }
    if (planar && m.bending_exponential > 0) {
      complain("/material/bending_exponential_J", fmt::format("{}", m.bending_exponential),
               "0: the scene is planar");
    }
    if (m.bending_exponent != Material().bending_exponent && !(m.bending_exponential > 0)) {
      complain("/material/bending_exponent_per_rad", fmt::format("{}", m.bending_exponent),
               "nothing without bending_exponential_J");
    }
    if (m.bending_yield > 0 && m.creep_rate(m.bending_creep) == 0) {
      complain("/material/bending_yield_rad", fmt::format("{}", m.bending_yield),
               "0 without bending_creep_per_s or plasticity: nothing yields");
    }
    if (m.bending_creep > 0 && !m.hinges_bend()) {
      complain("/material/bending_creep_per_s", fmt::format("{}", m.bending_creep),
               "0 without bending_J or bending_exponential_J");
    }
    check_edges(spec, complain);
  }
  /// Three triangles at an edge have three angles, of which no two say how it is bent.
  static void check_edges(const BodySpec& spec, const Complaints& complain) {
    const Material& m = spec.material;
    if (!m.hinges_bend()) return;
    const std::optional<CrowdedEdge> crowded = crowded_edge(spec.mesh.triangles);
    if (!crowded) return;
    complain(
        m.bending > 0 ? "/material/bending_J" : "/material/bending_exponential_J",
        fmt::format("{}, and {} triangles share the edge of vertices {} and {}",
                    m.bending > 0 ? m.bending : m.bending_exponential, crowded->n_triangles, crowded->edge[0],
                    crowded->edge[1]),
        "0, or a mesh of which at most two triangles share an edge: only such an edge has one bending angle");
  }
  std::string_view lacks(const TriangleMesh& mesh, std::string_view) const override {
    return mesh.triangles.empty() ? "the body has no triangle" : "";
  }

  void add_elements(const BodySpec& spec, BodyElements& to) const override {
    const Material& m = spec.material;
    if (!m.hinges_bend()) return;
    HingePart& part = to.scene.hinges;
    for (const auto& local : edge_hinges(spec.mesh.triangles)) {
      const auto hinge = to.in_scene(local);
      if (to.all_prescribed(hinge)) continue;
      Vec3d x[4];
      for (std::size_t k = 0; k < 4; ++k) x[k] = spec.mesh.vertices.col(local[k]);
      const double factor = to.stiffness.of(StiffnessKind::hinges, local);
      part.hinges.push_back(hinge);
      part.stiffness.push_back(factor * m.bending);
      part.rest_angle.push_back(hinge_angle(x));
      part.exponential.push_back(factor * m.bending_exponential);
      part.exponent.push_back(m.bending_exponent);
      part.yield.push_back(m.bending_yield);
      part.creep.push_back(m.creep_rate(m.bending_creep));
    }
  }

  std::size_t size(const Scene& scene) const override { return scene.hinges.hinges.size(); }
  std::string_view elements() const override { return "hinges"; }
  std::string_view no_elements() const override { return "no bending"; }
  void add_families(const Scene& scene, const FamilyPlace& place,
                    std::vector<MadeFamily>& out) const override {
    if (!scene.hinges.hinges.empty()) out.push_back(hinge_family(place, scene.hinges, MovingRest(scene)));
  }

  std::vector<std::string> element_names() const override { return {"hinge"}; }
  /// The rest angle is a field of its own, so `rest` may be left out.
  ElementAnswer element(const std::string&, Fields& fields) const override {
    return in_scalar_of(fields, [&]<class T>() {
      if (fields.has("rest")) FieldPoints<T, 4>(fields, "rest");
      const FieldPoints<T, 4> x(fields, "x");
      const T k = static_cast<T>(fields.number("k", kNonNegative));
      const T angle = static_cast<T>(fields.number("rest_angle", kFinite));
      const T q =
          fields.has("exponential") ? static_cast<T>(fields.number("exponential", kNonNegative)) : T(0);
      const T a = fields.has("exponent") ? static_cast<T>(fields.number("exponent", kPositive)) : T(2);
      fields.finish();
      return cusp_answer(hinge_is_cusp<T>(x.x, k + q, angle),
                         element_answer<T, 12>(hinge_terms<T>(x.x, Projection::none, k, q, a, angle),
                                               hinge_terms<T>(x.x, Projection::psd, k, q, a, angle)));
    });
  }
};

}  // namespace

const Part& parts::hinges::part() {
  static const Hinges part;
  return part;
}

}  // namespace bb
