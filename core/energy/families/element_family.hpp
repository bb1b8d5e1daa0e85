// All elements of one kind of a scene, in the memory of an executor: what terms of E launch, on any executor (docs/design.md, Families).
// The physics is in the element functions of core/energy; a kind is one header of this folder, which kernels read, and one
// file, which fills its columns.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/energy/constraint_batch.hpp"
#include "core/energy/families/element_columns.hpp"
#include "core/energy/families/element_kernels.hpp"
#include "core/energy/families/family_step.hpp"
#include "core/energy/local_terms.hpp"
#include "core/exec/executor.hpp"

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
  // adds in a launch of their own (core/resident/elements/loads.cpp).
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
  /// What elements remember, where they do.
  virtual void keep(Archive&) {}
};

/// A family of one kind (element_kernels.hpp). Base: what it is besides.
template <class Elements, class Base = ElementFamily>
class FamilyOf : public Base {
 public:
  int width() const override { return Elements::width; }
  std::span<const int> vertices() const override { return vertices_; }
  bool on_vertices() const override { return IsEveryVertex<Elements>; }
  bool has_hessian() const override { return !IsLinear<Elements>; }
  void values(const double* x, double* energy) override {
    with_scalar([&]<class T>() {
      place_.executor.each(elements_.n, ElementValues<Elements, T>{elements_, x, energy});
    });
  }
  bool has_changes() const override { return HasChange<Elements>; }
  void changes(const double* x0, const double* x1, double* change, double* magnitude,
               exec::Index stride) override {
    if constexpr (HasChange<Elements>) {
      place_.executor.each(elements_.n,
                           ElementChanges<Elements>{elements_, x0, x1, change, magnitude, stride});
    }
  }
  void gradients(Piece piece, const double* x, double* energy, double* grad) override {
    if constexpr (IsEveryVertex<Elements>) {
      throw std::logic_error("pieces of the loads of every vertex");
    } else {
      place_.executor.each(piece.n, ElementGradients<Elements>{elements_, piece, x, energy, grad});
    }
  }
  void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) override {
    if constexpr (IsEveryVertex<Elements>) {
      throw std::logic_error("pieces of the loads of every vertex");
    } else {
      place_.executor.each(piece.n, ElementHessians<Elements>{elements_, piece, request, x, hess});
    }
  }
  void derivatives(const double* x, Projection projection, LocalTerms& out) override {
    out.resize(static_cast<std::size_t>(elements_.n), Elements::width, has_hessian());
    const auto fill = [&]<class T>(PassParts parts) {
      parts.hessians = parts.hessians && has_hessian();
      place_.executor.each(elements_.n,
                           ElementLocalTerms<Elements, T>{elements_, projection, parts, x, out.energy.data(),
                                                          out.grad.data(), out.hess.data()});
    };
    if constexpr (HasScalars<Elements>) {
      for_each_pass(place_.precision, fill);
    } else {
      fill.template operator()<double>(PassParts{true, true});
    }
  }
  std::vector<std::size_t> cusps(const double* x) const override {
    std::vector<std::size_t> out;
    if constexpr (HasCusps<Elements>) {
      with_scalar([&]<class T>() {
        for (exec::Index e = 0; e < elements_.n; ++e) {
          if (elements_.template is_cusp<T>(x, e)) out.push_back(static_cast<std::size_t>(e));
        }
      });
    }
    return out;
  }

 protected:
  /// name: of the buffer of vertices. of_base: arguments of Base.
  template <std::size_t W, class... OfBase>
  FamilyOf(const FamilyPlace& place, const std::string& name, std::span<const std::array<int, W>> elements,
           OfBase&... of_base)
      : Base(of_base...), place_(place), vertex_(place.executor, name) {
    static_assert(W == Elements::width);
    if (!elements.empty()) vertices_ = {elements.front().data(), W * elements.size()};
    upload_vertices();
  }
  /// Vertices that no column of the scene has.
  FamilyOf(const FamilyPlace& place, const std::string& name, std::vector<int> vertices)
      : place_(place),
        own_vertices_(std::move(vertices)),
        vertices_(own_vertices_),
        vertex_(place.executor, name) {
    upload_vertices();
  }

  FamilyPlace place_;
  Elements elements_{};

 private:
  void upload_vertices() {
    vertex_.upload(to_columns(vertices_, Elements::width));
    elements_.of = vertex_.data();
    elements_.n = this->size();
  }
  template <class F>
  void with_scalar(const F& f) const {
    if constexpr (HasScalars<Elements>) {
      with_value_scalar(place_.precision, f);
    } else {
      f.template operator()<double>();
    }
  }

  std::vector<int> own_vertices_;
  std::span<const int> vertices_;
  exec::Buffer<int> vertex_;
};

}  // namespace bb
