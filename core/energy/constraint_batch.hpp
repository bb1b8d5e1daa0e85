// Constraints that a term offers beside its energy (docs/theory/step-solvers.md, Constraints): what solvers of positions (XPBD) and of
// multipliers (augmented Lagrangians) read in the place of gradients and Hessians.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "core/math/types.hpp"

namespace bb {

/// C = 0, or C >= 0.
enum class ConstraintKind { equality, inequality };

/// All constraints of one kind that a term offers.
class ConstraintBatch {
 public:
  ConstraintBatch() = default;
  ConstraintBatch(const ConstraintBatch&) = delete;
  ConstraintBatch& operator=(const ConstraintBatch&) = delete;
  virtual ~ConstraintBatch() = default;

  virtual std::string_view name() const = 0;
  virtual ConstraintKind kind() const = 0;
  /// Unit of C.
  virtual std::string_view unit() const = 0;
  /// Vertices a constraint, w.
  virtual int width() const = 0;
  /// [w n] vertex indices, constraint by constraint; -1: none.
  virtual std::span<const int> vertices() const = 0;
  /// [n] inverse stiffness, unit of C squared over J: the energy of an equality is C^2/(2 compliance), that of an inequality
  /// the same where C < 0. 0: rigid. Infinite: no constraint.
  virtual std::span<const double> compliance() const = 0;
  /// C of constraint e at x [3 x n_vertices] m. gradient [3 w]: dC/dx of its vertices, unit of C over m; 0 where there is none.
  virtual double value(std::size_t e, const PositionsView& x, double* gradient) const = 0;
  /// Of constraints that come and go: which one e was when they were found before; -1: it is new.
  virtual std::ptrdiff_t before(std::size_t e) const { return static_cast<std::ptrdiff_t>(e); }

  std::size_t size() const { return vertices().size() / static_cast<std::size_t>(width()); }
};

}  // namespace bb
