// Queries of `eval`: one JSON object a line.
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <sstream>
#include <tuple>

#include "experiments/eval/eval.hpp"
#include "python/src/bindings.hpp"

namespace bb::python {

void bind_evaluate(nb::module_& m) {
  m.def(
      "evaluate_lines",
      [](const std::string& lines) {
        std::istringstream in(lines);
        std::ostringstream out, err;
        const int code = run_eval(in, out, err);
        return std::make_tuple(code, out.str(), err.str());
      },
      nb::arg("lines"), "Exit code, answers, complaints of the verb eval.");
  m.def(
      "run_eval",
      [](const std::string& file) {
        const nb::gil_scoped_release unlocked;
        return run_eval(file);
      },
      nb::arg("file"), "The verb eval on a file, or - for the standard input; its exit code.");
  m.def("eval_schema", [] {
    std::ostringstream out;
    print_eval_schema(out);
    return out.str();
  });
}

}  // namespace bb::python
