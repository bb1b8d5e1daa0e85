// Where the time of a step goes: named phases, and a clock that charges exactly one of them at any moment, so
// that no moment is in none of them or in two.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <string_view>
#include <utility>

namespace bb {

/// Every phase with what belongs to it.
#define BB_PHASES(PHASE)                                                                                   \
  PHASE(prediction, "x_tilde, forces and poses of pins at the start of a step, velocities at its end")     \
  PHASE(elastic, "membranes, springs, hinges: gradients and Hessians")                                     \
  PHASE(strain_limit, "S at an iterate: its stiffness, gradients, Hessians, loads")                        \
  PHASE(broad_phase, "candidate pairs")                                                                    \
  PHASE(contact_rows, "closest points, rows")                                                              \
  PHASE(stiffness, "kappa: policy and memory")                                                             \
  PHASE(contact_terms, "shape, local gradients and Hessians of B")                                         \
  PHASE(assembly, "gathers into gradient and block matrix, inertia, prescribed motion, restriction")       \
  PHASE(linear_analyze, "symbolic analysis")                                                               \
  PHASE(linear_factor, "numeric factorisation or preconditioner")                                          \
  PHASE(linear_solve, "triangular solves or PCG, residuals")                                               \
  PHASE(step_bound, "ACCD")                                                                                \
  PHASE(strain_bound, "bisection of the strain limit")                                                     \
  PHASE(line_search, "energies of trial states")                                                           \
  PHASE(end_check, "whether the end of a step is a minimum, and the way out of a saddle")                  \
  PHASE(step_control, "the step solver itself: measures of iterate, direction and end, decisions, copies") \
  PHASE(output, "observers: record, trace, frames; of an observed run condition estimates and audit too")

enum class Phase {
#define BB_PHASE(name, doc) name,
  BB_PHASES(BB_PHASE)
#undef BB_PHASE
      count
};
inline constexpr std::size_t kPhases = static_cast<std::size_t>(Phase::count);

#define BB_PHASE(name, doc) #name,
inline constexpr std::array<std::string_view, kPhases> kPhaseNames = {BB_PHASES(BB_PHASE)};
#undef BB_PHASE
#define BB_PHASE(name, doc) doc,
inline constexpr std::array<std::string_view, kPhases> kPhaseDocs = {BB_PHASES(BB_PHASE)};
#undef BB_PHASE

/// Seconds per phase.
struct PhaseTimes {
  std::array<double, kPhases> s{};

  double& operator[](Phase p) { return s[static_cast<std::size_t>(p)]; }
  double operator[](Phase p) const { return s[static_cast<std::size_t>(p)]; }
  PhaseTimes& operator+=(const PhaseTimes& other) {
    for (std::size_t i = 0; i < kPhases; ++i) s[i] += other.s[i];
    return *this;
  }
  PhaseTimes& operator-=(const PhaseTimes& other) {
    for (std::size_t i = 0; i < kPhases; ++i) s[i] -= other.s[i];
    return *this;
  }
  double total_s() const {
    double sum = 0;
    for (const double seconds : s) sum += seconds;
    return sum;
  }
  /// Everything but output: what may be reported as time of the method.
  double solve_s() const { return total_s() - (*this)[Phase::output]; }
};

/// Seconds on the monotonic clock; only differences mean anything. About 25 ns.
inline double now_s() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// Charges every moment to one phase. Not thread-safe: one clock a simulation. Cost of a call:
/// that of now_s().
class PhaseClock {
 public:
  /// From now on `wait` is called before each moment that ends a phase, so that what the phase started is over by then;
  /// it does not throw. For profiles of an executor whose launches return at once: what waits costs time itself.
  void wait_at_ends(std::function<void()> wait) { wait_ = std::move(wait); }
  /// Sets all phases to zero and charges `phase` from now on.
  void restart(Phase phase) {
    times_ = lap_start_ = {};
    phase_ = phase;
    since_ = now_s();
  }
  /// Charges `next` from now on. Returns the phase that was charged until now.
  Phase change(Phase next) {
    charge();
    return std::exchange(phase_, next);
  }
  /// Gives `seconds` that `from` was charged with to `to`: for a callee that measures its own parts.
  void move(Phase from, Phase to, double seconds) {
    charge();
    times_[from] -= seconds;
    times_[to] += seconds;
  }
  /// Seconds of every phase since restart(), up to now.
  const PhaseTimes& read() {
    charge();
    return times_;
  }
  /// The same since the last lap() or restart().
  PhaseTimes lap() {
    PhaseTimes out = read();
    out -= std::exchange(lap_start_, times_);
    return out;
  }

 private:
  void charge() {
    if (wait_) wait_();
    const double now = now_s();
    times_[phase_] += now - since_;
    since_ = now;
  }

  PhaseTimes times_, lap_start_;
  Phase phase_ = Phase::step_control;
  double since_ = now_s();
  std::function<void()> wait_;
};

/// Charges everything until the end of the scope to one phase, whatever scopes inside it say.
class WholePhase {
 public:
  WholePhase(PhaseClock& clock, Phase phase) : clock_(clock), phase_(phase), before_(clock.read()) {}
  ~WholePhase() {
    PhaseTimes spent = clock_.read();
    spent -= before_;
    for (std::size_t i = 0; i < kPhases; ++i) clock_.move(static_cast<Phase>(i), phase_, spent.s[i]);
  }
  WholePhase(const WholePhase&) = delete;
  WholePhase& operator=(const WholePhase&) = delete;

 private:
  PhaseClock& clock_;
  Phase phase_;
  PhaseTimes before_;
};

/// Charges a phase until the end of the scope, then again the one that was charged before. Scopes may nest:
/// the inner one's time is not the outer one's.
class ScopedPhase {
 public:
  ScopedPhase(PhaseClock& clock, Phase phase) : clock_(clock), before_(clock.change(phase)) {}
  ~ScopedPhase() { clock_.change(before_); }
  ScopedPhase(const ScopedPhase&) = delete;
  ScopedPhase& operator=(const ScopedPhase&) = delete;

 private:
  PhaseClock& clock_;
  Phase before_;
};

}  // namespace bb
