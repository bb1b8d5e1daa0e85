// A policy whose kappa is a function of one item, from its struct of values: the host's loops over columns, and the
// values that kernels call.
#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "barriers/stiffness/policy_launches.hpp"
#include "core/barrier/scaled_policy.hpp"
#include "core/barrier/stiffness_policy.hpp"

namespace bb {

/// P is a struct of this folder. Without contact_kappa it has one stiffness for all, uniform_kappa(); without
/// element_parts it serves no strain limit.
template <class P>
class ItemPolicy final : public StiffnessPolicy {
 public:
  using Values = P;
  static constexpr bool of_contacts = ServesContacts<P>, of_elements = ServesLimits<P>;

  ItemPolicy(std::string name, const P& values, double multiplier)
      : name_(std::move(name)), scaled_{values, multiplier} {}
  /// With its factor.
  const ScaledPolicy<P>& scaled() const { return scaled_; }

  std::string_view name() const override { return name_; }
  Refresh refresh() const override {
    if constexpr (of_contacts) return scaled_.values.refresh;
    return Refresh::per_iteration;
  }
  bool needs_hessian() const override {
    if constexpr (of_contacts) return scaled_.values.needs_hessian();
    return false;
  }
  bool has_potential() const override {
    if constexpr (of_contacts) return scaled_.values.has_potential();
    return false;
  }
  bool uniform() const override { return !of_contacts; }
  State state() const override {
    if constexpr (of_contacts)
      return {};
    else {
      const double kappa = scaled_.multiplier * scaled_.values.uniform_kappa();
      return {kappa, kappa, 0, false};
    }
  }

  const PolicyLaunches* launches() const override {
    static const PolicyLaunches all = policy_launches<ItemPolicy>();
    return &all;
  }

  void fill(const StiffnessBatch& rows, double* kappa) const override {
    if constexpr (of_contacts) {
      for (std::size_t r = 0; r < rows.n; ++r) {
        kappa[r] = scaled_.contact_kappa(sums(rows, r), rows.d[r], rows.d_hat[r], rows.time);
      }
    } else {
      std::fill(kappa, kappa + rows.n, state().kappa);
    }
  }
  void fill_parts(const StiffnessBatch& rows, KappaParts* parts) const override {
    if constexpr (of_contacts) {
      for (std::size_t r = 0; r < rows.n; ++r) {
        parts[r] = scaled_.contact_parts(sums(rows, r), rows.d_hat[r], rows.time);
      }
    }
  }

 private:
  ContactSums<double> sums(const StiffnessBatch& rows, std::size_t r) const {
    const bool with_hessian = needs_hessian();
    const ColumnMajor<double> hessian{with_hessian ? rows.hessian + 144 * r : nullptr, 12};
    return contact_sums(rows.n_free[r], rows.weight + 4 * r, rows.normal + 3 * r, rows.mass + 4 * r, hessian,
                        with_hessian);
  }

  std::string name_;
  ScaledPolicy<P> scaled_;
};

}  // namespace bb
