// Springs of cloth: on the sides of faces, and between corners of a face that are no side of it.
#include <fmt/format.h>

#include <algorithm>

#include "core/energy/cloth_spring.hpp"
#include "core/energy/families/families.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

using Pair = std::array<int, 2>;

/// Lengths at rest of pairs of vertices of a body that shrinks.
class ShrunkLengths {
 public:
  explicit ShrunkLengths(const BodySpec& spec) : spec_(spec) {
    if (!spec.material.shrinks_along_warp()) return;
    // Normals of the faces around a vertex, weighted by area: a pair lies in the mean plane of its two.
    normal_ = Positions::Zero(3, spec.mesh.n_vertices());
    for (const auto& t : spec.mesh.triangles) {
      const Vec3d area = area_vector(spec.mesh.vertices, t);
      for (const int v : t) normal_.col(v) += area;
    }
  }
  double of(const Pair& pair) const {
    const Material& m = spec_.material;
    const Vec3d difference = spec_.mesh.vertices.col(pair[1]) - spec_.mesh.vertices.col(pair[0]);
    if (m.shrink_warp == 1 && m.shrink_weft == 1) return difference.norm();
    if (!m.shrinks_along_warp()) return m.shrink_warp * difference.norm();
    const Vec3d n = (normal_.col(pair[0]) + normal_.col(pair[1])).normalized();
    const Vec3d axis = m.warp_axis.value_or(Vec3d::UnitX());
    const double along = difference.dot((axis - n.dot(axis) * n).normalized());
    const double across_sq = std::max(difference.squaredNorm() - along * along, 0.0);
    return std::sqrt(m.shrink_warp * m.shrink_warp * along * along +
                     m.shrink_weft * m.shrink_weft * across_sq);
  }

 private:
  const BodySpec& spec_;
  Positions normal_;
};

constexpr int most_corners = 100;  // of a face with diagonals: their number grows with the square

class ClothSprings final : public Part {
 public:
  void add_keys(Settings<Material>& out) const override {
    const auto stiffness = [&out](const char* key, const std::string& of, auto member, auto growing) {
      const std::string linear = std::string(key) + "_N_per_m";
      out.add(linear, non_negative("N/m"), of, member);
      out.add(std::string(key) + "_exponential_N_per_m", non_negative("N/m"),
              "Beside " + linear + ", a stiffness that has this value at rest and grows with cloth_exponent.",
              growing);
    };
    stiffness("cloth_tension", "Stiffness of a spring on every side of a face that is longer than at rest.",
              &Material::cloth_tension, &Material::cloth_tension_growing);
    stiffness("cloth_compression", "The same of one that is shorter than at rest.",
              &Material::cloth_compression, &Material::cloth_compression_growing);
    stiffness("cloth_shear",
              "Stiffness, either way, of springs between corners of a face that are no side of it (faces of "
              "more than three corners: "
              "of OBJ and PLY files, and of the generator grid).",
              &Material::cloth_shear, &Material::cloth_shear_growing);
    out.add("cloth_skip_one_N_per_m", non_negative("N/m"),
            "Stiffness, either way, of springs between vertices two apart along a line of a grid, found from "
            "the faces: two "
            "neighbours of a vertex that no face has with it. Surfaces of quads alone (of OBJ and PLY files, "
            "and of the "
            "generator grid) whose vertices are in four, or at the border in one or two.",
            &Material::cloth_skip_one);
    out.add("cloth_softening_m", non_negative("m"),
            "The length of cloth springs is sqrt(|d|^2 + this^2), smooth where two vertices meet; lengths at "
            "rest are |d|.",
            &Material::cloth_softening);
    out.add("cloth_exponent", positive("1"),
            "Growth of exponential parts: e-fold with every 1 over this of relative elongation.",
            &Material::cloth_exponent);
    out.add("cloth_yield", non_negative("1"),
            "Relative elongation |l/l0 - 1| beyond which a rest length follows. Needs cloth_creep_per_s or "
            "plasticity.",
            &Material::cloth_yield);
    out.add("cloth_creep_per_s", non_negative("1/s"),
            "Rate at which what is beyond cloth_yield decays, since the rest length follows. 0: it stays.",
            &Material::cloth_creep);
  }
  std::string_view keys_doc() const override {
    return "Keys that begin with cloth_ are of springs on the faces of a shell; mass comes from "
           "density_kg_per_m2, bending from bending_J.";
  }
  void check(const BodySpec& spec, bool, const Complaints& complain) const override {
    const Material& m = spec.material;
    using Given = std::pair<const char*, double>;
    const auto refuse = [&](const char* key, double found, const std::string& allowed) {
      complain(std::string("/material/") + key, fmt::format("{}", found), allowed);
    };
    const auto refuse_all = [&](std::initializer_list<Given> given, const std::string& allowed) {
      for (const auto& [key, found] : given) {
        if (found > 0) refuse(key, found, allowed);
      }
    };
    const std::initializer_list<Given> shear = {{"cloth_shear_N_per_m", m.cloth_shear},
                                                {"cloth_shear_exponential_N_per_m", m.cloth_shear_growing}};
    int corners = 3;
    for (const auto& fan : spec.mesh.fans) corners = std::max(corners, fan[1] + 2);
    if (corners == 3) {
      refuse_all(shear, "0: no face of the mesh has more than three corners");
    } else if (corners > most_corners) {
      refuse_all(shear,
                 fmt::format("0 with a face of {} corners; at most {} otherwise", corners, most_corners));
    }
    if (m.cloth_exponent != Material().cloth_exponent && m.cloth_tension_growing == 0 &&
        m.cloth_compression_growing == 0 && m.cloth_shear_growing == 0) {
      refuse("cloth_exponent", m.cloth_exponent, "nothing without an exponential stiffness of cloth springs");
    }
    if (m.cloth_yield > 0 && m.creep_rate(m.cloth_creep) == 0) {
      refuse("cloth_yield", m.cloth_yield, "0 without cloth_creep_per_s or plasticity: nothing yields");
    }
    if (!m.has_cloth_springs()) {
      refuse_all({{"cloth_creep_per_s", m.cloth_creep}, {"cloth_softening_m", m.cloth_softening}},
                 "0 without a cloth spring");
    }
    if (m.cloth_skip_one > 0) {
      const std::string fault = skip_one_pairs(spec.mesh).fault;
      if (!fault.empty())
        refuse("cloth_skip_one_N_per_m", m.cloth_skip_one, "0: the mesh is no grid, it has " + fault);
    }
  }
  std::string_view lacks(const TriangleMesh& mesh, std::string_view) const override {
    return mesh.triangles.empty() ? "the body has no face" : "";
  }

