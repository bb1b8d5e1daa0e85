// Hinges: bending of every edge between two triangles.
#include "core/energy/hinge.hpp"

#include <fmt/format.h>

#include "core/bodies/part.hpp"
#include "core/energy/hinge_batch.hpp"
#include "core/mesh/topology.hpp"

namespace bb {
namespace {

class Hinges final : public Part {
 public:
  void add_keys(Settings<Material>& out) const override {
    out.add("bending_J", non_negative("J"), "Stiffness of every hinge.", &Material::bending);
  }
  void check(const BodySpec& spec, bool planar, const Complaints& complain) const override {
    const double bending = spec.material.bending;
    if (planar && bending > 0) {
      complain("/material/bending_J", fmt::format("{}", bending), "0: the scene is planar");
    }
  }

  void add_elements(const BodySpec& spec, BodyElements& to) const override {
    if (spec.material.bending == 0) return;
    HingePart& part = to.scene.hinges;
    for (const auto& local : edge_hinges(spec.mesh.triangles)) {
      const auto hinge = to.in_scene(local);
      if (to.all_prescribed(hinge)) continue;
      Vec3d x[4];
      for (std::size_t k = 0; k < 4; ++k) x[k] = spec.mesh.vertices.col(local[k]);
      part.hinges.push_back(hinge);
      part.stiffness.push_back(spec.material.bending);
      part.rest_angle.push_back(hinge_angle(x));
    }
  }

  std::size_t size(const Scene& scene) const override { return scene.hinges.hinges.size(); }
  std::string_view elements() const override { return "hinges"; }
  std::string_view no_elements() const override { return "no bending"; }
  void add_batches(const Scene& scene, Precision precision,
                   std::vector<std::unique_ptr<EnergyBatch>>& out) const override {
    const HingePart& part = scene.hinges;
    if (part.hinges.empty()) return;
    out.push_back(std::make_unique<HingeBatch>(part.hinges, part.stiffness, part.rest_angle, precision));
  }

  std::vector<std::string> element_names() const override { return {"hinge"}; }
  /// The rest angle is a field of its own, so `rest` may be left out.
  ElementAnswer element(const std::string&, Fields& fields) const override {
    return in_scalar_of(fields, [&]<class T>() {
      if (fields.has("rest")) FieldPoints<T, 4>(fields, "rest");
      const FieldPoints<T, 4> x(fields, "x");
      const T k = static_cast<T>(fields.number("k", kNonNegative));
      const T angle = static_cast<T>(fields.number("rest_angle", kFinite));
      fields.finish();
      return element_answer<T, 12>(hinge_terms<T>(x.x, k, angle, Projection::none),
                                   hinge_terms<T>(x.x, k, angle, Projection::psd));
    });
  }
};

}  // namespace

const Part& parts::hinges::part() {
  static const Hinges part;
  return part;
}

}  // namespace bb
