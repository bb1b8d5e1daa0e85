// The energies of a family of rows on lagged contacts, from the functors of its kind (lagged_rows.hpp).
#pragma once

#include "core/energy/element_loop.hpp"
#include "core/terms/lagged_family.hpp"

namespace bb {

/// The local terms of a row side by side, as an assembly in the host's cache reads them. Of a host alone.
template <class Rows, class T>
struct MotionLocalTerms {
  static constexpr exec::Index grain = 64;
  Rows rows;
  PassParts parts;
  const double* x;
  LocalTerms* out;  // of n elements with four vertices
  void operator()(exec::Index r) const {
    store_terms<T, 12>(motion_in_points<T, 4>(rows.template terms<T>(x, r), rows.template weights<T>(r)),
                       static_cast<std::size_t>(r), parts, *out);
  }
};

/// Rows: a kind of lagged_rows.hpp.
template <class Rows>
class LaggedFamilyOf : public LaggedFamily {
 public:
  void values(const double* x, double* energy) override {
    with_value_scalar(place_.precision, [&]<class T>() {
      place_.executor.each(size(), MotionValues<Rows, T>{of_kind(), x, energy});
    });
  }
  void gradients(const double* x, double* energy, double* force) override {
    place_.executor.each(size(), MotionGradients<Rows>{of_kind(), x, energy, force});
  }
  void hessians(const double* x, double* hess) override {
    place_.executor.each(size(), MotionHessians<Rows>{of_kind(), x, hess});
  }
  void changes(const double* x, const double* motion, double* force) override {
    place_.executor.each(size(), MotionChanges<Rows>{of_kind(), x, motion, force});
  }
  void derivatives(const double* x, LocalTerms& out) override {
    for_each_pass(place_.precision, [&]<class T>(PassParts parts) {
      place_.executor.each(size(), MotionLocalTerms<Rows, T>{of_kind(), parts, x, &out});
    });
  }
  void ways(const double* x, double* way) const override {
    const Rows rows = of_kind();
    for (exec::Index r = 0; r < rows.n; ++r) Vec3d::Map(way + 3 * r) = rows.way(x, r);
  }

 protected:
  using LaggedFamily::LaggedFamily;
  /// As kernels read them.
  Rows of_kind() const {
    Rows out = kind_;
    static_cast<LaggedRows&>(out) = view();
    return out;
  }

  Rows kind_{};  // what is not of every kind
};

}  // namespace bb
