// Backward Euler whose prediction has g h^2/2 in the place of the g h^2 that the weight would add: x_tilde = x_n + h v_n, half of the
// weight acts, v = (x - x_n)/h. As jaxls's "Cloth draping" has it, whose prediction is x_n + h v_n + g h^2/2. Since v grows by g h/2
// a step, a body falls with g/2 however small h is: the limit is the motion under half of the gravity.
#include "core/model/integrators/registry.hpp"

namespace bb {
namespace {
class HalfGravity final : public Integrator {
 public:
  std::string_view name() const override { return "half_gravity"; }
  double weight_factor() const override { return 0.5; }
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

IntegratorEntry integrator_half_gravity() {
  IntegratorEntry entry;
  entry.make = [](const ParameterMap&) -> std::unique_ptr<Integrator> {
    return std::make_unique<HalfGravity>();
  };
  return entry;
}

}  // namespace bb
