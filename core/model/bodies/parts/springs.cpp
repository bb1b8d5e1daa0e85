// Springs: on every edge of a body, of triangles and of rods. Lone edges are rods, whose mass this part brings.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/energy/families/families.hpp"
#include "core/energy/spring.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

/// Each with the lower vertex first.
std::set<std::array<int, 2>> lone_edges_of(const TriangleMesh& mesh) {
  std::set<std::array<int, 2>> out;
  for (const auto& [a, b] : mesh.segments) out.insert({std::min(a, b), std::max(a, b)});
  return out;
}

void refuse_length(const std::array<int, 2>& edge, const BodyElements& to) {
  to.complain("/material/rod_stretching_N",
              fmt::format("a lone edge without length, of vertices {} and {}", edge[0], edge[1]),
              "edges longer than 0 m");
}

class Springs final : public Part {
 public:
  void add_keys(Settings<Material>& out) const override {
    out.add("line_density_kg_per_m", non_negative("kg/m"), "Mass per length of lone edges.",
            &Material::line_density);
    out.add("springs_N_per_m", non_negative("N/m"), "Stiffness of a spring on every edge.",
            &Material::springs);
    out.add("rod_stretching_N", non_negative("N"),
            "Stretching stiffness E A of lone edges: the spring on one has this over its length, beside "
            "springs_N_per_m.",
            &Material::rod_stretching);
  }
  std::string_view lacks(const TriangleMesh& mesh, std::string_view key) const override {
    if (key != "springs_N_per_m") return mesh.segments.empty() ? "the body has no lone edge" : "";
    const bool no_edge = mesh.segments.empty() && mesh.triangles.empty() && mesh.tetrahedra.empty();
    return no_edge ? "the body has no edge" : "";
  }

  std::vector<MemoryItem> memory(const Scene&, const TriangleMesh& mesh) const override {
    return {segment_memory(static_cast<double>(mesh.segments.size()))};
  }
  void add_surface(const TriangleMesh& mesh, BodySurface& out) const override {
    out.mesh.segments.insert(out.mesh.segments.end(), mesh.segments.begin(), mesh.segments.end());
  }

  void add_masses(const BodySpec& spec, const AddMass& add) const override {
    for (const auto& s : spec.mesh.segments) {
      const double length = (spec.mesh.vertices.col(s[1]) - spec.mesh.vertices.col(s[0])).norm();
      for (const int v : s) add(v, 0.5 * spec.material.line_density * length);
    }
  }
  void add_elements(const BodySpec& spec, BodyElements& to) const override {
    if (spec.material.springs == 0 && spec.material.rod_stretching == 0) return;
    const std::set<std::array<int, 2>> lone = lone_edges_of(spec.mesh);
    for (const auto& local : unique_edges(spec.mesh)) {
      const auto edge = to.in_scene(local);
      if (to.all_prescribed(edge)) continue;
      double stiffness = spec.material.springs;
      if (spec.material.rod_stretching > 0 && lone.contains(local)) {
        const double length = (spec.mesh.vertices.col(local[1]) - spec.mesh.vertices.col(local[0])).norm();
        if (!(length > 0)) return refuse_length(local, to);
        stiffness += spec.material.rod_stretching / length;
      }
      stiffness *= to.stiffness.of(StiffnessKind::springs, local);
      if (stiffness == 0) continue;
      to.scene.springs.edges.push_back(edge);
      to.scene.springs.stiffness.push_back(stiffness);
    }
  }

  std::size_t size(const Scene& scene) const override { return scene.springs.edges.size(); }
  std::string_view elements() const override { return "springs"; }
  std::string_view no_elements() const override { return "no spring"; }
  void add_families(const Scene& scene, const FamilyPlace& place,
                    std::vector<MadeFamily>& out) const override {
    const SpringPart& part = scene.springs;
    if (part.edges.empty()) return;
    out.push_back(spring_family(place, {}, part.edges, part.stiffness, lengths_of(part.edges, scene.rest),
                                MovingRest(scene)));
  }

  std::vector<std::string> element_names() const override { return {"spring"}; }
  ElementAnswer element(const std::string&, Fields& fields) const override {
    return in_scalar_of(fields, [&]<class T>() {
      const FieldPoints<T, 2> rest(fields, "rest"), x(fields, "x");
      const T k = static_cast<T>(fields.number("k", kNonNegative));
      fields.finish();
      const T length = (rest.x[1] - rest.x[0]).norm();
      return cusp_answer(spring_is_cusp<T>(x.x, k, length),
                         element_answer<T, 6>(spring_terms<T>(x.x, k, length, Projection::none),
                                              spring_terms<T>(x.x, k, length, Projection::psd)));
    });
  }
};

}  // namespace

const Part& parts::springs::part() {
  static const Springs part;
  return part;
}

}  // namespace bb
