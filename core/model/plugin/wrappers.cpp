// Hands columns to a plugin's calls and back; no arithmetic beyond the matching multiplier.
#include "core/model/plugin/wrappers.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "core/math/error.hpp"

namespace bb {
namespace {

static_assert(std::is_same_v<std::int32_t, int>, "StiffnessBatch::n_free is handed over as it is");

class PluginStiffness final : public StiffnessPolicy {
 public:
  PluginStiffness(const bb_plugin_policy& policy, Refresh refresh, double multiplier)
      : policy_(policy), refresh_(refresh), multiplier_(multiplier) {}
  std::string_view name() const override { return policy_.name; }
  Refresh refresh() const override { return refresh_; }
  bool needs_hessian() const override { return policy_.needs_hessian != 0; }

  void fill(const StiffnessBatch& rows, double* kappa) const override {
    const bb_plugin_rows columns{rows.n,     rows.n_free, rows.weight,  rows.normal,  rows.d,
                                 rows.d_hat, rows.mass,   rows.hessian, rows.time.dt, rows.time.c};
    policy_.fill(policy_.self, &columns, kappa);
    for (std::size_t r = 0; r < rows.n; ++r) kappa[r] *= multiplier_;
  }

 private:
  const bb_plugin_policy& policy_;
  Refresh refresh_;
  double multiplier_;
};

class PluginIntegrator final : public Integrator {
 public:
  explicit PluginIntegrator(const bb_plugin_integrator& integrator) : integrator_(integrator) {}
  std::string_view name() const override { return integrator_.name; }
  bool needs_acceleration() const override { return integrator_.needs_acceleration != 0; }

  void predict(const History& history, double dt, Prediction& out) const override {
    const bb_plugin_history columns = view(history);
    out.x_tilde.resize(3, history.x.cols());
    integrator_.predict(integrator_.self, &columns, dt, &out.c, out.x_tilde.data());
    if (!(out.c > 0) || !std::isfinite(out.c)) {
      throw ConfigError(fmt::format("plugin integrator {}", name()), fmt::format("c = {}", out.c),
                        "a finite c > 0");
    }
  }

  void finish(const History& history, double dt, const Prediction& used, const Positions& x, Positions& v,
              Positions& a) const override {
    const bb_plugin_history columns = view(history);
    v.resize(3, x.cols());
    a.resize(3, x.cols());
    integrator_.finish(integrator_.self, &columns, dt, used.c, used.x_tilde.data(), x.data(), v.data(),
                       a.data());
  }

 private:
  bb_plugin_history view(const History& history) const {
    const bool before = history.steps >= 1;
    return {static_cast<std::size_t>(history.x.cols()),
            history.steps,
            history.x.data(),
            history.v.data(),
            needs_acceleration() ? history.a.data() : nullptr,
            before ? history.x_prev.data() : nullptr,
            before ? history.v_prev.data() : nullptr};
  }

  const bb_plugin_integrator& integrator_;
};

}  // namespace

std::unique_ptr<StiffnessPolicy> wrap_policy(const bb_plugin_policy& policy, Refresh refresh,
                                             double multiplier) {
  return std::make_unique<PluginStiffness>(policy, refresh, multiplier);
}
std::unique_ptr<Integrator> wrap_integrator(const bb_plugin_integrator& integrator) {
  return std::make_unique<PluginIntegrator>(integrator);
}

}  // namespace bb
