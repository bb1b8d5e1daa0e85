// All elements of one energy of a scene, as Newton calls them. The physics is in the element headers; the
// loops are in element_loop.hpp.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "core/energy/constraint_batch.hpp"
#include "core/math/projection.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Local terms of n elements of w vertices: what the assembly scatters.
struct LocalTerms {
  std::vector<double> energy;  // [n] J
  std::vector<double> grad;    // [3w n] N, vertex-major
  std::vector<double> hess;    // [9w(w + 1)/2 n] N/m, lower blocks (lower_blocks.hpp)

  /// Makes room for n elements of w vertices; allocates only when it must grow.
  void resize(std::size_t n, int width);
};

/// Results do not depend on the number of threads: every element writes its own slots.
class EnergyBatch {
 public:
  EnergyBatch() = default;
  EnergyBatch(const EnergyBatch&) = delete;
  EnergyBatch& operator=(const EnergyBatch&) = delete;
  virtual ~EnergyBatch() = default;

  virtual std::string_view name() const = 0;
  /// Vertices per element, w.
  virtual int width() const = 0;
  /// [w n] vertex indices, element-major.
  virtual std::span<const int> vertices() const = 0;
  /// Energies [n], J. Cost: O(n), allocates nothing.
  virtual void values(const PositionsView& x, double* energy) const = 0;
  /// Energies, gradients and Hessians, projected element by element. Cost: O(n); out is resized once and never allocated again.
  virtual void derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const = 0;

  /// Elements whose energy has a cusp at x, ascending: it has no derivative there and falls whichever way the element leaves it, so
  /// that x is no minimum, though the gradient may be 0 and the Hessian positive.
  virtual std::vector<std::size_t> cusps(const PositionsView&) const { return {}; }

  /// Constraints whose energy is this one; null: it has no such form.
  virtual const ConstraintBatch* constraints() const { return nullptr; }

  /// What is given as a function of time is that of t (s) from now on. Before the first call it is that of the start, 0.
  virtual void set_time(double /*t*/) {}

  // --- rest shapes that move from step to step. Within a step they stay, so that E is one function of x.
  /// What the batch remembers, always as many numbers; empty: nothing.
  virtual std::span<const double> memory() const { return {}; }
  /// Requires as many numbers as memory() has.
  virtual void set_memory(std::span<const double>) {}
  /// Turns `memory`, that of the batch, into the one with which the step after one of dt (s) that ended at x begins.
  virtual void flow(const PositionsView& /*x*/, double /*dt*/, std::span<double> /*memory*/) const {}

  std::size_t size() const { return vertices().size() / static_cast<std::size_t>(width()); }
};

}  // namespace bb
