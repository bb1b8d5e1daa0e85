#include "core/energy/hinge_lanes.hpp"

#include "core/math/lanes.hpp"
#include "core/math/lower_blocks.hpp"

namespace bb {

template <class T>
void hinge_terms_abreast(const HingesAbreast<T>& hinges, Projection projection,
                         TermsAbreast<T, hinge_lanes, 4>& out) {
  using Real = Lanes<T, hinge_lanes>;
  Vec<Real, 3> x[4];
  for (int i = 0; i < 4; ++i) {
    for (int c = 0; c < 3; ++c) x[i][c] = load_lanes<hinge_lanes>(hinges.x[3 * i + c]);
  }
  Real energy, stiffness, deviation;
  for (std::size_t lane = 0; lane < hinge_lanes; ++lane) {
    const HingeEnergy<T>& of = hinges.energy[lane];
    energy.v[lane] = of.energy, stiffness.v[lane] = of.stiffness, deviation.v[lane] = of.deviation;
  }
  const ElementTerms<Real, 12> terms = hinge_terms_of<Real>(x, {energy, stiffness, deviation}, projection);
  store_lanes(terms.energy, out.energy);
  for (int k = 0; k < 12; ++k) store_lanes(terms.grad[k], out.grad[k]);
  T(*to)[hinge_lanes] = out.hess;
  for_each_lower_number(4, [&](int row, int column) { store_lanes(terms.hess(row, column), *to++); });
}

template void hinge_terms_abreast(const HingesAbreast<float>&, Projection,
                                  TermsAbreast<float, hinge_lanes, 4>&);
template void hinge_terms_abreast(const HingesAbreast<double>&, Projection,
                                  TermsAbreast<double, hinge_lanes, 4>&);

}  // namespace bb
