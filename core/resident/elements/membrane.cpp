// Membranes on an executor: one term a model in use.
#include "core/energy/membrane_batch.hpp"
#include "core/math/error.hpp"
#include "core/resident/elements/element_term.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/triangle_columns.hpp"

namespace bb::resident {
namespace {

template <class Elements>
class MembraneTerm final : public TermOf<Elements> {
 public:
  MembraneTerm(const ResidentInputs& inputs, const MembraneBatch& batch, const MembranePart& part)
      : TermOf<Elements>(inputs, "membrane", batch.vertices()),
        triangles_(inputs.executor, "membrane", batch.vertices(), batch.rests()),
        lame_(inputs.executor, "membrane Lame parameters") {
    upload_pair(part.lame_mu, part.lame_lambda, lame_);
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

template <class Model>
void add_model(const ResidentInputs& inputs, const MembraneBatch& batch, const MembranePart& part,
               ResidentTermList& terms) {
  if (inputs.scene.planar) {
    terms.add(std::make_unique<MembraneTerm<PlanarMembrane<Model>>>(inputs, batch, part));
  } else {
    terms.add(std::make_unique<MembraneTerm<SpaceMembrane<Model>>>(inputs, batch, part));
  }
}

void add_part(const ResidentInputs& inputs, const MembranePart& part, ResidentTermList& terms) {
  if (!part.creep.empty()) {
    throw ConfigError("/device", "membrane with creep, which has no kernels",
                      "membrane without it, or device cpu");
  }
  MembraneBatch batch(part.model, part.triangles, inputs.scene.rest, part.lame_mu, part.lame_lambda,
                      inputs.scene.planar, part.warp);
  if (!part.shrink.empty()) batch.scale_rest(part.shrink);
#define ENTRY(id, doc) \
  if (part.model == #id) return add_model<membrane::id>(inputs, batch, part, terms);
#include "core/energy/registry.inc"
#undef ENTRY
  throw ConfigError("membrane/model", part.model, "a model of core/energy/registry.inc");
}

}  // namespace

void make_resident_membrane(const ResidentInputs& inputs, ResidentTermList& terms) {
  for (const MembranePart& part : inputs.scene.membranes) {
    if (!part.triangles.empty()) add_part(inputs, part, terms);
  }
}

}  // namespace bb::resident
