// All elements of one kind of a scene, in the memory of an executor: what terms of E launch, on any executor (docs/architecture.md, Element kinds and families).
// The physics is in the element functions of core/energy; a kind is one header of this folder, which kernels read, and one
// file, which fills its columns (family_of.hpp).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/energy/constraint_batch.hpp"
#include "core/energy/families/family_step.hpp"
#include "core/energy/families/pieces.hpp"
#include "core/energy/local_terms.hpp"
#include "core/exec/executor.hpp"
#include "core/math/precision.hpp"

namespace bb {

class Archive;

/// Where a family lives, and in which arithmetic it is computed: a card has Precision::full alone.
struct FamilyPlace {
  exec::Executor& executor;
  Precision precision = Precision::full;
};

/// Results do not depend on the executor, its threads or its order: every element writes its own slots. Pointers are memory of
/// the executor; x: [3 n_vertices] m.
class ElementFamily {
 public:
  ElementFamily() = default;
  ElementFamily(const ElementFamily&) = delete;
  ElementFamily& operator=(const ElementFamily&) = delete;
  virtual ~ElementFamily() = default;

  /// Vertices per element, w.
  virtual int width() const = 0;
  /// [w n] vertex indices, element-major: of the scene, which outlives the family.
  virtual std::span<const int> vertices() const = 0;
  exec::Index size() const { return static_cast<exec::Index>(vertices().size()) / width(); }

  /// Whether the elements are all vertices, in their order.
  virtual bool on_vertices() const { return false; }
  /// False where energies are linear.
  virtual bool has_hessian() const { return true; }

  /// Energies [n], J. Cost: O(n), allocates nothing.
  virtual void values(const double* x, double* energy) = 0;
  /// Whether changes() says how energies change; else they are compared.
  virtual bool has_changes() const { return false; }
  /// From x0 to x1 in closed form, J: the numbers of element e at stride e. Rounding noise is some multiple of eps times magnitude.
  virtual void changes(const double* /*x0*/, const double* /*x1*/, double* /*change*/, double* /*magnitude*/,
                       exec::Index /*stride*/) {}

  // --- pieces as columns, which threads of a card read side by side. Errors: std::logic_error of every vertex, whose loads an executor
  // adds in a launch of their own (core/terms/executor/loads.cpp).
  /// energy [n]; grad [3 w, piece.n], N.
  virtual void gradients(Piece piece, const double* x, double* energy, double* grad) = 0;
  /// hess [lower numbers, piece.n], N/m.
  virtual void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) = 0;

  // --- element by element, in the host's memory alone
  /// Energies, gradients and Hessians, projected element by element. `out` is resized once and never allocated again.
  virtual void derivatives(const double* x, Projection projection, LocalTerms& out) = 0;
  /// Elements whose energy has a cusp at x, ascending: it has no derivative there and falls whichever way the element leaves it, so
  /// that x is no minimum, though the gradient may be 0 and the Hessian positive.
  virtual std::vector<std::size_t> cusps(const double* x) const = 0;
  /// Constraints whose energy is this one; null: it has no such form.
  virtual const ConstraintBatch* constraints() const { return nullptr; }

  // --- what is given as a function of time, and rest shapes that move. Within a step they stay, so that E is one function of x.
  /// A step begins: what the one before has left holds.
  virtual void begin_step(const FamilyStep& step) { change_step(step); }
  /// The same step with another prediction, length and end. What is given as a function of time is that of the end. Before the first step
  /// rest shapes are those of the start, 0.
  virtual void change_step(const FamilyStep&) {}
  /// Whether elements remember.
  virtual bool flows() const { return false; }
  /// A step of dt (s) has ended at x: what the next one begins with. Whoever looks at the step that is over sees its own E.
  virtual void end_step(const double* /*x*/, double /*dt*/) {}
  /// How many elements are broken once a step is over that ends at x; nothing where none breaks; only of families that flow().
  virtual std::optional<std::size_t> broken(const double* /*x*/) { return std::nullopt; }
  /// What elements remember, where they do.
  virtual void keep(Archive&) {}
};

}  // namespace bb
