// Tetrahedra: the solid bodies, their mass and surface; elements of the model that the body names (core/energy/solids.inc).
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/energy/families/families.hpp"
#include "core/energy/solid_model.hpp"
#include "core/model/bodies/part.hpp"
#include "core/model/bodies/poisson_check.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

/// Lame parameters of a solid, Pa.
struct SolidLame {
  double mu = 0, lambda = 0;
};
SolidLame solid_lame(double youngs, double poisson) {
  return {youngs / (2 * (1 + poisson)), youngs * poisson / ((1 + poisson) * (1 - 2 * poisson))};
}

/// Smallest volume over volume at rest of the tetrahedra at each vertex; 1 where there are none.
std::vector<double> volume_ratios(const Scene& scene, const Positions& x) {
  std::vector<double> out(static_cast<std::size_t>(scene.n_vertices()), 1.0);
  std::vector<char> met(out.size(), 0);
  for (const SolidPart& part : scene.solids) {
    for (const auto& t : part.tetrahedra) {
      const double ratio = tetrahedron_volume(x, t) / tetrahedron_volume(scene.rest, t);
      for (const int v : t) {
        const auto i = static_cast<std::size_t>(v);
        out[i] = met[i] != 0 ? std::min(out[i], ratio) : ratio;
        met[i] = 1;
      }
    }
  }
  return out;
}

template <class T>
ElementAnswer tetrahedron_answer(Fields& fields, const SolidModel<T>& model) {
  const FieldPoints<T, 4> rest(fields, "rest"), x(fields, "x");
  const T mu = static_cast<T>(fields.number("lame_mu", kNonNegative));
  const T lambda = static_cast<T>(fields.number("lame_lambda", kFinite));
  const TetrahedronRest<T> solid = tetrahedron_rest<T>(rest.x);
  if (!fields.wrong() && !(solid.volume > T(0) && solid.dm_inv.allFinite())) {
    fields.complain("rest", fmt::format("a tetrahedron of {:g} m^3", static_cast<double>(solid.volume)),
                    "volume > 0: point 3 on the side to which 0 1 2 runs counter-clockwise");
  }
  fields.finish();
  return cusp_answer(model.is_cusp(solid, x.x, mu, lambda),
                     element_answer<T, 12>(model.terms(solid, x.x, mu, lambda, Projection::none),
                                           model.terms(solid, x.x, mu, lambda, Projection::psd)));
}

constexpr std::string_view of_solids = "_solid";  // what `eval` puts behind the name of a model

class Tetrahedra final : public Part {
 public:
  void add_keys(Settings<Material>& out) const override {
    out.add("solid_model", any_text(), "A model of solids (`bench list solids`), or none.",
            &Material::solid_model);
    out.add("solid_youngs_Pa", positive("Pa"), "Young's modulus of tetrahedra.", &Material::solid_youngs);
    out.add("solid_poisson", open_high(open_low(number_in(-1, 0.5, "1"))),
            "Poisson's ratio of tetrahedra. Some models want more (`bench list solids`).",
            &Material::solid_poisson);
    out.add("solid_density_kg_per_m3", non_negative("kg/m^3"), "Mass per volume of tetrahedra.",
            &Material::solid_density);
  }
  std::string_view keys_doc() const override {
    return "Keys that begin with solid_ are of tetrahedra alone.";
  }
  void check(const BodySpec& spec, bool, const Complaints& complain) const override {
    const Material& m = spec.material;
    complain.model("/material/solid_model", m.solid_model, solid_models<double>().names());
    check_poisson(complain, "solid_", solid_models<double>().find(m.solid_model), m.solid_poisson);
  }
  std::string_view lacks(const TriangleMesh& mesh, std::string_view) const override {
    return mesh.tetrahedra.empty() ? "the body has no tetrahedron" : "";
  }

  std::vector<MemoryItem> memory(const Scene& scene, const TriangleMesh& mesh) const override {
    return {tetrahedron_memory(static_cast<double>(size(scene) + mesh.tetrahedra.size()))};
  }
  /// Faces of one tetrahedron only. A triangle of the mesh that lies on such a face stands for it.
  void add_surface(const TriangleMesh& mesh, BodySurface& out) const override {
    if (mesh.tetrahedra.empty()) return;
    const auto sorted = [](std::array<int, 3> t) {
      std::sort(t.begin(), t.end());
      return t;
    };
    std::set<std::array<int, 3>> covered;
    for (const auto& t : mesh.triangles) covered.insert(sorted(t));
    std::vector<char> outside(out.enclosed.size(), 0);
    const auto keep = [&outside](const auto& vertices) {
      for (const int v : vertices) outside[static_cast<std::size_t>(v)] = 1;
    };
    for (const auto& face : solid_faces(mesh.tetrahedra).surface) {
      keep(face);
      if (!covered.contains(sorted(face))) out.mesh.triangles.push_back(face);
    }
    for (const auto& t : mesh.triangles) keep(t);
    for (const auto& s : mesh.segments) keep(s);
    for (const auto& t : mesh.tetrahedra) {
      for (const int v : t)
        out.enclosed[static_cast<std::size_t>(v)] |= !outside[static_cast<std::size_t>(v)];
    }
  }

  void add_masses(const BodySpec& spec, const AddMass& add) const override {
    for (const auto& t : spec.mesh.tetrahedra) {
      const double quarter = spec.material.solid_density * tetrahedron_volume(spec.mesh.vertices, t) / 4;
      for (const int v : t) add(v, quarter);
    }
  }
  void add_elements(const BodySpec& spec, BodyElements& to) const override {
    const Material& material = spec.material;
    if (spec.mesh.tetrahedra.empty() || material.solid_model == "none") return;
    const SolidLame lame = solid_lame(material.solid_youngs, material.solid_poisson);
    SolidPart& part = of_model(material.solid_model, to.scene.solids);
    for (const auto& local : spec.mesh.tetrahedra) {
      const auto t = to.in_scene(local);
      if (to.all_prescribed(t)) continue;
      part.tetrahedra.push_back(t);
      part.lame_mu.push_back(lame.mu);
      part.lame_lambda.push_back(lame.lambda);
    }
  }

  std::size_t size(const Scene& scene) const override {
    std::size_t n = 0;
    for (const SolidPart& part : scene.solids) n += part.tetrahedra.size();
    return n;
  }
  std::string_view elements() const override { return "tetrahedra"; }
  std::string_view no_elements() const override { return "no tetrahedron"; }
  void add_families(const Scene& scene, const FamilyPlace& place,
                    std::vector<MadeFamily>& out) const override {
    for (const SolidPart& part : scene.solids) {
      if (!part.tetrahedra.empty())
        out.push_back(tetrahedron_family(place, part, scene.rest, MovingRest(scene)));
    }
  }
  void add_frame_fields(const Scene& scene, const Positions& x, FrameFields& out) const override {
    if (size(scene) > 0) out.of_vertices.push_back({"volume_ratio", volume_ratios(scene, x)});
  }

  std::vector<std::string> element_names() const override {
    std::vector<std::string> names = solid_models<double>().names();
    for (std::string& name : names) name += of_solids;
    return names;
  }
  ElementAnswer element(const std::string& name, Fields& fields) const override {
    const std::string model = name.substr(0, name.size() - of_solids.size());
    return in_scalar_of(
        fields, [&]<class T>() { return tetrahedron_answer<T>(fields, *solid_models<T>().find(model)); });
  }
};

}  // namespace

const Part& parts::tetrahedra::part() {
  static const Tetrahedra part;
  return part;
}

}  // namespace bb
