// Backward Euler. c = 1, x_tilde = x_n + h v_n, v = (x - x_n)/h. First order,
// dissipative, unconditionally stable.
#include "core/model/integrators/registry.hpp"

namespace bb {
namespace {
class ImplicitEuler final : public Integrator {
 public:
  std::string_view name() const override { return "implicit_euler"; }
  void predict(const History& history, double dt, Prediction& out) const override {
    out.c = 1;
    out.x_tilde = history.x + dt * history.v;
  }
  void finish(const History& history, double dt, const Prediction&, const Positions& x, Positions& v,
              Positions&) const override {
    v = (x - history.x) / dt;
  }
};
}  // namespace

IntegratorEntry integrator_implicit_euler() {
  IntegratorEntry entry;
  entry.make = [](const ParameterMap&) -> std::unique_ptr<Integrator> {
    return std::make_unique<ImplicitEuler>();
  };
  return entry;
}

}  // namespace bb
