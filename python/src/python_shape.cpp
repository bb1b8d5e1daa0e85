// A Python callable as a shape of the registry. It lives as long as the process, as a plugin does.
#include <nanobind/stl/string.h>

#include <map>
#include <string>
#include <vector>

#include "barriers/shapes/registry.hpp"
#include "core/math/error.hpp"
#include "python/src/bindings.hpp"

namespace bb::python {
namespace {

struct PythonShape {
  nb::object fill;  // fill(d, d_hat, b, db, d2b) writes the last three
};

/// Called by threads of the run. An exception of Python goes on as nb::python_error.
void fill_double(void* self, std::size_t n, const double* d, const double* d_hat, double* b, double* db,
                 double* d2b) {
  if (n == 0) return;
  const nb::gil_scoped_acquire locked;
  static_cast<PythonShape*>(self)->fill(view_of(d, n), view_of(d_hat, n), view_of(b, n), view_of(db, n),
                                        view_of(d2b, n));
}

void fill_float(void* self, std::size_t n, const float* d, const float* d_hat, float* b, float* db,
                float* d2b) {
  const std::vector<double> gap(d, d + n), width(d_hat, d_hat + n);
  std::vector<double> value(n), slope(n), curvature(n);
  fill_double(self, n, gap.data(), width.data(), value.data(), slope.data(), curvature.data());
  for (std::size_t i = 0; i < n; ++i) {
    b[i] = static_cast<float>(value[i]);
    db[i] = static_cast<float>(slope[i]);
    d2b[i] = static_cast<float>(curvature[i]);
  }
}

/// By name; one that is registered again under the same declaration gets the new callable.
std::map<std::string, PythonShape*>& known() {
  static auto* shapes = new std::map<std::string, PythonShape*>;  // outlives the interpreter
  return *shapes;
}

void register_shape(const std::string& name, const std::string& doc, int smoothness, bool infinite,
                    nb::object fill) {
  if (const auto found = known().find(name); found != known().end()) {
    const Shape& before = *all_shapes().find(name);
    if (before.smoothness_at_d_hat != smoothness || before.infinite_at_zero != infinite) {
      throw ConfigError("shape", '"' + name + "\" with another smoothness_at_d_hat or infinite_at_zero",
                        "what it was registered with, or another name");
    }
    found->second->fill = std::move(fill);
    return;
  }
  auto* self = new PythonShape{std::move(fill)};
  Shape shape;
  shape.name = name;
  shape.doc = doc;
  shape.smoothness_at_d_hat = smoothness;
  shape.infinite_at_zero = infinite;
  shape.batch_double = fill_double;
  shape.batch_float = fill_float;
  shape.self = self;
  try {
    all_shapes().add(shape, "shape");
  } catch (...) {
    delete self;
    throw;
  }
  known().emplace(name, self);
}

}  // namespace

void bind_python_shape(nb::module_& m) {
  m.def("register_shape", &register_shape, nb::arg("name"), nb::arg("doc"), nb::arg("smoothness_at_d_hat"),
        nb::arg("infinite_at_zero"), nb::arg("fill"));
}

}  // namespace bb::python
