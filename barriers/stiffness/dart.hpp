// Stiffness policy `dart`: one kappa for all contacts, from the heaviest free vertex and the length of the step.
#pragma once

#include <algorithm>
#include <optional>

#include "core/barrier/stiffness_policy.hpp"
#include "core/base/archive/archive.hpp"

namespace bb {

enum class DartBalance { published, inertia };

struct Dart {
  DartBalance balance = DartBalance::published;
  std::optional<double> kappa_min, kappa_max;  // N/m, instead of 25 and 1e6

  template <class List>
  static void describe(List& list) {
    list.choice("balance", &Dart::balance, {"published", "inertia"},
                "kappa before it is clamped: m/(c h^2) d_hat^2 times 1 1/m^2, as DART computes it, or m/(c "
                "h^2), m of "
                "the heaviest free vertex");
    list.positive("kappa_min_N_per_m", &Dart::kappa_min, "N/m", "lower bound of kappa; absent: 25");
    list.positive("kappa_max_N_per_m", &Dart::kappa_max, "N/m", "upper bound of kappa; absent: 1e6");
  }
  double least() const { return kappa_min.value_or(25); }
  double most() const { return kappa_max.value_or(1e6); }
  template <class Refuse>
  void check(Refuse& refuse) const {
    if (least() > most()) refuse("kappa_min_N_per_m", least(), refuse.at_most("kappa_max_N_per_m", most()));
  }
  /// N/m. mass: kg, of the heaviest free vertex. d_hat: m, the smallest of the scene. Without inertia the lower bound.
  double kappa(double mass, double d_hat, const StiffnessTime& time) const {
    const double inertia = time.inertia(mass);
    const double balanced = balance == DartBalance::published ? inertia * d_hat * d_hat : inertia;
    return std::clamp(balanced, least(), most());
  }
  class Policy;
};

/// kappa = clamp(max m/h^2 d_hat^2, 25, 1e6) anew in every step. Source: pull request 2805 of dartsim/dart, 2026-05-30,
/// which derives it from a curvature kappa/d_hat^2 of the barrier. Its barrier is -kappa (d - d_hat)^2 ln(d/d_hat), the
/// shape `log` on `gap`, whose curvature is kappa times a number: so kappa is in N/m and the product with d_hat^2, kept as
/// it is computed there, is not invariant under a change of units. `inertia` is what the derivation gives for that
/// barrier. Differs by: one kappa for the scene, where DART has one a body, and for every contact, where DART keeps
/// 25 between bodies that deform; c h^2 of any integrator, where DART has implicit Euler.
class Dart::Policy final : public StiffnessPolicy {
 public:
  Policy(const Dart& values, double multiplier) : values_(values), multiplier_(multiplier) {}
  std::string_view name() const override { return "dart"; }
  Refresh refresh() const override { return Refresh::per_step; }
  bool needs_globals() const override { return true; }
  bool uniform() const override { return true; }

  void start(const StiffnessGlobals& globals) override {
    mass_ = globals.max_free_mass;
    d_hat_ = globals.d_hat;
    kappa_ = start_ = values_.kappa(mass_, d_hat_, globals.time);
  }
  void set_time(const StiffnessTime& time) override {
    if (start_ > 0) kappa_ = values_.kappa(mass_, d_hat_, time);
  }
  void fill(const StiffnessBatch& rows, double* kappa) const override {
    std::fill(kappa, kappa + rows.n, multiplier_ * kappa_);
  }
  void keep(Archive& archive) override { archive(start_, kappa_, mass_, d_hat_); }
  State state() const override {
    return {multiplier_ * start_, multiplier_ * kappa_, 0, kappa_ >= values_.most()};
  }

 private:
  Dart values_;
  double multiplier_;
  double start_ = 0, kappa_ = 0;  // N/m, 0 before the first contact
  double mass_ = 0, d_hat_ = 0;
};

}  // namespace bb
