// Springs on an executor.
#include "core/energy/spring_batch.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/pair_term.hpp"

namespace bb::resident {

void make_resident_springs(const ResidentInputs& inputs, ResidentTermList& terms) {
  const SpringPart& part = inputs.scene.springs;
  const SpringBatch batch(part.edges, inputs.scene.rest, part.stiffness);
  const PairTerm<Springs>::Names names{"springs", "spring vertices", "spring stiffness",
                                       "spring rest lengths"};
  terms.add(std::make_unique<PairTerm<Springs>>(inputs, names, batch.vertices(), part.stiffness,
                                                batch.rest_lengths(), &Springs::rest_length));
}

}  // namespace bb::resident
