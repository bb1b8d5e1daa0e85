// Rods: bending at every vertex between two lone edges, of open chains and of closed loops. Their stretch, mass and surface are
// those of the springs.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/energy/families/families.hpp"
#include "core/energy/rod_bend.hpp"
#include "core/model/bodies/part.hpp"

namespace bb {
namespace {

/// The other ends of the lone edges at every vertex, in the order of the edges.
std::vector<std::vector<int>> neighbours(const TriangleMesh& mesh) {
  std::vector<std::vector<int>> out(static_cast<std::size_t>(mesh.n_vertices()));
  for (const auto& [a, b] : mesh.segments) {
    out[static_cast<std::size_t>(a)].push_back(b);
    out[static_cast<std::size_t>(b)].push_back(a);
  }
  return out;
}

class Rods final : public Part {
 public:
  void add_keys(Settings<Material>& out) const override {
    out.add(
        "rod_bending_N_m2", non_negative("N m^2"),
        "Bending stiffness E I of lone edges. A vertex between two of them has E I over their mean length.",
        &Material::rod_bending);
    out.add(
        "rod_bending_J_per_kg", non_negative("J/kg"),
        "Of the cubic paper's code: a vertex between two lone edges has this times its mass, which vanishes "
        "under refinement. Beside rod_bending_N_m2, not in its place.",
        &Material::rod_bending_per_mass);
    out.add("rod_rest", word({"shape", "straight"}),
            "Angles at which rods are at rest: those of the rest shape, or none.", &Material::rod_rest);
  }
  void check(const BodySpec& spec, bool, const Complaints& complain) const override {
    const Material& m = spec.material;
    if (m.rod_bending_per_mass > 0 && !(m.line_density > 0)) {
      complain("/material/rod_bending_J_per_kg", fmt::format("{}", m.rod_bending_per_mass),
               "0 without line_density_kg_per_m: it multiplies the mass of the edges");
    }
  }
  std::string_view keys_doc() const override {
    return "A rod resists bending by one angle a vertex, the same in all directions, and no twist.";
  }
  std::string_view lacks(const TriangleMesh& mesh, std::string_view) const override {
    return mesh.segments.size() < 2 ? "the body has no two lone edges" : "";
  }

  void add_elements(const BodySpec& spec, BodyElements& to) const override {
    if (!spec.material.rods_bend()) return;
    const auto of = neighbours(spec.mesh);
    for (int v = 0; v < spec.mesh.n_vertices(); ++v) {
      const std::vector<int>& ends = of[static_cast<std::size_t>(v)];
      if (ends.size() > 2) {
        refuse(spec, to, fmt::format("vertex {} in {} lone edges", v, ends.size()),
               "at most 2, since there is one angle a vertex; split the body, or bend nothing");
      } else if (ends.size() == 2) {
        add_corner(spec, {ends[0], v, ends[1]}, to);
      }
    }
  }

  std::size_t size(const Scene& scene) const override { return scene.rods.corners.size(); }
  std::string_view elements() const override { return "rod bends"; }
  std::string_view no_elements() const override { return "no rod that bends"; }
  void add_families(const Scene& scene, const FamilyPlace& place,
                    std::vector<MadeFamily>& out) const override {
    if (!scene.rods.corners.empty()) out.push_back(rod_family(place, scene.rods, MovingRest(scene)));
  }

  std::vector<std::string> element_names() const override { return {"rod_bend"}; }
  /// The rest angle is a field of its own, so `rest` may be left out.
  ElementAnswer element(const std::string&, Fields& fields) const override {
    return in_scalar_of(fields, [&]<class T>() {
      if (fields.has("rest")) FieldPoints<T, 3>(fields, "rest");
      const FieldPoints<T, 3> x(fields, "x");
      const T k = static_cast<T>(fields.number("k", kNonNegative));
      const T angle = static_cast<T>(fields.number("rest_angle", kFinite));
      for (const int i : {0, 1}) {
        if (fields.wrong() || (x.x[i + 1] - x.x[i]).norm() > T(0)) continue;
        fields.complain("x", fmt::format("points {} and {} that coincide", i, i + 1),
                        "three points, each away from the next");
      }
      fields.finish();
      return cusp_answer(is_rod_cusp<T>(rod_corner<T>(x.x), angle),
                         element_answer<T, 9>(rod_bend_terms<T>(x.x, k, angle, Projection::none),
                                              rod_bend_terms<T>(x.x, k, angle, Projection::psd)));
    });
  }

 private:
  static void refuse(const BodySpec& spec, const BodyElements& to, const std::string& found,
                     const std::string& allowed) {
    const char* key = spec.material.rod_bending > 0 ? "rod_bending_N_m2" : "rod_bending_J_per_kg";
    to.complain(fmt::format("/material/{}", key), found, allowed);
  }

  static void add_corner(const BodySpec& spec, const std::array<int, 3>& local, BodyElements& to) {
    const auto corner = to.in_scene(local);
    if (to.all_prescribed(corner)) return;
    const Positions& rest = spec.mesh.vertices;
    const Vec3d a = rest.col(local[1]) - rest.col(local[0]), b = rest.col(local[2]) - rest.col(local[1]);
    if (!(a.norm() > 0) || !(b.norm() > 0)) {
      return refuse(spec, to, fmt::format("a lone edge without length at vertex {}", local[1]),
                    "edges longer than 0 m");
    }
    const bool straight = spec.material.rod_rest == parts::rods::RestAngle::straight;
    const double angle = straight ? 0.0 : rod_rest_angle(a, b);
    if (angle > std::numbers::pi - least_rest_angle) {
      return refuse(spec, to, fmt::format("a rest shape that folds back at vertex {}", local[1]),
                    "angles between neighbouring lone edges below pi, or rod_rest straight");
    }
    const double length = 0.5 * (a.norm() + b.norm()), mass = spec.material.line_density * length;
    to.scene.rods.corners.push_back(corner);
    to.scene.rods.stiffness.push_back(spec.material.rod_bending / length +
                                      spec.material.rod_bending_per_mass * mass);
    to.scene.rods.rest_angle.push_back(angle);
    to.scene.rods.straight.push_back(straight ? 1 : 0);
  }
};

}  // namespace

const Part& parts::rods::part() {
  static const Rods part;
  return part;
}

}  // namespace bb
