// A Python callable as a stiffness policy of the registry. It lives as long as the process, as a plugin does.
#include <nanobind/stl/string.h>

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "barriers/stiffness/registry.hpp"
#include "core/math/error.hpp"
#include "python/src/bindings.hpp"

namespace bb::python {
namespace {

/// What a name stands for; registered again, it gets the new callable.
struct PythonCall {
  nb::object
      fill;  // fill(n_free, weight, normal, d, d_hat, mass, hessian or None, h, c, kappa) writes the last
  bool needs_hessian;
};

class PythonPolicy final : public StiffnessPolicy {
 public:
  PythonPolicy(std::string name, const PythonCall& call, Refresh refresh, double multiplier)
      : name_(std::move(name)), call_(call), refresh_(refresh), multiplier_(multiplier) {}
  std::string_view name() const override { return name_; }
  Refresh refresh() const override { return refresh_; }
  bool needs_hessian() const override { return call_.needs_hessian; }

  /// An exception of Python goes on as nb::python_error.
  void fill(const StiffnessBatch& rows, double* kappa) const override {
    const std::size_t n = rows.n;
    if (n == 0) return;
    const nb::gil_scoped_acquire locked;
    const nb::object hessian =
        rows.hessian ? nb::cast(view_of(rows.hessian, n, 12, 12)) : nb::object(nb::none());
    call_.fill(view_of(rows.n_free, n), view_of(rows.weight, n, 4), view_of(rows.normal, n, 3),
               view_of(rows.d, n), view_of(rows.d_hat, n), view_of(rows.mass, n, 4), hessian, rows.time.dt,
               rows.time.c, view_of(kappa, n));
    for (std::size_t r = 0; r < n; ++r) kappa[r] *= multiplier_;
  }

 private:
  std::string name_;
  const PythonCall& call_;
  Refresh refresh_;
  double multiplier_;
};

std::map<std::string, PythonCall*>& known() {
  static auto* calls = new std::map<std::string, PythonCall*>;  // outlives the interpreter
  return *calls;
}

void register_policy(const std::string& name, const std::string& doc, bool needs_hessian, nb::object fill) {
  if (const auto found = known().find(name); found != known().end()) {
    *found->second = {std::move(fill), needs_hessian};
    return;
  }
  auto call = std::make_unique<PythonCall>(PythonCall{std::move(fill), needs_hessian});
  const auto make = [name,
                     call = call.get()](const PolicyConfig& config) -> std::unique_ptr<StiffnessPolicy> {
    return std::make_unique<PythonPolicy>(name, *call, require_refresh(text(config.parameters, "refresh")),
                                          config.scale);
  };
  stiffness_policies().add({name, doc, {refresh_parameter()}, "", make}, "stiffness policy");
  known().emplace(name, call.release());
}

}  // namespace

void bind_python_policy(nb::module_& m) {
  m.def("register_policy", &register_policy, nb::arg("name"), nb::arg("doc"), nb::arg("needs_hessian"),
        nb::arg("fill"));
}

}  // namespace bb::python
