// Stiffness policy `fixed`: the same kappa (N/m) for every contact and every iteration.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "barriers/stiffness/registry.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

class Fixed final : public StiffnessPolicy {
 public:
  explicit Fixed(double kappa) : kappa_(kappa) {}
  std::string_view name() const override { return "fixed"; }
  Refresh refresh() const override { return Refresh::per_iteration; }
  void fill(const StiffnessBatch& rows, double* kappa) const override {
    std::fill(kappa, kappa + rows.n, kappa_);
  }
  State state() const override { return {kappa_, kappa_, 0, false}; }

 private:
  double kappa_;
};

}  // namespace

std::unique_ptr<StiffnessPolicy> make_policy_fixed(const StiffnessPolicyConfig& config);
std::unique_ptr<StiffnessPolicy> make_policy_fixed(const StiffnessPolicyConfig& config) {
  if (!(config.kappa > 0) || !std::isfinite(config.kappa)) {
    throw ConfigError("stiffness_policy/kappa_N_per_m", fmt::format("{}", config.kappa), "a number > 0");
  }
  return std::make_unique<Fixed>(config.kappa * config.multiplier);
}

}  // namespace bb
