#include "core/energy/membrane_lanes.hpp"

#include "core/energy/membrane_list.hpp"
#include "core/math/lanes.hpp"
#include "core/math/lower_blocks.hpp"

namespace bb {
namespace {

template <class T>
struct ShapesInLanes {
  using Real = Lanes<T, membrane_lanes>;
  Vec<Real, 3> x[3];
  TriangleRest<Real> rest;

  explicit ShapesInLanes(const TrianglesAbreast<T>& from) {
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 3; ++c) x[i][c] = load_lanes<membrane_lanes>(from.x[3 * i + c]);
    }
    for (int k = 0; k < 4; ++k) rest.dm_inv.data()[k] = load_lanes<membrane_lanes>(from.dm_inv[k]);
    rest.area = load_lanes<membrane_lanes>(from.area);
  }
};

template <class T>
struct InLanes : ShapesInLanes<T> {
  Lanes<T, membrane_lanes> lame_mu, lame_lambda;

  explicit InLanes(const TrianglesAbreast<T>& from)
      : ShapesInLanes<T>(from),
        lame_mu(load_lanes<membrane_lanes>(from.lame_mu)),
        lame_lambda(load_lanes<membrane_lanes>(from.lame_lambda)) {}
};

}  // namespace

template <class Model, class T>
void membrane_values_abreast(const TrianglesAbreast<T>& triangles, T (&energy)[membrane_lanes]) {
  const InLanes<T> of(triangles);
  store_lanes(membrane_value<Model, 3>(of.rest, of.x, of.lame_mu, of.lame_lambda), energy);
}

template <class Model, class T>
void membrane_terms_abreast(const TrianglesAbreast<T>& triangles, Projection projection,
                            TermsAbreast<T, membrane_lanes, 3>& out) {
  const InLanes<T> of(triangles);
  const auto terms = membrane_terms<Model, 3>(of.rest, of.x, of.lame_mu, of.lame_lambda, projection);
  store_lanes(terms.energy, out.energy);
  for (int k = 0; k < 9; ++k) store_lanes(terms.grad[k], out.grad[k]);
  T(*to)[membrane_lanes] = out.hess;
  for_each_lower_number(3, [&](int row, int column) { store_lanes(terms.hess(row, column), *to++); });
}

template <class T>
void stretches_abreast(const TrianglesAbreast<T>& triangles, T (&sigma)[2][membrane_lanes]) {
  const ShapesInLanes<T> of(triangles);
  const auto found = svd_3x2(deformation_gradient<3>(of.rest, of.x)).sigma;
  for (int k = 0; k < 2; ++k) store_lanes(found[k], sigma[k]);
}

template void stretches_abreast(const TrianglesAbreast<float>&, float (&)[2][membrane_lanes]);
template void stretches_abreast(const TrianglesAbreast<double>&, double (&)[2][membrane_lanes]);

#define BB_MEMBRANE_LANES(Model, T)                                                                  \
  template void membrane_values_abreast<Model, T>(const TrianglesAbreast<T>&, T(&)[membrane_lanes]); \
  template void membrane_terms_abreast<Model, T>(const TrianglesAbreast<T>&, Projection,             \
                                                 TermsAbreast<T, membrane_lanes, 3>&);
#define ENTRY(id, ...)                   \
  BB_MEMBRANE_LANES(membrane::id, float) \
  BB_MEMBRANE_LANES(membrane::id, double)
#include "core/energy/registry.inc"
#undef ENTRY
#undef BB_MEMBRANE_LANES

}  // namespace bb
