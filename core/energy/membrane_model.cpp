// The table of membrane models, from registry.inc.
#include "core/energy/membrane_model.hpp"

#include "core/energy/membrane_list.hpp"

namespace bb {

namespace {

// True for a model that says so; a model without the constant is isotropic.
template <class Model>
constexpr bool says_anisotropic() {
  if constexpr (requires { Model::anisotropic; }) return Model::anisotropic;
  return false;
}

template <class Model, class T>
constexpr MembraneModel<T> entry(std::string_view name, std::string_view doc, const PoissonRange& poisson) {
  return {name,
          doc,
          poisson,
          says_anisotropic<Model>(),
          &membrane_value<Model, 3, T>,
          &membrane_value<Model, 2, T>,
          &membrane_terms<Model, 3, T>,
          &membrane_terms<Model, 2, T>,
          &membrane_is_cusp<Model, 3, T>,
          &membrane_is_cusp<Model, 2, T>};
}

}  // namespace

template <class T>
const Registry<MembraneModel<T>>& membrane_models() {
#define ENTRY(name, doc, poisson) entry<membrane::name, T>(#name, doc, poisson),
  static const Registry<MembraneModel<T>> models({
#include "core/energy/registry.inc"
  });
#undef ENTRY
  return models;
}

bool is_anisotropic(std::string_view name) {
  const MembraneModel<double>* model = membrane_models<double>().find(name);
  return model != nullptr && model->anisotropic;
}

template const Registry<MembraneModel<float>>& membrane_models<float>();
template const Registry<MembraneModel<double>>& membrane_models<double>();

}  // namespace bb
