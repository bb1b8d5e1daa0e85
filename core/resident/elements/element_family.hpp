// A family of elements in an executor's memory: what the sum of all families needs to know of it.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "core/exec/buffer.hpp"
#include "core/linear/block_system.hpp"
#include "core/resident/elements/element_kernels.hpp"
#include "core/scene/scene.hpp"
#include "core/terms/step_hessian.hpp"
#include "core/terms/term_set.hpp"

namespace bb::resident {

using exec::Buffer;

/// All pointers are memory of the executor. x: [3 n_vertices] m.
class ElementFamily {
 public:
  ElementFamily() = default;
  ElementFamily(const ElementFamily&) = delete;
  ElementFamily& operator=(const ElementFamily&) = delete;
  virtual ~ElementFamily() = default;
  /// Of its term (core/terms/registry.inc).
  virtual std::string_view name() const = 0;
  virtual TermGroup group() const = 0;
  virtual int width() const = 0;
  virtual Index size() const = 0;
  /// energy [size], J.
  virtual void values(const double* x, double* energy) = 0;
  /// energy [size]; grad [3 width, piece.n], N.
  virtual void gradients(Piece piece, const double* x, double* energy, double* grad) = 0;
  /// hess [lower numbers, piece.n], N/m.
  virtual void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) = 0;
};

/// Launches of the kernels of Elements (element_kernels.hpp), as what Base asks for.
template <class Elements, class Base = ElementFamily>
class FamilyOf : public Base {
 public:
  FamilyOf(exec::Executor& executor, std::string_view name, TermGroup group)
      : executor_(executor), name_(name), group_(group) {}
  std::string_view name() const override { return name_; }
  TermGroup group() const override { return group_; }
  int width() const override { return Elements::width; }
  Index size() const override { return elements_.n; }
  void values(const double* x, double* energy) override {
    executor_.each(size(), ElementValues<Elements>{elements_, x, energy});
  }
  void gradients(Piece piece, const double* x, double* energy, double* grad) override {
    executor_.each(piece.n, ElementGradients<Elements>{elements_, piece, x, energy, grad});
  }
  void hessians(Piece piece, const HessianRequest& request, const double* x, double* hess) override {
    executor_.each(piece.n, ElementHessians<Elements>{elements_, piece, request, x, hess});
  }

 protected:
  exec::Executor& executor_;
  Elements elements_{};

 private:
  std::string_view name_;
  TermGroup group_;
};

/// A family with the stencils that it was made from, which are needed until its gathers are made.
struct MadeFamily {
  std::unique_ptr<ElementFamily> family;
  std::vector<int> vertices;  // [width size] element-major
};

/// The elastic families of a scene in the order of the terms. Errors: those of the batches of core/energy; OutOfMemory.
std::vector<MadeFamily> make_elastic_families(exec::Executor& executor, const Scene& scene);

/// element-major [width n] to columns [width, n].
template <class T>
std::vector<T> to_columns(std::span<const T> rows, std::size_t width) {
  const std::size_t n = width == 0 ? 0 : rows.size() / width;
  std::vector<T> out(rows.size());
  for (std::size_t e = 0; e < n; ++e) {
    for (std::size_t k = 0; k < width; ++k) out[k * n + e] = rows[width * e + k];
  }
  return out;
}

/// What hessian_at (core/newton/hessian_level.hpp) gives. threshold: infinity where no vertex is asked. force: [n_vertices]
/// N, in the executor's memory.
HessianRequest hessian_request(StepHessian choice, double t, double threshold, const double* force);

}  // namespace bb::resident
