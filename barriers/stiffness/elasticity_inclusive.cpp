// Stiffness policy `elasticity_inclusive`: kappa of each contact from its masses and its elastic Hessian.
#include "barriers/stiffness/elasticity_inclusive.hpp"

#include <algorithm>

#include "barriers/stiffness/registry.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

class ElasticityInclusive final : public StiffnessPolicy {
 public:
  explicit ElasticityInclusive(const StiffnessPolicyConfig& config)
      : mass_term_(require_mass_term(text(config.parameters, "mass_term"))),
        elastic_term_(boolean(config.parameters, "elastic_term")),
        refresh_(require_refresh(text(config.parameters, "refresh"))),
        gap_floor_(number(config.parameters, "gap_floor")),
        derivative_(require_derivative(text(config.parameters, "derivative"))),
        multiplier_(config.multiplier) {}
  std::string_view name() const override { return "elasticity_inclusive"; }
  Refresh refresh() const override { return refresh_; }
  bool needs_hessian() const override { return elastic_term_; }
  std::optional<StiffnessRule> rule() const override {
    return StiffnessRule{false, mass_term_, elastic_term_, refresh_, gap_floor_, derivative_, multiplier_};
  }
  bool has_potential() const override { return derivative_ == KappaDerivative::included; }

  void fill(const StiffnessBatch& rows, double* kappa) const override {
    for (std::size_t r = 0; r < rows.n; ++r) {
      kappa[r] = multiplier_ *
                 elasticity_inclusive_kappa(rows.n_free[r], rows.weight + 4 * r, rows.normal + 3 * r,
                                            std::max(rows.d[r], gap_floor_ * rows.d_hat[r]), rows.d_hat[r],
                                            rows.mass + 4 * r, hessian(rows, r), 12, rule(rows));
    }
  }

  void fill_parts(const StiffnessBatch& rows, KappaParts* parts) const override {
    for (std::size_t r = 0; r < rows.n; ++r) {
      const KappaParts one =
          elasticity_inclusive_parts(rows.n_free[r], rows.weight + 4 * r, rows.normal + 3 * r, rows.d_hat[r],
                                     rows.mass + 4 * r, hessian(rows, r), 12, rule(rows));
      parts[r] = {multiplier_ * one.fixed, multiplier_ * one.per_gap_sq};
    }
  }

 private:
  ElasticityInclusiveRule rule(const StiffnessBatch& rows) const {
    return {mass_term_, elastic_term_, rows.dt, rows.c};
  }
  const double* hessian(const StiffnessBatch& rows, std::size_t r) const {
    return elastic_term_ ? rows.hessian + 144 * r : nullptr;
  }

  MassTerm mass_term_;
  bool elastic_term_;
  Refresh refresh_;
  double gap_floor_;  // of d_hat
  KappaDerivative derivative_;
  double multiplier_;
};

}  // namespace

StiffnessPolicyEntry policy_elasticity_inclusive() {
  StiffnessPolicyEntry entry;
  entry.parameters = {
      {"mass_term", word({"paper", "inertia", "scaled", "none"}), "paper",
       "M/d^2 times 1 m^2/s^2, M/(c h^2), M/(c h^2) (d_hat/d)^2, or 0"},
      {"elastic_term", flag(), true, "whether the elastic Hessian counts"},
      refresh_parameter(),
      gap_floor_parameter(),
      derivative_parameter(),
  };
  entry.make = [](const StiffnessPolicyConfig& config) -> std::unique_ptr<StiffnessPolicy> {
    if (text(config.parameters, "mass_term") == "none" && !boolean(config.parameters, "elastic_term")) {
      throw ConfigError("stiffness_policy", "mass_term none with elastic_term false",
                        "at least one term, else kappa is 0");
    }
    check_derivative(config.parameters, "stiffness_policy");
    return std::make_unique<ElasticityInclusive>(config);
  };
  return entry;
}

}  // namespace bb
