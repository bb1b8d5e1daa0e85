// Newton steps that crawl, and how long their direction may be.
#pragma once

#include <cmath>

#include "core/newton/report.hpp"

namespace bb {

/// A regularised Hessian may be stiffer than E along dx, which is flat there or bends down, as on the
/// side of a saddle. A whole step is then as short as the matrix is stiff: E falls along it by more than 3/4 of what its slope
/// alone says, where the model promises half, and hundreds of such steps follow each other. After some of them in a row dx is
/// tried twice as long, then twice as long again, as long as E goes on to fall so; the valley bends, and a step that has met
/// one of them is quicker to see the next.
class CrawlWatch {
 public:
  /// A step begins.
  void begin_step() { reset(), needed_ = at_first; }
  /// E is another one.
  void reset() { in_a_row_ = 0, length_ = 1; }
  /// After a step of `taken` times dx; 0 for a step along another direction, or none, or one whose change of E is noise.
  void took(double taken, const IterationReport& report) {
    const bool crawls = report.solve.t > 0 && taken >= 1 && report.energy_change_J.finite() &&
                        report.energy_change_J.value < -1.5 * taken * report.decrement_J;
    in_a_row_ = in_a_row(in_a_row_, crawls);
    if (taken > 1) needed_ = again;
    length_ = in_a_row_ < needed_ ? 1 : std::exp2(std::floor(std::log2(taken)) + 1);
  }
  /// What dx is to be multiplied by: 1, or a power of two above.
  double length() const { return length_; }

 private:
  static constexpr int at_first = 20, again = 2;
  int in_a_row_ = 0, needed_ = at_first;
  double length_ = 1;
};

}  // namespace bb
