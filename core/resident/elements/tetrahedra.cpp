// Solids on an executor: one term a model in use.
#include "core/energy/tetrahedron_batch.hpp"
#include "core/math/error.hpp"
#include "core/resident/elements/element_term.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/family_kernels.hpp"

namespace bb::resident {
namespace {

template <class Model>
class SolidTerm final : public TermOf<Tetrahedra<Model>> {
 public:
  SolidTerm(const ResidentInputs& inputs, const TetrahedronBatch& batch, const SolidPart& part)
      : TermOf<Tetrahedra<Model>>(inputs, "tetrahedra", batch.vertices()),
        vertex_(inputs.executor, "solid vertices"),
        rest_(inputs.executor, "solid rest shapes"),
        lame_(inputs.executor, "solid Lame parameters") {
    vertex_.upload(to_columns(batch.vertices(), 4));
    rest_.upload(rest_columns(batch.rests()));
    upload_pair(part.lame_mu, part.lame_lambda, lame_);
    Tetrahedra<Model>& elements = this->elements_;
    elements.of = vertex_.data();
    elements.n = static_cast<Index>(batch.size());
    elements.dm_inv = rest_.data();
    elements.volume = rest_.data() + 9 * elements.n;
    elements.lame_mu = lame_.data();
    elements.lame_lambda = lame_.data() + elements.n;
  }

 private:
  static std::vector<double> rest_columns(std::span<const TetrahedronRest<double>> rests) {
    const std::size_t n = rests.size();
    std::vector<double> out(10 * n);
    for (std::size_t e = 0; e < n; ++e) {
      for (std::size_t k = 0; k < 9; ++k) out[k * n + e] = rests[e].dm_inv.data()[k];
      out[9 * n + e] = rests[e].volume;
    }
    return out;
  }

  Buffer<int> vertex_;
  Buffer<double> rest_, lame_;
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
