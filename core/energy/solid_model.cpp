// The table of solid models, from solids.inc.
#include "core/energy/solid_model.hpp"

#include "core/energy/membrane_list.hpp"

namespace bb {

template <class T>
const Registry<SolidModel<T>>& solid_models() {
#define ENTRY(name, doc, poisson)                   \
  SolidModel<T>{#name,                              \
                doc,                                \
                poisson,                            \
                &tetrahedron_value<solid::name, T>, \
                &tetrahedron_terms<solid::name, T>, \
                &tetrahedron_is_cusp<solid::name, T>},
  static const Registry<SolidModel<T>> models({
#include "core/energy/solids.inc"
  });
#undef ENTRY
  return models;
}

template const Registry<SolidModel<float>>& solid_models<float>();
template const Registry<SolidModel<double>>& solid_models<double>();

}  // namespace bb
