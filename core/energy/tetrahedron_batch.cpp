// The table of solid models, from solids.inc, and loops over tetrahedra.
#include "core/energy/tetrahedron_batch.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/membrane_list.hpp"

namespace bb {

template <class T>
const Registry<SolidModel<T>>& solid_models() {
#define ENTRY(name, doc, poisson)                   \
  SolidModel<T>{#name,                              \
                doc,                                \
                poisson,                            \
                &tetrahedron_value<solid::name, T>, \
                &tetrahedron_terms<solid::name, T>, \
                &tetrahedron_is_cusp<solid::name, T>},
  static const Registry<SolidModel<T>> models({
#include "core/energy/solids.inc"
  });
#undef ENTRY
  return models;
}

template const Registry<SolidModel<float>>& solid_models<float>();
template const Registry<SolidModel<double>>& solid_models<double>();

std::vector<TetrahedronRest<double>> tetrahedron_rests(std::span<const std::array<int, 4>> tetrahedra,
                                                       const PositionsView& x_rest) {
  std::vector<TetrahedronRest<double>> rests;
  for (const auto& t : tetrahedra) {
    const Vec3d x[4] = {x_rest.col(t[0]), x_rest.col(t[1]), x_rest.col(t[2]), x_rest.col(t[3])};
    rests.push_back(tetrahedron_rest<double>(x));
    if (!(rests.back().volume > 0 && rests.back().dm_inv.allFinite())) {
      throw ConfigError("tetrahedron " + std::to_string(rests.size() - 1),
                        std::to_string(rests.back().volume) + " m^3", "a rest tetrahedron of volume > 0");
    }
  }
  return rests;
}

TetrahedronBatch::TetrahedronBatch(std::string_view model, std::span<const std::array<int, 4>> tetrahedra,
                                   const PositionsView& x_rest, std::vector<double> lame_mu,
                                   std::vector<double> lame_lambda, Precision precision)
    : models_(&solid_models<double>().require(model, "solid/model"),
              &solid_models<float>().require(model, "solid/model")),
      rests_(tetrahedron_rests(tetrahedra, x_rest)),
      lame_mu_(std::move(lame_mu)),
      lame_lambda_(std::move(lame_lambda)),
      precision_(precision) {
  check_column("solid/lame_mu", tetrahedra.size(), lame_mu_, false);
  check_column("solid/lame_lambda", tetrahedra.size(), lame_lambda_, false);
  for (const auto& t : tetrahedra) vertices_.insert(vertices_.end(), t.begin(), t.end());
}

void TetrahedronBatch::values(const PositionsView& x, double* energy) const {
  const auto value = [&]<class T>(std::size_t e) {
    const Points<4, T> p(x, vertices_, e);
    return model<T>().value(rest_in<T>(rests_[e]), p.x, static_cast<T>(lame_mu_[e]),
                            static_cast<T>(lame_lambda_[e]));
  };
  store_energies(size(), precision_, value, energy);
}

void TetrahedronBatch::derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const {
  out.resize(size(), width());
  const auto terms = [&]<class T>(std::size_t e) {
    const Points<4, T> p(x, vertices_, e);
    return model<T>().terms(rest_in<T>(rests_[e]), p.x, static_cast<T>(lame_mu_[e]),
                            static_cast<T>(lame_lambda_[e]), projection);
  };
  store_elements(size(), precision_, terms, out);
}

std::vector<std::size_t> TetrahedronBatch::cusps(const PositionsView& x) const {
  return elements_where(size(), precision_, [&]<class T>(std::size_t e) {
    const Points<4, T> p(x, vertices_, e);
    if (tetrahedron_determinant<T>(p.x) > T(0)) return false;  // no singular value is negative
    return model<T>().is_cusp(rest_in<T>(rests_[e]), p.x, static_cast<T>(lame_mu_[e]),
                              static_cast<T>(lame_lambda_[e]));
  });
}

}  // namespace bb
