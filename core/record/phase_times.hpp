// Where the time of a step goes: named phases, and a scoped timer that adds to one of them.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <string_view>

namespace bb {

/// Phases do not nest: a scope that opens another phase inside itself counts that time twice.
enum class Phase {
  prediction,      // x_tilde, pins, start of a step
  elastic,         // inertia, membrane, springs, hinges: values, gradients, Hessians
  strain_limit,    // S: values, gradients, Hessians
  broad_phase,     // candidate pairs
  contact_rows,    // closest points, merging, shape
  stiffness,       // kappa: policy and memory
  contact_terms,   // local gradients and Hessians of B
  assembly,        // gathers into gradient and block matrix, restriction
  linear_analyze,  // symbolic
  linear_factor,   // numeric factorisation or preconditioner
  linear_solve,    // triangular solves or PCG
  step_bound,      // ACCD
  strain_bound,    // bisection of the strain limit
  line_search,     // trial energies
  condition,       // diagnose pass only
  audit,           // audit pass only
  output,          // record, trace, frames
  count
};
inline constexpr std::size_t kPhases = static_cast<std::size_t>(Phase::count);

inline constexpr std::array<std::string_view, kPhases> kPhaseNames = {
    "prediction",    "elastic",     "strain_limit",   "broad_phase",   "contact_rows", "stiffness",
    "contact_terms", "assembly",    "linear_analyze", "linear_factor", "linear_solve", "step_bound",
    "strain_bound",  "line_search", "condition",      "audit",         "output"};

/// Seconds per phase.
struct PhaseTimes {
  std::array<double, kPhases> s{};

  double& operator[](Phase p) { return s[static_cast<std::size_t>(p)]; }
  double operator[](Phase p) const { return s[static_cast<std::size_t>(p)]; }
  PhaseTimes& operator+=(const PhaseTimes& other) {
    for (std::size_t i = 0; i < kPhases; ++i) s[i] += other.s[i];
    return *this;
  }
  /// Everything but diagnosis, audit and output: what may be reported as time.
  double solve_s() const {
    double sum = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(Phase::condition); ++i) sum += s[i];
    return sum;
  }
};

/// Seconds on the monotonic clock; only differences mean anything. About 25 ns.
inline double now_s() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// Adds the life time of the scope to one phase.
class ScopedPhase {
 public:
  ScopedPhase(PhaseTimes& times, Phase phase) : slot_(times[phase]), start_(now_s()) {}
  ~ScopedPhase() { slot_ += now_s() - start_; }
  ScopedPhase(const ScopedPhase&) = delete;
  ScopedPhase& operator=(const ScopedPhase&) = delete;

 private:
  double& slot_;
  double start_;
};

}  // namespace bb
