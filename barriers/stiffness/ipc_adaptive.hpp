// Stiffness policy `ipc_adaptive`: one kappa for all contacts, chosen at the first iterate that has any and
// doubled between steps while gaps stay near the stop level.
#pragma once

#include <algorithm>
#include <optional>

#include "core/barrier/stiffness_policy.hpp"
#include "core/base/archive/archive.hpp"
#include "core/math/error.hpp"

namespace bb {

struct IpcAdaptive {
  std::optional<double> kappa_min, kappa_max;  // N/m, instead of k and 100 k
  std::optional<double> doubling_gap;          // m, instead of 10 park distances

  template <class List>
  static void describe(List& list) {
    using P = IpcAdaptive;
    list.positive("kappa_min_N_per_m", &P::kappa_min, "N/m",
                  "lower bound of kappa; absent: k = mean contact mass/(c h^2 b''(d_hat/2))");
    list.positive("kappa_max_N_per_m", &P::kappa_max, "N/m", "upper bound of kappa; absent: 100 k");
    list.positive("doubling_gap_m", &P::doubling_gap, "m",
                  "kappa doubles while the gap of a row stays below and shrinks; absent: 10 park distances");
  }
  template <class Refuse>
  void check(Refuse& refuse) const {
    if (kappa_min && kappa_max && *kappa_min > *kappa_max) {
      refuse("kappa_min_N_per_m", *kappa_min, refuse.at_most("kappa_max_N_per_m", *kappa_max));
    }
  }
  class Policy;
};

/// kappa_0 = -(grad B_1 . grad E)/|grad B_1|^2, clamped to [k, 100 k], k = mean contact mass/(c dt^2
/// b''(d_hat/2)). Source: Li et al. 2020 (IPC), supplement on adaptive kappa; differs by: the scale k and
/// the doubling rule.
class IpcAdaptive::Policy final : public StiffnessPolicy {
 public:
  Policy(const IpcAdaptive& values, double multiplier) : values_(values), multiplier_(multiplier) {}
  std::string_view name() const override { return "ipc_adaptive"; }
  Refresh refresh() const override { return Refresh::per_iteration; }
  bool needs_globals() const override { return true; }
  bool uniform() const override { return true; }

  void start(const StiffnessGlobals& globals) override {
    const bool has_scale = globals.time.c > 0 && globals.d2b_half > 0;
    if (!has_scale && !(values_.kappa_min && values_.kappa_max)) {
      throw ConfigError("stiffness_policy", "ipc_adaptive without inertia, or with b''(d_hat/2) not > 0",
                        "an integrator with inertia, or both kappa_min and kappa_max");
    }
    const double k = has_scale ? globals.mean_contact_mass /
                                     (globals.time.c * globals.time.dt * globals.time.dt * globals.d2b_half)
                               : 0.0;
    max_ = values_.kappa_max.value_or(std::max(range * k, values_.kappa_min.value_or(0.0)));
    const double low = std::min(values_.kappa_min.value_or(k), max_);
    const double balance = globals.grad_b_sq > 0 ? -globals.grad_b_dot_grad_e / globals.grad_b_sq : low;
    start_ = kappa_ = std::clamp(balance, low, max_);
    saturated_ = kappa_ >= max_;
  }

  void fill(const StiffnessBatch& rows, double* kappa) const override {
    std::fill(kappa, kappa + rows.n, multiplier_ * kappa_);
  }

  bool adapts() const override { return true; }

  void end_step(std::span<const PairEnd> pairs) override {
    const auto presses = [this](const PairEnd& pair) {
      const double small = values_.doubling_gap.value_or(doubling_parks * pair.park);
      return pair.gap < small && pair.gap_before < small && pair.closing();
    };
    if (!(kappa_ > 0) || saturated_ || std::none_of(pairs.begin(), pairs.end(), presses)) return;
    kappa_ = std::min(2 * kappa_, max_);
    saturated_ = kappa_ >= max_;
    ++doublings_;
  }

  void keep(Archive& archive) override { archive(start_, kappa_, max_, doublings_, saturated_); }

  State state() const override {
    return {multiplier_ * start_, multiplier_ * kappa_, doublings_, saturated_};
  }

 private:
  // A gap below this many stop levels at two step ends, and shrinking, doubles kappa.
  static constexpr double doubling_parks = 10;
  // kappa stays within [k, range k].
  static constexpr double range = 100;
  IpcAdaptive values_;
  double multiplier_;
  double start_ = 0, kappa_ = 0, max_ = 0;
  int doublings_ = 0;
  bool saturated_ = false;
};

}  // namespace bb
