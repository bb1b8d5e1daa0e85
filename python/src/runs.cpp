// Runs: one step at a time (SteppedRun), and whole as `bench run` makes them.
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "core/base/record/program_file.hpp"
#include "core/base/record/writer.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/runner.hpp"
#include "experiments/run/stepped_run.hpp"
#include "experiments/validity/stored_block.hpp"
#include "python/src/bindings.hpp"
#include "python/src/record_object.hpp"

namespace bb::python {
namespace {

/// name, file, sha256 of what Python brings to the run.
using Brought = std::vector<std::tuple<std::string, std::string, std::string>>;

/// A warning of Python, at the line that called the module.
void warn(const std::string& text) {
  const nb::gil_scoped_acquire locked;
  constexpr int caller_of_the_module = 2;
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), caller_of_the_module) != 0) throw nb::python_error();
}

RunOptions options_of(const std::string& folder, const std::vector<std::string>& argv,
                      const Brought& brought) {
  RunOptions options;
  options.folder = folder;
  options.argv = argv;
  options.tell = warn;
  for (const auto& [name, file, sha256] : brought) options.plugins.push_back({name, file, sha256});
  return options;
}

/// The checks of this build; made once a build, beside the module.
BuildValidity build_validity(const std::vector<PluginFile>& plugins) {
  const auto folder = std::filesystem::path(program_file()).parent_path() / "validity";
  return block_of_this_build(folder, plugins).validity;
}

/// Requires the GIL.
void look_for_signals() {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

class PythonRun {
 public:
  PythonRun(const std::string& text, const std::string& source, const std::string& config_folder,
            const std::vector<std::string>& overrides, const std::string& folder,
            const std::vector<std::string>& argv, const Brought& brought, bool checked, bool replace) {
    const nb::gil_scoped_release unlocked;
    const RunConfig config = parse_config(text, source, config_folder, overrides);
    RunOptions options = options_of(folder, argv, brought);
    options.replace = replace ? Replace::all : Replace::own;
    if (checked) options.build = build_validity(options.plugins);
    run_ = std::make_unique<SteppedRun>(config, std::move(options));
    x_ = run_->x();
    v_ = run_->v();
  }
  ~PythonRun() { close(); }

  nb::object step(const nb::object& on_iteration) {
    if (busy_) throw std::runtime_error("a step of this run is under way");
    busy_ = true;
    const StepRecord* record = nullptr;
    try {
      const nb::gil_scoped_release unlocked;
      record = &run().step([&on_iteration](const IterationReport& report) {
        const nb::gil_scoped_acquire locked;
        look_for_signals();
        if (!on_iteration.is_none()) on_iteration(object_of(static_cast<const TraceRow&>(report)));
      });
      x_ = run_->x();
      v_ = run_->v();
    } catch (...) {
      busy_ = false;
      throw;
    }
    busy_ = false;
    return object_of(*record);
  }

  SteppedRun& run() const {
    if (!run_) throw std::runtime_error("the run is closed");
    return *run_;
  }
  void close() {
    if (busy_) throw std::runtime_error("a step of this run is under way");
    const nb::gil_scoped_release unlocked;
    run_.reset();
  }
  /// Of this object, so that views stay what they are: [n, 3], the state now.
  const Positions& x() const { return x_; }
  const Positions& v() const { return v_; }

 private:
  std::unique_ptr<SteppedRun> run_;
  Positions x_, v_;
  bool busy_ = false;
};

/// What Python reports during a whole run. The first exception stops the run between two steps, as a signal does.
class Listener {
 public:
  explicit Listener(const nb::object& on_step) : on_step_(on_step) {}
  void hear(const Progress& progress) {
    if (stop) return;
    const nb::gil_scoped_acquire locked;
    try {
      look_for_signals();
      if (!on_step_.is_none()) on_step_(fields(progress));
    } catch (nb::python_error& error) {
      error_.emplace(std::move(error));
      stop = true;
    }
  }
  /// Requires the GIL.
  void tell() {
    if (!error_) return;
    nb::python_error error = std::move(*error_);
    error_.reset();
    throw error;
  }
  std::atomic<bool> stop = false;

 private:
  static nb::dict fields(const Progress& p) {
    nb::dict out;
    out["pass"] = p.pass;
    out["step"] = p.step;
    out["steps"] = p.steps;
    out["t_s"] = p.t_s;
    out["newton_iterations"] = p.newton;
    out["contacts"] = p.contacts;
    out["gap_min_m"] = object_of(p.gap);
    out["elapsed_s"] = p.elapsed_s;
    out["eta_s"] = p.eta_s;
    return out;
  }
  const nb::object& on_step_;
  std::optional<nb::python_error> error_;
};

std::string run_whole(const std::string& text, const std::string& source, const std::string& config_folder,
                      const std::vector<std::string>& overrides, const std::string& folder,
                      const std::vector<std::string>& argv, const Brought& brought, const nb::object& on_step,
                      bool resume, bool replace) {
  Listener listener(on_step);
  std::string out;
  try {
    const nb::gil_scoped_release unlocked;
    const RunConfig config = parse_config(text, source, config_folder, overrides);
    RunOptions options =
        options_of(folder.empty() ? "results/runs/" + run_label(config) : folder, argv, brought);
    options.build = build_validity(options.plugins);
    options.replace = replace ? Replace::all : Replace::own;
    options.resume = resume ? Resume::yes : Resume::no;
    options.interrupted = &listener.stop;
    options.progress = [&listener](const Progress& progress) { listener.hear(progress); };
    run_config(config, options);
    out = options.folder.string();
  } catch (const Interrupted& stopped) {
    listener.tell();
    throw std::runtime_error("interrupted: " + stopped.kept);
  }
  listener.tell();
  return out;
}

}  // namespace

