// Every barrier shape of the registry as device code.
#include "barriers/shapes/gap_potential.hpp"
#include "core/device_check/shape_list.hpp"
#include "core/device_check/slots.hpp"

namespace bb::device_check {

template <class T>
__global__ void every_shape(const T* in, T* out) {
  Slots<T> slots{in, out};
  const T d = slots.scalar(), d_hat = slots.scalar();
#define BB_CHECK_SHAPE(S)                                                \
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
BB_DEVICE_CHECK(every_shape);

}  // namespace bb::device_check
