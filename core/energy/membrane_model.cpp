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
constexpr MembraneModel<T> entry(std::string_view name, std::string_view doc) {
  return {name,
          doc,
          says_anisotropic<Model>(),
          &membrane_value<Model, 3, T>,
          &membrane_value<Model, 2, T>,
          &membrane_terms<Model, 3, T>,
          &membrane_terms<Model, 2, T>};
}

}  // namespace

template <class T>
std::span<const MembraneModel<T>> membrane_models() {
#define ENTRY(name, doc) entry<membrane::name, T>(#name, doc),
  static constexpr MembraneModel<T> models[] = {
#include "core/energy/registry.inc"
  };
#undef ENTRY
  return models;
}

template <class T>
const MembraneModel<T>* find_membrane_model(std::string_view name) {
  for (const MembraneModel<T>& model : membrane_models<T>()) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

bool is_anisotropic(std::string_view name) {
  const MembraneModel<double>* model = find_membrane_model<double>(name);
  return model != nullptr && model->anisotropic;
}

template std::span<const MembraneModel<float>> membrane_models<float>();
template std::span<const MembraneModel<double>> membrane_models<double>();
template const MembraneModel<float>* find_membrane_model<float>(std::string_view);
template const MembraneModel<double>* find_membrane_model<double>(std::string_view);

}  // namespace bb
