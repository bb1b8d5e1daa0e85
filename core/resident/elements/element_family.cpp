#include "core/resident/elements/element_family.hpp"

#include <cmath>
#include <string>

#include "core/energy/hinge_batch.hpp"
#include "core/energy/membrane_batch.hpp"
#include "core/energy/spring_batch.hpp"
#include "core/math/error.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/triangle_columns.hpp"

namespace bb::resident {
namespace {

template <class Elements>
class MembraneFamily final : public FamilyOf<Elements> {
 public:
  MembraneFamily(exec::Executor& executor, const MembraneBatch& batch, const MembranePart& part)
      : FamilyOf<Elements>(executor, "membrane", TermGroup::elastic),
        triangles_(executor, "membrane", batch.vertices(), batch.rests()),
        lame_(executor, "membrane Lame parameters") {
    std::vector<double> lame = part.lame_mu;
    lame.insert(lame.end(), part.lame_lambda.begin(), part.lame_lambda.end());
    lame_.upload(lame);
    Elements& elements = this->elements_;
    elements.of = triangles_.vertex.data();
    elements.n = static_cast<Index>(batch.size());
    elements.rest = triangles_.rest();
    elements.lame_mu = lame_.data();
    elements.lame_lambda = lame_.data() + elements.n;
  }

 private:
  TriangleColumns triangles_;
  Buffer<double> lame_;
};

/// Springs and hinges: two numbers an element.
template <class Elements>
class PairFamily final : public FamilyOf<Elements> {
 public:
  PairFamily(exec::Executor& executor, const std::string& name, std::span<const int> vertices,
             std::span<const double> stiffness, std::span<const double> rest,
             const double* Elements::*rest_member)
      : FamilyOf<Elements>(executor, name == "hinge" ? "hinges" : "springs", TermGroup::elastic),
        vertex_(executor, name + " vertices"),
        stiffness_(executor, name + " stiffness"),
        rest_(executor, name + (name == "hinge" ? " rest angles" : " rest lengths")) {
    vertex_.upload(to_columns(vertices, Elements::width));
    stiffness_.upload(stiffness);
    rest_.upload(rest);
    Elements& elements = this->elements_;
    elements.of = vertex_.data();
    elements.n = stiffness_.size();
    elements.stiffness = stiffness_.data();
    elements.*rest_member = rest_.data();
  }

 private:
  Buffer<int> vertex_;
  Buffer<double> stiffness_, rest_;
};

template <class Model>
std::unique_ptr<ElementFamily> membrane_family(exec::Executor& executor, const Scene& scene,
                                               const MembraneBatch& batch, const MembranePart& part) {
  if (scene.planar) return std::make_unique<MembraneFamily<PlanarMembrane<Model>>>(executor, batch, part);
  return std::make_unique<MembraneFamily<SpaceMembrane<Model>>>(executor, batch, part);
}

std::unique_ptr<ElementFamily> membrane_family(exec::Executor& executor, const Scene& scene,
                                               const MembraneBatch& batch, const MembranePart& part) {
#define ENTRY(id, doc) \
  if (part.model == #id) return membrane_family<membrane::id>(executor, scene, batch, part);
#include "core/energy/registry.inc"
#undef ENTRY
  throw ConfigError("membrane/model", part.model, "a model of core/energy/registry.inc");
}

std::vector<int> copy_of(std::span<const int> vertices) { return {vertices.begin(), vertices.end()}; }

}  // namespace

std::vector<MadeFamily> make_elastic_families(exec::Executor& executor, const Scene& scene) {
  std::vector<MadeFamily> out;
  for (const MembranePart& part : scene.membranes) {
    if (part.triangles.empty()) continue;
    MembraneBatch batch(part.model, part.triangles, scene.rest, part.lame_mu, part.lame_lambda, scene.planar,
                        part.warp);
    if (!part.shrink.empty()) batch.scale_rest(part.shrink);
    out.push_back({membrane_family(executor, scene, batch, part), copy_of(batch.vertices())});
  }
  if (!scene.springs.edges.empty()) {
    const SpringBatch batch(scene.springs.edges, scene.rest, scene.springs.stiffness);
    out.push_back(
        {std::make_unique<PairFamily<Springs>>(executor, "spring", batch.vertices(), scene.springs.stiffness,
                                               batch.rest_lengths(), &Springs::rest_length),
         copy_of(batch.vertices())});
  }
  if (!scene.hinges.hinges.empty()) {
    const HingeBatch batch(scene.hinges.hinges, scene.hinges.stiffness, scene.hinges.rest_angle);
    out.push_back(
        {std::make_unique<PairFamily<Hinges>>(executor, "hinge", batch.vertices(), scene.hinges.stiffness,
                                              scene.hinges.rest_angle, &Hinges::rest_angle),
         copy_of(batch.vertices())});
  }
  return out;
}

HessianRequest hessian_request(StepHessian choice, double t, double threshold, const double* force) {
  HessianRequest out;
  out.first = first_projection(choice);
  if (choice == StepHessian::progressive && threshold == 0) out.first = Projection::psd;
  if (choice == StepHessian::progressive && threshold > 0 && std::isfinite(threshold)) {
    out.threshold = threshold;
    out.force = force;
  }
  const bool blends = choice == StepHessian::blend || choice == StepHessian::exact_or_clamped;
  if (!blends || t == 0) return out;
  if (choice == StepHessian::exact_or_clamped || t == 1) {
    out.first = Projection::psd;
  } else {
    out.t = t;
  }
  return out;
}

}  // namespace bb::resident
