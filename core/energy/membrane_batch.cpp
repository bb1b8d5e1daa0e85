// Loops over membrane triangles.
#include "core/energy/membrane_batch.hpp"

#include <cmath>

#include "core/energy/element_loop.hpp"

namespace bb {

std::vector<TriangleRest<double>> triangle_rests(std::span<const std::array<int, 3>> triangles,
                                                 const PositionsView& x_rest, bool planar,
                                                 std::span<const Vec3d> warp) {
  std::vector<TriangleRest<double>> rests;
  rests.reserve(triangles.size());
  if (!warp.empty() && warp.size() != triangles.size()) {
    throw ConfigError("membrane/warp", std::to_string(warp.size()) + " directions",
                      std::to_string(triangles.size()) + ", one a triangle");
  }
  for (const auto& [a, b, c] : triangles) {
    const Vec3d x[3] = {x_rest.col(a), x_rest.col(b), x_rest.col(c)};
    const Vec3d u = warp.empty() ? Vec3d(x[1] - x[0]) : warp[rests.size()];
    rests.push_back(planar ? planar_triangle_rest<double>(x, u) : triangle_rest<double>(x, u));
    if (!(rests.back().area > 0 && rests.back().dm_inv.allFinite())) {
      throw ConfigError("triangle " + std::to_string(rests.size() - 1),
                        "no area, or no warp direction in its plane", "a rest triangle of area > 0");
    }
  }
  return rests;
}

MembraneBatch::MembraneBatch(std::string_view model, std::span<const std::array<int, 3>> triangles,
                             const PositionsView& x_rest, std::vector<double> lame_mu,
                             std::vector<double> lame_lambda, bool planar, std::span<const Vec3d> warp,
                             Precision precision)
    : models_(&membrane_models<double>().require(model, "membrane/model"),
              &membrane_models<float>().require(model, "membrane/model")),
      planar_(planar),
      rests_(triangle_rests(triangles, x_rest, planar, warp)),
      lame_mu_(std::move(lame_mu)),
      lame_lambda_(std::move(lame_lambda)),
      precision_(precision) {
  check_column("membrane/lame_mu", triangles.size(), lame_mu_, false);
  check_column("membrane/lame_lambda", triangles.size(), lame_lambda_, false);
  for (const auto& triangle : triangles) vertices_.insert(vertices_.end(), triangle.begin(), triangle.end());
}

void MembraneBatch::values(const PositionsView& x, double* energy) const {
  const auto value = [&]<class T>(std::size_t e) {
    const Points<3, T> p(x, vertices_, e);
    const auto of_model = planar_ ? model<T>().value_planar : model<T>().value;
    return of_model(rest_in<T>(rests_[e]), p.x, static_cast<T>(lame_mu_[e]), static_cast<T>(lame_lambda_[e]));
  };
  store_energies(size(), precision_, value, energy);
}

void MembraneBatch::derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const {
  out.resize(size(), width());
  const auto terms = [&]<class T>(std::size_t e) {
    const Points<3, T> p(x, vertices_, e);
    const auto of_model = planar_ ? model<T>().terms_planar : model<T>().terms;
    return of_model(rest_in<T>(rests_[e]), p.x, static_cast<T>(lame_mu_[e]), static_cast<T>(lame_lambda_[e]),
                    projection);
  };
  store_elements(size(), precision_, terms, out);
}

}  // namespace bb
