// A policy whose kappa is a function of one item, from its struct of values: the host's loops over columns, and the
// values that kernels call.
#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "barriers/stiffness/scaled_policy.hpp"
#include "core/barrier/stiffness_policy.hpp"
#include "core/math/error.hpp"

namespace bb {

/// P is a struct of this folder. Without contact_kappa it has one stiffness for all, uniform_kappa(); without
/// element_parts it serves no strain limit.
template <class P>
class ItemPolicy final : public StiffnessPolicy {
 public:
  static constexpr bool of_contacts = requires(const P& p, ContactSums<double> s) {
    p.contact_kappa(s, 1.0, 1.0, StiffnessTime{});
  };
  static constexpr bool of_elements = requires(const P& p, ElementSums<double> s) {
    p.element_parts(s, 1.0, StiffnessTime{});
  };

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
  void fill_elements(const ElementStiffnessBatch& of, double* kappa) const override {
    if constexpr (of_elements) {
      for (std::size_t e = 0; e < of.n; ++e) {
        kappa[e] = scaled_.element_kappa(of.sums[e], of.gap[e], of.width[e], of.time);
      }
    }
  }
  void fill_element_parts(const ElementStiffnessBatch& of, KappaParts* parts) const override {
    if constexpr (of_elements) {
      for (std::size_t e = 0; e < of.n; ++e) {
        parts[e] = scaled_.element_parts(of.sums[e], of.width[e], of.time);
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

/// Policies that have kernels, as policy_list.hpp names them.
template <class... P>
struct PolicyStructs {
  /// call(values) with the ScaledPolicy of a policy that is one of them; false where it is none.
  template <class Call>
  static bool with(const StiffnessPolicy& policy, const Call& call) {
    return (with_struct<P>(policy, call) || ...);
  }
  /// Errors: ConfigError at `where` for a policy that is none of them: one of a plugin.
  static void require(const StiffnessPolicy& policy, const std::string& where) {
    if (with(policy, [](const auto&) {})) return;
    throw ConfigError(where, std::string(policy.name()),
                      "a policy with a device form; this one runs with device cpu only");
  }

 private:
  template <class Q, class Call>
  static bool with_struct(const StiffnessPolicy& policy, const Call& call) {
    const auto* of = dynamic_cast<const ItemPolicy<Q>*>(&policy);
    if (of) call(of->scaled());
    return of != nullptr;
  }
};

}  // namespace bb
