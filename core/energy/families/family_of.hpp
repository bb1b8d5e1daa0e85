// A family of elements from the struct of their kind: what the file that fills the columns of a kind derives from.
#pragma once

#include <array>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/energy/families/element_columns.hpp"
#include "core/energy/families/element_family.hpp"
#include "core/energy/families/element_kernels.hpp"

namespace bb {

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
