// Models of solids by name, as tables of element functions: what eval and tests loop over.
#pragma once

#include <string_view>

#include "core/base/parameters/registry.hpp"
#include "core/energy/poisson_range.hpp"
#include "core/energy/tetrahedron.hpp"

namespace bb {

/// One line of solids.inc. The functions are tetrahedron_value, tetrahedron_terms and tetrahedron_is_cusp.
template <class T>
struct SolidModel {
  using Value = T (*)(const TetrahedronRest<T>&, const Vec<T, 3> (&)[4], T lame_mu, T lame_lambda);
  using Terms = ElementTerms<T, 12> (*)(const TetrahedronRest<T>&, const Vec<T, 3> (&)[4], T lame_mu,
                                        T lame_lambda, Projection);
  using IsCusp = bool (*)(const TetrahedronRest<T>&, const Vec<T, 3> (&)[4], T lame_mu, T lame_lambda);
  std::string_view name, doc;
  PoissonRange poisson;  // of materials that a body may have
  Value value;
  Terms terms;
  IsCusp is_cusp;
};

/// Every registered model, in the order of solids.inc. T: float or double.
template <class T>
const Registry<SolidModel<T>>& solid_models();

}  // namespace bb
