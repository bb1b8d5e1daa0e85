// Newmark's method with beta = 1/4, gamma = 1/2 (trapezoidal rule): c = 1/4,
//   x_tilde = x_n + h v_n + h^2/4 a_n,   a = 4 (x - x_tilde)/h^2,   v = v_n + h/2 (a_n + a).
// Second order, no numerical damping.
#include "core/model/integrators/registry.hpp"

namespace bb {
namespace {
class Newmark final : public Integrator {
 public:
  std::string_view name() const override { return "newmark"; }
  bool needs_acceleration() const override { return true; }
  void predict(const History& history, double dt, Prediction& out) const override {
    out.c = 0.25;
    out.x_tilde = history.x + dt * history.v + (dt * dt / 4) * history.a;
  }
  void finish(const History& history, double dt, const Prediction& used, const Positions& x, Positions& v,
              Positions& a) const override {
    a = (4 / (dt * dt)) * (x - used.x_tilde);
    v = history.v + (dt / 2) * (history.a + a);
  }
};
}  // namespace

IntegratorEntry integrator_newmark() {
  IntegratorEntry entry;
  entry.make = [](const ParameterMap&) -> std::unique_ptr<Integrator> { return std::make_unique<Newmark>(); };
  return entry;
}

}  // namespace bb
