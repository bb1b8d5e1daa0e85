// What the files of this module share: arrays as numpy has them, and the part of the module that each file makes.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "core/math/types.hpp"

namespace bb {
struct Scene;
}

namespace bb::python {

namespace nb = nanobind;

/// Read-only doubles in the order of C, as numpy.ascontiguousarray gives them.
template <class Shape>
using In = nb::ndarray<const double, Shape, nb::c_contig, nb::device::cpu>;
using Column = In<nb::shape<-1>>;

/// A numpy array of this shape that owns the values.
template <class T, class... N>
nb::ndarray<nb::numpy, T> array_of(std::vector<T> values, N... sizes) {
  auto* kept = new std::vector<T>(std::move(values));
  nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  const std::size_t shape[] = {static_cast<std::size_t>(sizes)...};
  return nb::ndarray<nb::numpy, T>(kept->data(), sizeof...(N), shape, owner);
}

/// A numpy array of this shape that only looks at the values.
template <class T, class... N>
nb::ndarray<nb::numpy, T> view_of(T* values, N... sizes) {
  const std::size_t shape[] = {static_cast<std::size_t>(sizes)...};
  return nb::ndarray<nb::numpy, T>(values, sizeof...(N), shape, nb::capsule(values, [](void*) noexcept {}));
}

/// [n, 3], a read-only view of a state that `owner` holds.
inline nb::ndarray<nb::numpy, const double> state_view(const nb::object& owner, const Positions& state) {
  const std::size_t shape[] = {static_cast<std::size_t>(state.cols()), 3};
  return nb::ndarray<nb::numpy, const double>(state.data(), 2, shape, owner);
}

void bind_shapes(nb::module_& module);
void bind_geometry(nb::module_& module);
void bind_condition(nb::module_& module);
void bind_lists(nb::module_& module);
void bind_scene(nb::module_& module);
/// The fields of barrierbench.Scene.
nb::dict arrays_of(const Scene& scene);
void bind_python_shape(nb::module_& module);
void bind_python_policy(nb::module_& module);
void bind_python_step_solver(nb::module_& module);
void bind_runs(nb::module_& module);
void bind_evaluate(nb::module_& module);

}  // namespace bb::python
