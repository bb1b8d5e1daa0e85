#include "core/energy/membrane_lanes.hpp"

#include "core/energy/corotational.hpp"
#include "core/math/lanes.hpp"
#include "core/math/lower_blocks.hpp"

namespace bb {
namespace {

template <class T>
struct InLanes {
  using Real = Lanes<T, membrane_lanes>;
  Vec<Real, 3> x[3];
  TriangleRest<Real> rest;
  Real lame_mu, lame_lambda;

  explicit InLanes(const TrianglesAbreast<T>& from)
      : lame_mu(load_lanes<membrane_lanes>(from.lame_mu)),
        lame_lambda(load_lanes<membrane_lanes>(from.lame_lambda)) {
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 3; ++c) x[i][c] = load_lanes<membrane_lanes>(from.x[3 * i + c]);
    }
    for (int k = 0; k < 4; ++k) rest.dm_inv.data()[k] = load_lanes<membrane_lanes>(from.dm_inv[k]);
    rest.area = load_lanes<membrane_lanes>(from.area);
  }
};

}  // namespace

template <class T>
void corotational_values_abreast(const TrianglesAbreast<T>& triangles, T (&energy)[membrane_lanes]) {
  const InLanes<T> of(triangles);
  store_lanes(membrane_value<membrane::corotational, 3>(of.rest, of.x, of.lame_mu, of.lame_lambda), energy);
}

template <class T>
void corotational_terms_abreast(const TrianglesAbreast<T>& triangles, Projection projection,
                                TermsAbreast<T, membrane_lanes, 3>& out) {
  const InLanes<T> of(triangles);
  const auto terms =
      membrane_terms<membrane::corotational, 3>(of.rest, of.x, of.lame_mu, of.lame_lambda, projection);
  store_lanes(terms.energy, out.energy);
  for (int k = 0; k < 9; ++k) store_lanes(terms.grad[k], out.grad[k]);
  T(*to)[membrane_lanes] = out.hess;
  for_each_lower_number(3, [&](int row, int column) { store_lanes(terms.hess(row, column), *to++); });
}

template void corotational_values_abreast(const TrianglesAbreast<float>&, float (&)[membrane_lanes]);
template void corotational_values_abreast(const TrianglesAbreast<double>&, double (&)[membrane_lanes]);
template void corotational_terms_abreast(const TrianglesAbreast<float>&, Projection,
                                         TermsAbreast<float, membrane_lanes, 3>&);
template void corotational_terms_abreast(const TrianglesAbreast<double>&, Projection,
                                         TermsAbreast<double, membrane_lanes, 3>&);

}  // namespace bb
