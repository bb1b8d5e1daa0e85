// Refuses a Poisson's ratio for which the energy of a body's model is not smallest at rest or has no smallest value.
#pragma once

#include <fmt/format.h>

#include "core/model/bodies/part.hpp"

namespace bb {

/// @param prefix  of the keys of the material: "" or "solid_"   @param model  of a registry, null: none or unknown
template <class Model>
void check_poisson(const Complaints& complain, std::string_view prefix, const Model* model, double poisson) {
  if (!model || model->poisson.contains(poisson)) return;
  complain(fmt::format("/material/{}poisson", prefix), fmt::format("{}", poisson),
           fmt::format("a number {} {} with {}model {}: else {}", model->poisson.relation(),
                       model->poisson.from, prefix, model->name, model->poisson.otherwise));
}

}  // namespace bb