  void add_elements(const BodySpec& spec, BodyElements& to) const override {
    const Material& m = spec.material;
    if (!m.has_cloth_springs()) return;
    const ShrunkLengths rest(spec);
    ClothSpringPart& part = to.scene.cloth_springs;
    const auto add = [&](const Pair& local, double tension, double tension_growing, double compression,
                         double compression_growing) {
      const Pair pair = to.in_scene(local);
      if (to.all_prescribed(pair)) return;
      const double factor = to.stiffness.of(StiffnessKind::springs, local);
      part.pairs.push_back(pair);
      part.rest_length.push_back(rest.of(local));
      part.tension.push_back(factor * tension);
      part.tension_growing.push_back(factor * tension_growing);
      part.compression.push_back(factor * compression);
      part.compression_growing.push_back(factor * compression_growing);
      part.exponent.push_back(m.cloth_exponent);
      part.softening.push_back(m.cloth_softening);
      part.yield.push_back(m.cloth_yield);
      part.creep.push_back(m.creep_rate(m.cloth_creep));
    };
    if (m.has_sides()) {
      for (const Pair& side : face_sides(spec.mesh)) {
        add(side, m.cloth_tension, m.cloth_tension_growing, m.cloth_compression, m.cloth_compression_growing);
      }
    }
    if (m.has_diagonals()) {
      for (const Pair& diagonal : face_diagonals(spec.mesh)) {
        add(diagonal, m.cloth_shear, m.cloth_shear_growing, m.cloth_shear, m.cloth_shear_growing);
      }
    }
    if (m.cloth_skip_one > 0) {
      for (const Pair& pair : skip_one_pairs(spec.mesh).pairs) {
        add(pair, m.cloth_skip_one, 0, m.cloth_skip_one, 0);
      }
    }
  }

  std::size_t size(const Scene& scene) const override { return scene.cloth_springs.pairs.size(); }
  std::string_view elements() const override { return "cloth springs"; }
  std::string_view no_elements() const override { return "no spring of cloth"; }
  void add_families(const Scene& scene, const FamilyPlace& place,
                    std::vector<MadeFamily>& out) const override {
    if (!scene.cloth_springs.pairs.empty())
      out.push_back(cloth_spring_family(place, scene.cloth_springs, MovingRest(scene)));
  }

  std::vector<std::string> element_names() const override { return {"cloth_spring"}; }
  ElementAnswer element(const std::string&, Fields& fields) const override {
    return in_scalar_of(fields, [&]<class T>() {
      const FieldPoints<T, 2> rest(fields, "rest"), x(fields, "x");
      const auto number = [&](const char* name) {
        return fields.has(name) ? static_cast<T>(fields.number(name, kNonNegative)) : T(0);
      };
      SpringLaw<T> law{number("tension"), number("tension_exponential"), number("compression"),
                       number("compression_exponential"), T(10)};
      law.softening = number("softening");
      if (fields.has("exponent")) law.exponent = static_cast<T>(fields.number("exponent", kPositive));
      const T length = (rest.x[1] - rest.x[0]).norm();
      if (!fields.wrong() && !(length > T(0))) {
        fields.complain("rest", "two points that coincide", "a rest length > 0");
      }
      fields.finish();
      return cusp_answer(cloth_spring_is_cusp<T>(x.x, length, law),
                         element_answer<T, 6>(cloth_spring_terms<T>(x.x, length, law, Projection::none),
                                              cloth_spring_terms<T>(x.x, length, law, Projection::psd)));
    });
  }
};

}  // namespace

const Part& parts::cloth_springs::part() {
  static const ClothSprings part;
  return part;
}

}  // namespace bb
