// What an integrator supplies: the weight c of the inertia term, the prediction x_tilde and the velocity
// update. E(x) = 1/(2 c h^2) (x - x_tilde)^T M (x - x_tilde) - f^T (x - x_n) + ...   (docs/theory/incremental-potential.md)
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/math/types.hpp"

namespace bb {

/// States at the ends of the last two steps. `steps` counts accepted steps; x_prev, v_prev need steps >= 1.
/// a is the acceleration at x (m/s^2) of integrators that say needs_acceleration, 0 for the others.
struct History {
  int steps = 0;
  double dt_prev = 0;  // s, length of the step that ended at x; 0: as the next one
  Positions x, v, a;   // [3 x n] m, m/s, m/s^2
  Positions x_prev, v_prev;
  double t = 0;  // s, of x
  /// Other vertices are prescribed from now on: of what lies before x and v the next step reads nothing.
  bool anew = false;
};

struct Prediction {
  double c = 1;       // inertia weight M/(c h^2); 0 means no inertia (quasi-static)
  Positions x_tilde;  // [3 x n] m; holds no force
  double t_end = 0;   // s, at the end of the step: set by what starts the step, not by an integrator
  bool at_start =
      false;  // no step: forces at t_end, where a step of this length begins and what acts in it acts
};

class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual std::string_view name() const = 0;
  /// True when inertia is absent and the force is applied in load steps.
  virtual bool quasi_static() const { return false; }
  /// True when a_0 must be computed from the forces at the start and a kept.
  virtual bool needs_acceleration() const { return false; }
  /// The part of the weight that acts in a step.
  virtual double weight_factor() const { return 1; }
  /// False when steps read x_prev or v_prev: a velocity that is changed at the end of a step is then not all that the next begins with.
  virtual bool one_step() const { return true; }
  /// Whether v at the end of a step is what x moved by in it over its length, or 0, and all that the next step reads besides x.
  bool velocity_of_step() const { return one_step() && !needs_acceleration(); }
  /// Fills `out` without allocating after the first call. dt in s.
  virtual void predict(const History& history, double dt, Prediction& out) const = 0;
  /// Velocity at the end of the step that reached x, and acceleration where needs_acceleration: others leave a as it
  /// is. v, a: [3 x n].
  virtual void finish(const History& history, double dt, const Prediction& used, const Positions& x,
                      Positions& v, Positions& a) const = 0;
};

}  // namespace bb
