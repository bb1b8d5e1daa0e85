// Springs on an executor, stitches among them.
#include "core/energy/spring_batch.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/pair_term.hpp"

namespace bb::resident {

void make_resident_stitch(const ResidentInputs& inputs, ResidentTermList& terms) {
  const Stitches& stitches = inputs.scene.stitches;
  const SpringBatch batch(stitches.pairs, stitches.rest_length, stitches.stiffness);
  const PairTerm<Springs>::Names names{"stitch", "stitched vertices", "stitch stiffness",
                                       "stitch rest lengths"};
  terms.add(std::make_unique<PairTerm<Springs>>(inputs, names, batch.vertices(), stitches.stiffness,
                                                batch.rest_lengths(), &Springs::rest_length));
}

void make_resident_springs(const ResidentInputs& inputs, ResidentTermList& terms) {
  const SpringPart& part = inputs.scene.springs;
  const SpringBatch batch(part.edges, inputs.scene.rest, part.stiffness);
  const PairTerm<Springs>::Names names{"springs", "spring vertices", "spring stiffness",
                                       "spring rest lengths"};
  terms.add(std::make_unique<PairTerm<Springs>>(inputs, names, batch.vertices(), part.stiffness,
                                                batch.rest_lengths(), &Springs::rest_length));
}

}  // namespace bb::resident
