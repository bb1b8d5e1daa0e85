// Stiffness policy `fixed`: the same kappa (N/m) for every contact and every iteration.
#include <algorithm>

#include "barriers/matching.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

class Fixed final : public StiffnessPolicy {
 public:
  explicit Fixed(double kappa) : kappa_(kappa) {}
  std::string_view name() const override { return "fixed"; }
  std::optional<StiffnessRule> rule() const override { return StiffnessRule{}; }
  Refresh refresh() const override { return Refresh::per_iteration; }
  void fill(const StiffnessBatch& rows, double* kappa) const override {
    std::fill(kappa, kappa + rows.n, kappa_);
  }
  State state() const override { return {kappa_, kappa_, 0, false}; }

 private:
  double kappa_;
};

}  // namespace

StiffnessPolicyEntry policy_fixed() {
  StiffnessPolicyEntry entry;
  entry.parameters = {
      {"kappa_N_per_m", positive("N/m"), no_default, "kappa; absent: the matching rule supplies it"}};
  for (const KappaConvention& convention : kappa_conventions()) {
    entry.parameters.push_back({convention.name, positive(convention.unit), no_default, convention.doc});
  }
  entry.matched = "kappa_N_per_m";
  entry.make = [](const StiffnessPolicyConfig& config) -> std::unique_ptr<StiffnessPolicy> {
    const std::optional<double> kappa = optional_number(config.parameters, "kappa_N_per_m");
    if (!kappa) throw ConfigError("stiffness_policy/kappa_N_per_m", "nothing", "a number > 0 (N/m)");
    return std::make_unique<Fixed>(*kappa * config.multiplier);
  };
  return entry;
}

}  // namespace bb
