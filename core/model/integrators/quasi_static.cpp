// No inertia (1/c = 0, stored as c = 0) and no velocity; the external force is applied in load steps.
#include "core/model/integrators/registry.hpp"

namespace bb {
namespace {
class QuasiStatic final : public Integrator {
 public:
  std::string_view name() const override { return "quasi_static"; }
  bool quasi_static() const override { return true; }
  void predict(const History& history, double, Prediction& out) const override {
    out.c = 0;
    out.x_tilde = history.x;
  }
  void finish(const History&, double, const Prediction&, const Positions& x, Positions& v,
              Positions&) const override {
    v.setZero(3, x.cols());
  }
};
}  // namespace

IntegratorEntry integrator_quasi_static() {
  IntegratorEntry entry;
  entry.make = [](const ParameterMap&) -> std::unique_ptr<Integrator> {
    return std::make_unique<QuasiStatic>();
  };
  return entry;
}

}  // namespace bb
