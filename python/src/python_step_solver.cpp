// A Python callable as a step solver of the registry, and the step that it is handed. It lives as long as the process.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/math/error.hpp"
#include "core/step_solvers/registry.hpp"
#include "python/src/python_step.hpp"

namespace bb::python {
namespace {

/// Name, meaning, over steps: sum, largest, smallest.
using Counters = std::vector<std::tuple<std::string, std::string, std::string>>;

struct PythonAdvance {
  std::string guarantee;
  Counters counters;
  nb::object drive;  // drive(step) -> status, detail, numbers of the counters in their order
};

constexpr std::array all_statuses = {StepStatus::converged,      StepStatus::iteration_cap,
                                     StepStatus::step_collapse,  StepStatus::line_search_failed,
                                     StepStatus::not_descent,    StepStatus::linear_failed,
                                     StepStatus::pin_infeasible, StepStatus::non_finite};

StepStatus status_of(const std::string& word) {
  for (const StepStatus status : all_statuses) {
    if (to_string(status) == word) return status;
  }
  throw std::logic_error("a status of Python that is none: " + word);
}

class PythonStepSolver final : public StepSolver {
 public:
  PythonStepSolver(StepSolverOptions options, const PythonAdvance& call)
      : options_(std::move(options)), call_(call) {}
  std::string_view name() const override { return options_.name; }
  void require(StepSystem& system) const override {
    if (system.is_on_host()) return;
    throw ConfigError("/step_solver/name", '"' + options_.name + "\", a class of Python, on a device",
                      "/device cpu, or a step solver of the program");
  }

  /// An exception of Python goes on as nb::python_error.
  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport report = start_step(system, task, used);
    const nb::gil_scoped_acquire locked;
    auto* step = new PythonStep(system.on_host(), task, options_, used, report, observer);
    const nb::object owner = nb::cast(step, nb::rv_policy::take_ownership);
    const Closing closing{*step};
    const nb::object drive = call_.drive;  // it may be replaced while it runs
    const auto [word, detail, numbers] =
        nb::cast<std::tuple<std::string, std::string, std::vector<double>>>(drive(owner));
    step->require_sound(options_.name);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      report.solver.values[std::get<0>(call_.counters[i])] = numbers[i];
    }
    const nb::gil_scoped_release unlocked;
    step->finish(status_of(word), detail);
    return report;
  }

 private:
  struct Closing {
    PythonStep& step;
    ~Closing() { step.close(); }
  };
  StepSolverOptions options_;
  const PythonAdvance& call_;
};

OverSteps over_steps_of(const std::string& word) {
  if (word == "sum") return OverSteps::sum;
  return word == "largest" ? OverSteps::largest : OverSteps::smallest;
}

StepSolverEntry entry_of(const std::string& name, const std::string& doc, const PythonAdvance& call) {
  StepSolverEntry entry;
  entry.name = name;
  entry.doc = doc;
  entry.guarantee = call.guarantee;
  for (const auto& [counter, meaning, over] : call.counters) {
    entry.counters.push_back({counter, name + ": " + meaning, over_steps_of(over)});
  }
  entry.needs.minimum = false;
  entry.asked_to_converge = false;  // that is its own word: how far an end is from the solution is measured
  entry.settings.unbounded = [](const ParameterMap&) {
    return true;
  };  // whether it requests bounds nobody knows
  entry.make = [&call](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<PythonStepSolver>(options, call);
  };
  return entry;
}

std::map<std::string, PythonAdvance*>& known() {
  static auto* calls = new std::map<std::string, PythonAdvance*>;  // outlives the interpreter
  return *calls;
}

