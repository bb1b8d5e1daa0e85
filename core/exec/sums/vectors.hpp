// Operations of a Newton iteration on columns [3 n] that live in an executor.
#pragma once

#include <span>
#include <vector>

#include "core/exec/sums/executor_sum.hpp"
#include "core/exec/sums/vector_kernels.hpp"
#include "core/math/types.hpp"

namespace bb::exec {

/// Three bits a vertex, set where the degree of freedom is prescribed or locked. fixed: [3 n] flags.
std::vector<FixedMask> fixed_bits(std::span<const std::uint8_t> fixed);

/// Of a direction, m: the largest |dx| over free degrees of freedom, over those of them that are within the rounding of
/// their vertex, over the others (core/math/rounding_room.hpp), and the largest length of a vertex's.
struct DirectionSizes {
  double largest, within, beyond, vertex;
};

class VectorTools {
 public:
  /// fixed: [3 n] flags. pins: vertices that are prescribed.
  VectorTools(Executor& executor, std::span<const std::uint8_t> fixed, std::vector<int> pins);

  /// Where prescribed vertices have to be at the end of the step; target: [3 x n], read at pins only.
  void set_targets(const Positions& target);
  /// trial = x + dx, prescribed vertices exactly on target.
  void move_to_targets(const Buffer<double>& x, const Buffer<double>& dx, Buffer<double>& trial);
  /// trial = x + alpha dx.
  void move(const Buffer<double>& x, const Buffer<double>& dx, double alpha, Buffer<double>& trial);
  /// dx of prescribed vertices = target - x.
  void set_pin_motion(const Buffer<double>& x, Buffer<double>& dx);
  // --- in two calls: a launch, and what it found, which is read with the findings of other launches (core/exec/board.hpp)
  void look_at_pins(const Buffer<double>& x);
  /// The first pin (its number) that is not at its target, -1 without one.
  Index first_short_pin() const;
  /// dx += step.
  void take_solution(const Buffer<double>& step, const Buffer<double>& b, const Buffer<double>& g,
                     Buffer<double>& dx);
  /// Over free degrees of freedom: b . step and g . dx.
  TwoSums solution_products() const { return products_.get(); }
  /// body_size: [n] m. epsilon: relative rounding of a coordinate.
  void look_at_direction(const Buffer<double>& dx, const Buffer<double>& x, const Buffer<double>& body_size,
                         double epsilon);
  DirectionSizes direction_sizes() const;
  void look_at_largest(const Buffer<double>& column);
  /// Largest |value| over free degrees of freedom; NaN where one is NaN.
  double free_largest() const { return largest_.largest(); }

  // --- at once
  double free_max(const Buffer<double>& column) {
    look_at_largest(column);
    return free_largest();
  }
  /// Largest |value| over all.
  double max(const PositionsView& column);
  /// Over free degrees of freedom: value() is a . b.
  Compensated free_dot(const Buffer<double>& a, const Buffer<double>& b);
  /// First number of a column that is not finite, -1 without one.
  Index first_not_finite(const Buffer<double>& column);
  /// |g| of every vertex over its free degrees of freedom; g [3 n], force [n], N.
  void force_norms(const Buffer<double>& g, Buffer<double>& force);

  /// [n] as fixed_bits.
  const Buffer<FixedMask>& fixed() const { return fixed_; }
  Index n_vertices() const { return fixed_.size(); }

 private:
  Executor& executor_;
  Buffer<FixedMask> fixed_;
  std::vector<int> pins_;
  Buffer<int> pin_vertex_;
  Buffer<double> pin_target_;
  ExecutorSum sum_;
  ExecutorLeast least_, short_pin_, largest_;
  ExecutorSums<DirectionKeys> sizes_;
  ExecutorSums<TwoSums> products_;
};

}  // namespace bb::exec
