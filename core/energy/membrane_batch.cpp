// Loops over membrane triangles.
#include "core/energy/membrane_batch.hpp"

#include <cmath>
#include <limits>

#include "core/energy/element_loop.hpp"
#include "core/energy/membrane_rest.hpp"
#include "core/scene/motion.hpp"

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

std::vector<std::size_t> MembraneBatch::cusps(const PositionsView& x) const {
  return elements_where(size(), precision_, [&]<class T>(std::size_t e) {
    const Points<3, T> p(x, vertices_, e);
    const Vec<T, 3> a = p.x[1] - p.x[0], b = p.x[2] - p.x[0];
    // In space a cusp needs a triangle without area.
    const T thin = std::sqrt(std::numeric_limits<T>::epsilon());
    if (!planar_ && a.cross(b).norm() > thin * a.norm() * b.norm()) return false;
    const auto of_model = planar_ ? model<T>().is_cusp_planar : model<T>().is_cusp;
    return of_model(rest_in<T>(rests_[e]), p.x, static_cast<T>(lame_mu_[e]), static_cast<T>(lame_lambda_[e]));
  });
}

void MembraneBatch::scale_rest(std::span<const Vec2d> factors) {
  if (factors.size() != rests_.size()) {
    throw ConfigError("membrane/shrink", std::to_string(factors.size()) + " entries",
                      std::to_string(rests_.size()) + ", one an element");
  }
  for (std::size_t e = 0; e < rests_.size(); ++e) {
    rests_[e].dm_inv.col(0) /= factors[e][0];
    rests_[e].dm_inv.col(1) /= factors[e][1];
    rests_[e].area *= factors[e][0] * factors[e][1];
  }
}

void MembraneBatch::set_creep(std::vector<double> yield, std::vector<double> rate) {
  check_column("membrane/yield", rests_.size(), yield, false);
  check_column("membrane/creep", rests_.size(), rate, false);
  yield_ = std::move(yield);
  rate_ = std::move(rate);
  if (given_.empty()) given_ = rests_;
  for (std::size_t e = 0; e < rests_.size(); ++e) plastic_inv_.insert(plastic_inv_.end(), {1, 0, 0, 1});
}

void MembraneBatch::set_shrink(ShrinkSchedule schedule) {
  if (schedule.list.empty()) return;
  schedule.list.resize(rests_.size(), -1);
  shrink_ = std::move(schedule);
  given_ = rests_;
  set_time(0);
}

void MembraneBatch::set_time(double t) {
  if (shrink_.list.empty()) return;
  factor_.clear();
  for (const auto& keys : shrink_.lists) factor_.push_back(value_at(keys, t));
  for (std::size_t e = 0; e < given_.size(); ++e) place(e);
}

/// The rest triangle of e from what was given, the factor of the time and what has crept.
void MembraneBatch::place(std::size_t e) {
  const int list = shrink_.list.empty() ? -1 : shrink_.list[e];
  const double factor = list < 0 ? 1 : factor_[static_cast<std::size_t>(list)];
  rests_[e] = placed_rest<double>(given_[e], factor, plastic_inv_.empty() ? nullptr : &plastic_inv_[4 * e]);
}

void MembraneBatch::set_memory(std::span<const double> memory) {
  plastic_inv_.assign(memory.begin(), memory.end());
  for (std::size_t e = 0; e < given_.size(); ++e) place(e);
}

void MembraneBatch::flow(const PositionsView& x, double dt, std::span<double> memory) const {
  for_each_element(yield_.size(), [&](std::size_t e) {
    const Points<3> p(x, vertices_, e);
    creep_plastic<double>(rests_[e], p.x, yield_[e], kept_after(rate_[e], dt), &memory[4 * e]);
  });
}

}  // namespace bb
