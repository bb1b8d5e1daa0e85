// Second-order backward differentiation for x' = v, M v' = force:
//   x = (4 x_n - x_{n-1})/3 + (2h/3) v,   v = (4 v_n - v_{n-1})/3 + (2h/3) a
// so c = 4/9, x_tilde = (4 x_n - x_{n-1})/3 + h (8 v_n - 2 v_{n-1})/9. The first step is implicit Euler, and so is
// every step that is not as long as the one before, whose coefficients these are not, or from which on other vertices are
// prescribed: it starts anew.
#include "core/model/integrators/registry.hpp"

namespace bb {
namespace {
bool starts(const History& history, double dt) {
  return history.steps == 0 || history.anew || (history.dt_prev > 0 && history.dt_prev != dt);
}

class Bdf2 final : public Integrator {
 public:
  std::string_view name() const override { return "bdf2"; }
  bool one_step() const override { return false; }
  void predict(const History& history, double dt, Prediction& out) const override {
    if (starts(history, dt)) {
      out.c = 1;
      out.x_tilde = history.x + dt * history.v;
      return;
    }
    out.c = 4.0 / 9.0;
    out.x_tilde = (4 * history.x - history.x_prev) / 3 + (dt / 9) * (8 * history.v - 2 * history.v_prev);
  }
  void finish(const History& history, double dt, const Prediction&, const Positions& x, Positions& v,
              Positions&) const override {
    if (starts(history, dt)) {
      v = (x - history.x) / dt;
      return;
    }
    v = (3 * x - 4 * history.x + history.x_prev) / (2 * dt);
  }
};
}  // namespace

IntegratorEntry integrator_bdf2() {
  IntegratorEntry entry;
  entry.make = [](const ParameterMap&) -> std::unique_ptr<Integrator> { return std::make_unique<Bdf2>(); };
  return entry;
}

}  // namespace bb
