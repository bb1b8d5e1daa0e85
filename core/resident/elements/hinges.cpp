// Hinges on an executor.
#include "core/energy/hinge_batch.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/pair_term.hpp"

namespace bb::resident {

void make_resident_hinges(const ResidentInputs& inputs, ResidentTermList& terms) {
  const HingePart& part = inputs.scene.hinges;
  const HingeBatch batch(part.hinges, part.stiffness, part.rest_angle);
  const PairTerm<Hinges>::Names names{"hinges", "hinge vertices", "hinge stiffness", "hinge rest angles"};
  terms.add(std::make_unique<PairTerm<Hinges>>(inputs, names, batch.vertices(), part.stiffness,
                                               part.rest_angle, &Hinges::rest_angle));
}

}  // namespace bb::resident
