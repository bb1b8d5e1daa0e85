// Models of solids by name, and all tetrahedra of one model of a scene.
#pragma once

#include <array>
#include <tuple>

#include "core/energy/element_batch.hpp"
#include "core/energy/poisson_range.hpp"
#include "core/energy/tetrahedron.hpp"
#include "core/math/precision.hpp"
#include "core/parameters/registry.hpp"

namespace bb {

/// One line of solids.inc. The functions are tetrahedron_value, tetrahedron_terms and tetrahedron_is_cusp.
template <class T>
struct SolidModel {
  using Value = T (*)(const TetrahedronRest<T>&, const Vec<T, 3> (&)[4], T lame_mu, T lame_lambda);
  using Terms = ElementTerms<T, 12> (*)(const TetrahedronRest<T>&, const Vec<T, 3> (&)[4], T lame_mu,
                                        T lame_lambda, Projection);
  using IsCusp = bool (*)(const TetrahedronRest<T>&, const Vec<T, 3> (&)[4], T lame_mu, T lame_lambda);
  std::string_view name, doc;
  PoissonRange poisson;  // of materials that a body may have
  Value value;
  Terms terms;
  IsCusp is_cusp;
};

/// Rest data in another scalar.
template <class T>
TetrahedronRest<T> rest_in(const TetrahedronRest<double>& rest) {
  return {rest.dm_inv.template cast<T>(), static_cast<T>(rest.volume)};
}

/// Rest data of tetrahedra at x_rest [3 x n_vertices] (m). ConfigError: one whose volume is not positive.
std::vector<TetrahedronRest<double>> tetrahedron_rests(std::span<const std::array<int, 4>> tetrahedra,
                                                       const PositionsView& x_rest);

/// Every registered model, in the order of solids.inc. T: float or double.
template <class T>
const Registry<SolidModel<T>>& solid_models();

class TetrahedronBatch final : public EnergyBatch {
 public:
  /// @param model   a name of solids.inc        @param x_rest  [3 x n_vertices] m
  /// @param lame_mu, lame_lambda [n] Pa         @param precision  the scalars of values and derivatives
  /// ConfigError: unknown model, columns of another length, a rest tetrahedron whose volume is not positive.
  TetrahedronBatch(std::string_view model, std::span<const std::array<int, 4>> tetrahedra,
                   const PositionsView& x_rest, std::vector<double> lame_mu, std::vector<double> lame_lambda,
                   Precision precision = Precision::full);
  std::string_view name() const override { return model<double>().name; }
  int width() const override { return 4; }
  std::span<const int> vertices() const override { return vertices_; }
  std::span<const TetrahedronRest<double>> rests() const { return rests_; }
  void values(const PositionsView& x, double* energy) const override;
  void derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const override;
  std::vector<std::size_t> cusps(const PositionsView& x) const override;

 private:
  template <class T>
  const SolidModel<T>& model() const {
    return *std::get<const SolidModel<T>*>(models_);
  }

  std::tuple<const SolidModel<double>*, const SolidModel<float>*> models_;
  std::vector<int> vertices_;
  std::vector<TetrahedronRest<double>> rests_;
  std::vector<double> lame_mu_, lame_lambda_;
  Precision precision_;
};

}  // namespace bb
