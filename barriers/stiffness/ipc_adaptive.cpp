// Stiffness policy `ipc_adaptive`: one kappa for all contacts, chosen at the first iterate that has any and
// doubled between steps while gaps stay near the stop level.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "barriers/stiffness/registry.hpp"
#include "core/archive/archive.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

// A gap below this many stop levels at two step ends, and shrinking, doubles kappa.
constexpr double doubling_parks = 10;
// kappa stays within [k, range k].
constexpr double range = 100;

/// kappa_0 = -(grad B_1 . grad E)/|grad B_1|^2, clamped to [k, 100 k], k = mean contact mass/(c dt^2
/// b''(d_hat/2)). Source: Li et al. 2020 (IPC), supplement on adaptive kappa; differs by: the scale k and
/// the doubling rule.
class IpcAdaptive final : public StiffnessPolicy {
 public:
  explicit IpcAdaptive(const StiffnessPolicyConfig& config)
      : kappa_min_(optional_number(config.parameters, "kappa_min_N_per_m")),
        kappa_max_(optional_number(config.parameters, "kappa_max_N_per_m")),
        doubling_gap_(optional_number(config.parameters, "doubling_gap_m")),
        multiplier_(config.multiplier) {}
  std::string_view name() const override { return "ipc_adaptive"; }
  std::optional<StiffnessRule> rule() const override { return StiffnessRule{}; }
  Refresh refresh() const override { return Refresh::per_iteration; }
  bool needs_globals() const override { return true; }

  void start(const StiffnessGlobals& globals) override {
    const bool has_scale = globals.c > 0 && globals.d2b_half > 0;
    if (!has_scale && !(kappa_min_ && kappa_max_)) {
      throw ConfigError("stiffness_policy", "ipc_adaptive without inertia, or with b''(d_hat/2) not > 0",
                        "an integrator with inertia, or both kappa_min and kappa_max");
    }
    const double k =
        has_scale ? globals.mean_contact_mass / (globals.c * globals.dt * globals.dt * globals.d2b_half)
                  : 0.0;
    max_ = kappa_max_.value_or(std::max(range * k, kappa_min_.value_or(0.0)));
    const double low = std::min(kappa_min_.value_or(k), max_);
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
      const double small = doubling_gap_.value_or(doubling_parks * pair.park);
      return pair.gap < small && pair.gap_before < small && pair.gap < pair.gap_before;
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
  std::optional<double> kappa_min_, kappa_max_;  // N/m, instead of k and 100 k
  std::optional<double> doubling_gap_;           // m, instead of 10 park distances
  double multiplier_;
  double start_ = 0, kappa_ = 0, max_ = 0;
  int doublings_ = 0;
  bool saturated_ = false;
};

}  // namespace

StiffnessPolicyEntry policy_ipc_adaptive() {
  StiffnessPolicyEntry entry;
  entry.parameters = {
      {"kappa_min_N_per_m", positive("N/m"), no_default,
       "lower bound of kappa; absent: k = mean contact mass/(c h^2 b''(d_hat/2))"},
      {"kappa_max_N_per_m", positive("N/m"), no_default, "upper bound of kappa; absent: 100 k"},
      {"doubling_gap_m", positive("m"), no_default,
       "kappa doubles while the gap of a row stays below and shrinks; absent: 10 park distances"},
  };
  entry.make = [](const StiffnessPolicyConfig& config) -> std::unique_ptr<StiffnessPolicy> {
    const std::optional<double> low = optional_number(config.parameters, "kappa_min_N_per_m"),
                                high = optional_number(config.parameters, "kappa_max_N_per_m");
    if (low && high && *low > *high) {
      throw ConfigError("stiffness_policy/kappa_min_N_per_m", fmt::format("{}", *low),
                        fmt::format("at most kappa_max_N_per_m = {}", *high));
    }
    return std::make_unique<IpcAdaptive>(config);
  };
  return entry;
}

}  // namespace bb
