// Solids on an executor: one term a model in use.
#include "core/energy/tetrahedron_batch.hpp"
#include "core/math/error.hpp"
#include "core/resident/elements/element_columns.hpp"
#include "core/resident/elements/element_terms.hpp"

namespace bb::resident {
namespace {

template <class Model>
class SolidTerm final : public TermOf<Tetrahedra<Model>> {
 public:
  SolidTerm(const ResidentInputs& inputs, const TetrahedronBatch& batch, const SolidPart& part)
      : TermOf<Tetrahedra<Model>>(inputs, "tetrahedra", batch.vertices()),
        columns_(inputs.executor, "solid", batch.vertices(), batch.rests()),
        lame_(inputs.executor, "solid Lame parameters") {
    upload_pair(part.lame_mu, part.lame_lambda, lame_);
    Tetrahedra<Model>& elements = this->elements_;
    elements.of = columns_.vertex.data();
    elements.n = static_cast<Index>(batch.size());
    elements.rest = columns_.rest();
    elements.lame_mu = lame_.data();
    elements.lame_lambda = lame_.data() + elements.n;
  }

 private:
  TetrahedronColumns columns_;
  Buffer<double> lame_;
};

void add_part(const ResidentInputs& inputs, const SolidPart& part, ResidentTermList& terms) {
  const TetrahedronBatch batch(part.model, part.tetrahedra, inputs.scene.rest, part.lame_mu,
                               part.lame_lambda);
#define ENTRY(id, ...) \
  if (part.model == #id) return terms.add(std::make_unique<SolidTerm<solid::id>>(inputs, batch, part));
#include "core/energy/solids.inc"
#undef ENTRY
  throw ConfigError("solid/model", part.model, "a model of core/energy/solids.inc");
}

}  // namespace

void make_resident_tetrahedra(const ResidentInputs& inputs, ResidentTermList& terms) {
  for (const SolidPart& part : inputs.scene.solids) {
    if (!part.tetrahedra.empty()) add_part(inputs, part, terms);
  }
}

}  // namespace bb::resident