void register_step_solver(const std::string& name, const std::string& doc, const std::string& guarantee,
                          const Counters& counters, nb::object drive) {
  if (const auto found = known().find(name); found != known().end()) {
    if (found->second->counters != counters || found->second->guarantee != guarantee) {
      throw ConfigError("step solver", '"' + name + "\" with other counters or another guarantee",
                        "what it was registered with, or another name");
    }
    found->second->drive = std::move(drive);
    return;
  }
  const std::vector<SolverCounter> taken = step_solver_counters();
  for (const auto& [counter, meaning, over] : counters) {
    if (!find_named(taken, counter)) continue;
    throw ConfigError("step solver " + name, "the counter \"" + counter + '"',
                      "one that no other step solver declares");
  }
  auto call = std::make_unique<PythonAdvance>(PythonAdvance{guarantee, counters, std::move(drive)});
  step_solvers().add(entry_of(name, doc, *call), "step solver");
  known().emplace(name, call.release());
}

nb::ndarray<nb::numpy, const double> points_of(const nb::object& self,
                                               const Positions& (PythonStep::*get)() const) {
  return state_view(self, (nb::cast<const PythonStep&>(self).*get)());
}

template <const Positions& (PythonStep::*get)() const>
nb::ndarray<nb::numpy, const double> look_at(const nb::object& self) {
  return points_of(self, get);
}

nb::tuple system_of(PythonStep& step) {
  PythonStep::System found;
  {
    const nb::gil_scoped_release unlocked;
    found = step.system();
  }
  const std::size_t starts = found.starts.size(), n = found.values.size(), free = found.right_side.size();
  return nb::make_tuple(array_of(std::move(found.starts), starts), array_of(std::move(found.rows), n),
                        array_of(std::move(found.values), n), array_of(std::move(found.right_side), free));
}

nb::ndarray<nb::numpy, double> direction_of(PythonStep& step) {
  const Positions dx = step.direction();
  return array_of(std::vector<double>(dx.data(), dx.data() + dx.size()), dx.cols(), 3);
}

}  // namespace

void bind_python_step_solver(nb::module_& m) {
  using Unlocked = nb::call_guard<nb::gil_scoped_release>;
  nb::class_<PythonStep>(m, "Step", "A time step, as a step solver of Python sees it.")
      .def_prop_ro("index", &PythonStep::index)
      .def_prop_ro("max_iterations", &PythonStep::max_iterations)
      .def_prop_ro("h", &PythonStep::h)
      .def_prop_ro("tolerance", &PythonStep::tolerance)
      .def_prop_ro("x", &look_at<&PythonStep::x>)
      .def_prop_ro("x_start", &look_at<&PythonStep::x_start>)
      .def_prop_ro("x_tilde", &look_at<&PythonStep::x_tilde>)
      .def_prop_ro("target", &look_at<&PythonStep::target>)
      .def_prop_ro("gradient", &look_at<&PythonStep::gradient>)
      .def("fixed",
           [](const PythonStep& step) {
             return array_of(std::vector<std::uint8_t>(step.fixed()), step.x().cols(), 3);
           })
      .def("energy", &PythonStep::energy, Unlocked())
      .def("at_target", &PythonStep::at_target, Unlocked())
      .def("next", &PythonStep::next, Unlocked())
      .def("iteration", &PythonStep::iteration)
      .def("system", &system_of)
      .def("solve", &PythonStep::solve, Unlocked())
      .def(
          "set_direction",
          [](PythonStep& step, const Column& free) {
            const nb::gil_scoped_release unlocked;
            step.set_direction(free.data(), free.size());
          },
          nb::arg("free"))
      .def("direction", &direction_of)
      .def("slope", &PythonStep::slope)
      .def("error", &PythonStep::error)
      .def("bound", &PythonStep::bound, Unlocked())
      .def("trial", &PythonStep::trial, nb::arg("alpha"), Unlocked())
      .def("feasible", &PythonStep::feasible, nb::arg("alpha"), Unlocked())
      .def("accept", &PythonStep::accept, Unlocked())
      .def("converged", &PythonStep::converged, Unlocked());
  m.def("register_step_solver", &register_step_solver, nb::arg("name"), nb::arg("doc"), nb::arg("guarantee"),
        nb::arg("counters"), nb::arg("drive"));
}

}  // namespace bb::python
