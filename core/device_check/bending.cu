// Springs and hinges as device code.
#include "core/device_check/slots.hpp"
#include "core/energy/hinge.hpp"
#include "core/energy/spring.hpp"

namespace bb::device_check {

template <class T>
__global__ void spring(const T* in, T* out) {
  Slots<T> slots{in, out};
  const Vec<T, 3> x[2] = {slots.template read<Vec<T, 3>>(), slots.template read<Vec<T, 3>>()};
  const T stiffness = slots.scalar(), rest_length = slots.scalar();
  const ElementTerms<T, 6> terms = spring_terms<T>(x, stiffness, rest_length, Projection::psd);
  slots.write(terms.energy), slots.write(terms.grad), slots.write(terms.hess);
}
BB_DEVICE_CHECK(spring);

template <class T>
__global__ void hinge(const T* in, T* out) {
  Slots<T> slots{in, out};
  Vec<T, 3> x[4];
  for (Vec<T, 3>& p : x) p = slots.template read<Vec<T, 3>>();
  const T stiffness = slots.scalar(), rest_angle = slots.scalar();
  const ElementTerms<T, 12> terms = hinge_terms<T>(x, stiffness, rest_angle, Projection::psd);
  slots.write(terms.energy), slots.write(terms.grad), slots.write(terms.hess);
}
BB_DEVICE_CHECK(hinge);

}  // namespace bb::device_check
