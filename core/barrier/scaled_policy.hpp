// The values of a policy with the factor on its kappa and its gap floor: what host loops and kernels call for one item.
#pragma once

#include "core/barrier/stiffness_policy.hpp"
#include "core/math/host_device.hpp"

namespace bb {

/// A policy that computes the kappa of contacts one by one, and one that serves strain limits.
template <class P>
concept ServesContacts = requires(const P& p, const ContactSums<double>& sums) {
  p.contact_kappa(sums, 1.0, 1.0, StiffnessTime{});
};
template <class P>
concept ServesLimits = requires(const P& p, const ElementSums<double>& sums) {
  p.element_parts(sums, 1.0, StiffnessTime{});
};

template <class P>
struct ScaledPolicy {
  P values;
  double multiplier = 1;  // the config's own factor times s of the matching rule

  /// N/m, at the gap d (m) or the policy's smallest.
  BB_HD double contact_kappa(const ContactSums<double>& sums, double d, double d_hat,
                             const StiffnessTime& time) const {
    return multiplier * values.contact_kappa(sums, asked(d, d_hat), d_hat, time);
  }
  BB_HD KappaParts contact_parts(const ContactSums<double>& sums, double d_hat,
                                 const StiffnessTime& time) const {
    return times_multiplier(values.contact_parts(sums, d_hat, time));
  }
  /// J, at the pseudo-gap y or the policy's smallest.
  BB_HD double element_kappa(const ElementSums<double>& sums, double y, double width,
                             const StiffnessTime& time) const {
    return multiplier * values.element_parts(sums, width, time).at(asked(y, width));
  }
  BB_HD KappaParts element_parts(const ElementSums<double>& sums, double width,
                                 const StiffnessTime& time) const {
    return times_multiplier(values.element_parts(sums, width, time));
  }

 private:
  BB_HD double asked(double gap, double width) const {
    if constexpr (requires { values.gap_floor; }) return floored_gap(gap, values.gap_floor, width);
    return gap;
  }
  BB_HD KappaParts times_multiplier(const KappaParts& one) const {
    return {multiplier * one.fixed, multiplier * one.per_gap_sq};
  }
};

}  // namespace bb
