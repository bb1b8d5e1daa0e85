// Hinges on an executor.
#include <algorithm>

#include "core/energy/hinge_batch.hpp"
#include "core/math/error.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/family_kernels.hpp"
#include "core/resident/elements/pair_term.hpp"

namespace bb::resident {
namespace {

bool any_positive(const std::vector<double>& column) {
  return std::any_of(column.begin(), column.end(), [](double value) { return value > 0; });
}

}  // namespace

void make_resident_hinges(const ResidentInputs& inputs, ResidentTermList& terms) {
  const HingePart& part = inputs.scene.hinges;
  if (any_positive(part.exponential) || any_positive(part.creep)) {
    throw ConfigError("/device", "hinges with creep or an exponential part, which have no kernels",
                      "hinges without them, or device cpu");
  }
  const HingeBatch batch(part.hinges, part.stiffness, part.rest_angle);
  const PairTerm<Hinges>::Names names{"hinges", "hinge vertices", "hinge stiffness", "hinge rest angles"};
  terms.add(std::make_unique<PairTerm<Hinges>>(inputs, names, batch.vertices(), part.stiffness,
                                               part.rest_angle, &Hinges::rest_angle));
}

}  // namespace bb::resident
