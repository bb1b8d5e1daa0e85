// When the matrix has the secant of terms that have one (Term::take_secant), and how much of it.
#pragma once

#include "core/newton/step_system.hpp"

namespace bb {

/// Friction that slides has no stiffness along its slide, so that a Newton direction turns slides round, far beyond where they
/// would stick: the line search cuts it to a small part, one contact sticks, and tens of such steps follow each other. After a
/// step that was cut the next matrix has the whole secant, whose quadratic model lies nowhere below the energy of friction; after
/// whole steps it has a quarter, a sixteenth and none, since the exact matrix is what converges fast.
class SecantRule {
 public:
  /// A step begins: its terms have none.
  void begin_step() { share_ = 0; }
  /// From the next iteration on there is none.
  void reset(StepSystem& system) { set(0, system); }
  /// After an iteration. shortened: E rose along dx, or a trial was infeasible, where the bound would have let it go. Returns
  /// whether the matrix of the next iteration, if one follows, has more of the secant than that of this one.
  bool took(bool shortened, StepSystem& system) {
    const double before = share_;
    if (shortened)
      set(1, system);
    else if (share_ > 0)
      set(share_ < least ? 0 : share_ / 4, system);
    return share_ > before;
  }
  /// Of the secant in the matrix of the next iteration, in [0, 1].
  double share() const { return share_; }

 private:
  static constexpr double least = 0.2;
  void set(double share, StepSystem& system) { share_ = system.take_secant(share) ? share : 0; }
  double share_ = 0;
};

}  // namespace bb
