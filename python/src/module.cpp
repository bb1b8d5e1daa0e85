// The module _core: what src/*.cpp bind, and how errors of the modules are reported. The package barrierbench wraps it.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "core/base/record/build_info.hpp"
#include "core/base/record/writer.hpp"
#include "core/linear/blas_kernel.hpp"
#include "core/math/error.hpp"
#include "experiments/config/parse.hpp"
#include "python/src/bindings.hpp"

NB_MODULE(_core, m) {
  using namespace bb::python;
  nb::set_leak_warnings(false);  // shapes of Python live as long as the process
  m.doc() = "Bindings of barrierbench; use the package barrierbench, which documents them.";
  nb::exception<bb::ConfigError>(m, "ConfigError", PyExc_ValueError).doc() =
      "Bad input. The message has a line for each violation: place, value found, what is allowed.";
  nb::exception<bb::RecordError>(m, "RecordError", PyExc_OSError).doc() =
      "Output that cannot be written: path and cause.";
  m.attr("version") = bb::kBuildInfo.version;
  m.attr("git_commit") = bb::kBuildInfo.git_commit;
  m.def(
      "blas_kernel", [] { return bb::blas_kernel_facts().running; }, "The kernel that OpenBLAS runs.");
  m.def("configs_folder", &bb::configs_folder, "The folder of presets, methods and scenes.");
  bind_shapes(m);
  bind_geometry(m);
  bind_condition(m);
  bind_lists(m);
  bind_scene(m);
  bind_evaluate(m);
  bind_python_shape(m);
  bind_python_policy(m);
  bind_python_step_solver(m);
  bind_runs(m);
}