void bind_runs(nb::module_& m) {
  nb::class_<PythonRun>(m, "Run", "A run by single steps.")
      .def(nb::init<const std::string&, const std::string&, const std::string&,
                    const std::vector<std::string>&, const std::string&, const std::vector<std::string>&,
                    const Brought&, bool, bool>(),
           nb::arg("text"), nb::arg("source"), nb::arg("config_folder"), nb::arg("overrides"),
           nb::arg("folder"), nb::arg("argv"), nb::arg("brought"), nb::arg("checked"), nb::arg("replace"))
      .def("step", &PythonRun::step, nb::arg("on_iteration").none())
      .def("close", &PythonRun::close)
      .def("over", [](const PythonRun& r) { return r.run().over(); })
      .def("outcome", [](const PythonRun& r) { return std::string(to_string(r.run().verdict().outcome)); })
      .def("detail", [](const PythonRun& r) { return r.run().verdict().detail; })
      .def("time", [](const PythonRun& r) { return r.run().time(); })
      .def("steps", [](const PythonRun& r) { return r.run().steps(); })
      .def("state_hash", [](const PythonRun& r) { return state_hash(r.run().x()); })
      .def("scene", [](const PythonRun& r) { return arrays_of(r.run().scene()); })
      .def("config_json", [](const PythonRun& r) { return resolved_json(r.run().config()); })
      .def("record_json", [](const PythonRun& r) { return to_json(r.run().record()); })
      .def("finish_json", [](const PythonRun& r) { return to_json(r.run().finish()); })
      .def_prop_ro(
          "positions",
          [](const nb::object& self) { return state_view(self, nb::cast<const PythonRun&>(self).x()); })
      .def_prop_ro("velocities", [](const nb::object& self) {
        return state_view(self, nb::cast<const PythonRun&>(self).v());
      });
  m.def("run_whole", &run_whole, nb::arg("text"), nb::arg("source"), nb::arg("config_folder"),
        nb::arg("overrides"), nb::arg("folder"), nb::arg("argv"), nb::arg("brought"),
        nb::arg("on_step").none(), nb::arg("resume"), nb::arg("replace"),
        "Runs and writes; returns the folder of the record.");
}

}  // namespace bb::python
