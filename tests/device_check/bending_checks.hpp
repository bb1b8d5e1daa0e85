// Springs and hinges.
#pragma once

#include "core/energy/hinge.hpp"
#include "core/energy/spring.hpp"
#include "tests/device_check/slots.hpp"

namespace bb::device_check {

template <class T>
struct Spring : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    const Vec<T, 3> x[2] = {slots.template read<Vec<T, 3>>(), slots.template read<Vec<T, 3>>()};
    const T stiffness = slots.scalar(), rest_length = slots.scalar();
    const ElementTerms<T, 6> terms = spring_terms<T>(x, stiffness, rest_length, Projection::psd);
    slots.write(terms.energy), slots.write(terms.grad), slots.write(terms.hess);
  }
};

template <class T>
struct Hinge : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    Vec<T, 3> x[4];
    for (Vec<T, 3>& p : x) p = slots.template read<Vec<T, 3>>();
    const T stiffness = slots.scalar(), rest_angle = slots.scalar();
    const ElementTerms<T, 12> terms = hinge_terms<T>(x, Projection::psd, stiffness, rest_angle);
    slots.write(terms.energy), slots.write(terms.grad), slots.write(terms.hess);
  }
};

}  // namespace bb::device_check
