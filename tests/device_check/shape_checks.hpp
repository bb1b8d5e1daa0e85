// Every barrier shape of the registry.
#pragma once

#include "core/barrier/shape_potential.hpp"
#include "kernel_types.hpp"
#include "tests/device_check/slots.hpp"

namespace bb::device_check {

template <class T>
struct EveryShape : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    const T d_hat = slots.positive() + T(1e-3), d = T(1.25) * d_hat * slots.positive();
#define BB_CHECK_SHAPE(name, S)                                          \
  {                                                                      \
    const ShapeTerms<T> terms = shapes::S::eval(d, d_hat);               \
    slots.write(terms.b), slots.write(terms.db), slots.write(terms.d2b); \
    if constexpr (shapes::HasPotential<shapes::S>) {                     \
      const auto psi = shapes::potential_terms<shapes::S>(d, d_hat);     \
      slots.write(psi.b), slots.write(psi.db), slots.write(psi.d2b);     \
    }                                                                    \
  }
    BB_FOR_EACH_SHAPE(BB_CHECK_SHAPE)
#undef BB_CHECK_SHAPE
  }
};

}  // namespace bb::device_check
