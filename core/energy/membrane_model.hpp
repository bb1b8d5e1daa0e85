// Membrane models by name, as tables of element functions: what eval and tests loop over.
#pragma once

#include <string_view>

#include "core/base/parameters/registry.hpp"
#include "core/energy/poisson_range.hpp"
#include "core/energy/triangle_membrane.hpp"

namespace bb {

/// One line of registry.inc. The functions are membrane_value, membrane_terms and membrane_is_cusp, F 3 x 2 in space, 2 x 2 in
/// the x-y plane (det F signed, z rows and columns 0).
template <class T>
struct MembraneModel {
  using Value = T (*)(const TriangleRest<T>&, const Vec<T, 3> (&)[3], T lame_mu, T lame_lambda);
  using Terms = ElementTerms<T, 9> (*)(const TriangleRest<T>&, const Vec<T, 3> (&)[3], T lame_mu,
                                       T lame_lambda, Projection);
  using IsCusp = bool (*)(const TriangleRest<T>&, const Vec<T, 3> (&)[3], T lame_mu, T lame_lambda);
  std::string_view name, doc;
  PoissonRange poisson;  // of materials that a body may have
  bool anisotropic;      // the energy depends on the warp direction of the rest data
  Value value, value_planar;
  Terms terms, terms_planar;
  IsCusp is_cusp, is_cusp_planar;
};

/// Every registered model, in the order of registry.inc. T: float or double.
template <class T>
const Registry<MembraneModel<T>>& membrane_models();

/// Whether a model of that name depends on a warp direction.
bool is_anisotropic(std::string_view name);

}  // namespace bb
