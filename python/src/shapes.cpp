// Shapes, what a contact does under a load, and the matching rules.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "barriers/matching.hpp"
#include "barriers/shapes/registry.hpp"
#include "core/barrier/shape.hpp"
#include "core/math/error.hpp"
#include "python/src/bindings.hpp"

namespace bb::python {
namespace {

using Terms = std::tuple<nb::ndarray<nb::numpy, double>, nb::ndarray<nb::numpy, double>,
                         nb::ndarray<nb::numpy, double>>;

BarrierFunction make_barrier(const std::string& shape, const std::string& argument) {
  return {require_shape(shape), require_argument(argument)};
}

Terms terms_of(const BarrierFunction& barrier, const Column& d, const Column& d_hat) {
  const std::size_t n = d.shape(0);
  if (d_hat.shape(0) != n) {
    throw ConfigError("d_hat", std::to_string(d_hat.shape(0)) + " values",
                      "as many as d: " + std::to_string(n));
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!(d(i) >= 0)) throw ConfigError("d[" + std::to_string(i) + "]", std::to_string(d(i)), "a gap >= 0 m");
    if (!(d_hat(i) > 0))
      throw ConfigError("d_hat[" + std::to_string(i) + "]", std::to_string(d_hat(i)), "a distance > 0 m");
  }
  std::vector<double> b(n), db(n), d2b(n);
  barrier.eval(n, d.data(), d_hat.data(), b.data(), db.data(), d2b.data());
  return {array_of(std::move(b), n), array_of(std::move(db), n), array_of(std::move(d2b), n)};
}

}  // namespace

void bind_shapes(nb::module_& m) {
  m.def("shape_names", &shape_names, "Names of all shapes, those of plugins and of Python among them.");
  nb::class_<BarrierFunction>(m, "Barrier", "A shape on its argument.")
      .def(
          "__init__",
          [](BarrierFunction* self, const std::string& shape, const std::string& argument) {
            new (self) BarrierFunction(make_barrier(shape, argument));
          },
          nb::arg("shape"), nb::arg("argument"))
      .def_prop_ro("name", [](const BarrierFunction& b) { return b.shape.name; })
      .def_prop_ro("doc", [](const BarrierFunction& b) { return b.shape.doc; })
      .def_prop_ro("argument", [](const BarrierFunction& b) { return std::string(to_string(b.argument)); })
      .def_prop_ro("smoothness_at_d_hat",
                   [](const BarrierFunction& b) { return b.shape.smoothness_at_d_hat; })
      .def_prop_ro("infinite_at_zero", [](const BarrierFunction& b) { return b.shape.infinite_at_zero; })
      .def("terms", &terms_of, nb::arg("d"), nb::arg("d_hat"), "b, b', b'' of columns of equal length.")
      .def("rho", &rho, nb::arg("u"))
      .def("equal_force", &match_equal_force, nb::arg("d_hat"), nb::arg("load"), nb::arg("theta"))
      .def("equal_curvature", &match_equal_curvature, nb::arg("d_hat"), nb::arg("curvature"),
           nb::arg("theta"))
      .def(
          "equilibrium",
          [](const BarrierFunction& b, double kappa, double d_hat, double load) {
            const Equilibrium e = equilibrium(b, kappa, d_hat, load);
            return std::make_tuple(e.above_capacity, e.d, e.stiffness, e.capacity);
          },
          nb::arg("kappa"), nb::arg("d_hat"), nb::arg("load"), "above_capacity, d, stiffness, capacity.");
}

}  // namespace bb::python
