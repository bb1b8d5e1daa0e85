// Every membrane model of the registry and strain limiting.
#pragma once

#include "core/energy/membrane_list.hpp"
#include "core/energy/strain_limit.hpp"
#include "core/energy/triangle_membrane.hpp"
#include "tests/device_check/slots.hpp"

namespace bb::device_check {

template <class T>
BB_HD void write_terms(Slots<T>& slots, const ElementTerms<T, 9>& terms) {
  slots.write(terms.energy), slots.write(terms.grad), slots.write(terms.hess);
}

template <class T>
struct Triangle {
  Vec<T, 3> x[3];
  TriangleRest<T> rest;
  BB_HD explicit Triangle(Slots<T>& slots) {
    for (Vec<T, 3>& p : x) p = slots.template read<Vec<T, 3>>();
    rest = triangle_rest<T>(x, slots.template read<Vec<T, 3>>());
    for (Vec<T, 3>& p : x) p = slots.template read<Vec<T, 3>>();
  }
};

template <class Model, class T>
BB_HD void membrane_model(Slots<T>& slots) {
  const Triangle<T> triangle(slots);
  const T mu = slots.scalar(), lambda = slots.scalar();
  slots.write(membrane_value<Model, 3, T>(triangle.rest, triangle.x, mu, lambda));
  write_terms(slots, membrane_terms<Model, 3, T>(triangle.rest, triangle.x, mu, lambda, Projection::psd));
  write_terms(slots, membrane_terms<Model, 2, T>(triangle.rest, triangle.x, mu, lambda, Projection::none));
}
template <class T>
struct Membranes : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
#define ENTRY(name, ...) membrane_model<membrane::name, T>(slots);
#include "core/energy/registry.inc"
#undef ENTRY
  }
};

template <class T>
struct StrainLimit : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    const Triangle<T> triangle(slots);
    const StrainBand<T> band{slots.scalar(), slots.scalar()};
    const StrainShape<T> shape{slots.template read<Vec<T, 2>>(), slots.template read<Vec<T, 2>>(),
                               slots.template read<Vec<T, 2>>()};
    const Svd32<T> svd = svd_3x2<T>(deformation_gradient<3>(triangle.rest, triangle.x));
    write_terms(slots,
                strain_limit_terms<3, T>(triangle.rest, svd, band, shape, slots.scalar(), Projection::psd));
    const Vec<T, 3> dx[3] = {triangle.x[1], triangle.x[2], triangle.x[0]};
    slots.write(strain_step_bound<3, T>(triangle.rest, triangle.x, dx, band));
  }
};

}  // namespace bb::device_check
