// Where a run is within a nominal step dt: it is one step, until an attempt at it fails or shorter ones are chosen; then it
// goes on in parts of half the length, and halves again. All numbers are exact, so that the run is back on its grid at the end.
#pragma once

#include <cmath>

namespace bb {

class StepParts {
 public:
  /// most: halvings of a nominal step, 0 to 30.
  explicit StepParts(int most) : most_(most) {}

  /// Length of the next part, s.
  double length(double dt) const { return std::ldexp(dt, -halvings_); }
  /// Where the next part ends, in nominal steps from the start of this one; 1 at the end.
  double end() const { return std::ldexp(static_cast<double>(done_ + part()), -most_); }
  bool ends_here() const { return done_ + part() == whole(); }
  bool can_halve() const { return halvings_ < most_; }
  void halve() { ++halvings_; }
  int halvings() const { return halvings_; }
  /// The next part is dt / 2^halvings long, or the longest above that begins here on the grid of its length.
  void choose(int halvings) {
    halvings_ = halvings;
    while (done_ % part() != 0) ++halvings_;
  }
  /// The part is over. A part that was not reached to its end leaves the grid: a nominal step begins.
  void next(bool reached) {
    done_ += part();
    if (!reached || done_ == whole()) done_ = 0, halvings_ = 0;
  }
  bool at_start() const { return done_ == 0; }
  template <class Archive>
  void keep(Archive& archive) {
    archive(halvings_, done_);
  }

 private:
  int whole() const { return 1 << most_; }
  int part() const { return 1 << (most_ - halvings_); }

  int most_, halvings_ = 0;
  int done_ = 0;  // in units of dt / 2^most
};

}  // namespace bb
