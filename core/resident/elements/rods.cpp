// Rods that bend, on an executor.
#include "core/energy/element_loop.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/pair_term.hpp"

namespace bb::resident {

void make_resident_rods(const ResidentInputs& inputs, ResidentTermList& terms) {
  const RodPart& part = inputs.scene.rods;
  check_column("rods/stiffness", part.corners.size(), part.stiffness, false);
  check_column("rods/rest_angle", part.corners.size(), part.rest_angle, false);
  const PairTerm<Rods>::Names names{"rods", "rod vertices", "rod stiffness", "rod rest angles"};
  terms.add(std::make_unique<PairTerm<Rods>>(inputs, names, flat(part.corners), part.stiffness,
                                             part.rest_angle, &Rods::rest_angle));
}

}  // namespace bb::resident
