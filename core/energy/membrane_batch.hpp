// All membrane triangles of one model of a scene.
#pragma once

#include <array>
#include <tuple>

#include "core/energy/element_batch.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/math/precision.hpp"
#include "core/scene/parts/shrink_key.hpp"

namespace bb {

/// Rest data in another scalar.
template <class T>
TriangleRest<T> rest_in(const TriangleRest<double>& rest) {
  return {rest.dm_inv.template cast<T>(), static_cast<T>(rest.area)};
}

/// Rest data of triangles at x_rest [3 x n_vertices] (m). `warp`: [n] warp directions, or empty for each
/// triangle's first edge. ConfigError when a triangle has no area (or the warp direction is normal to
/// it).
std::vector<TriangleRest<double>> triangle_rests(std::span<const std::array<int, 3>> triangles,
                                                 const PositionsView& x_rest, bool planar,
                                                 std::span<const Vec3d> warp = {});

class MembraneBatch final : public EnergyBatch {
 public:
  /// @param model   a name of registry.inc        @param planar  F is 2x2 in the x-y plane, z has no terms
  /// @param lame_mu, lame_lambda [n] N/m          @param warp    as in triangle_rests
  /// @param precision  the scalars of values and derivatives
  /// ConfigError: unknown model, columns of another length, triangles without area.
  MembraneBatch(std::string_view model, std::span<const std::array<int, 3>> triangles,
                const PositionsView& x_rest, std::vector<double> lame_mu, std::vector<double> lame_lambda,
                bool planar = false, std::span<const Vec3d> warp = {}, Precision precision = Precision::full);
  /// Scales the rest triangles by factors [n] > 0 along the warp direction and at right angles to it; areas with them.
  /// Before set_creep. ConfigError: column of another length.
  void scale_rest(std::span<const Vec2d> factors);
  /// Further factors on the rest lengths, over time; before set_creep. ConfigError: column of another length.
  void set_shrink(ShrinkSchedule schedule);
  /// Lets rest triangles follow: singular values of F beyond 1 +- yield [n] (1) creep at rate [n] (1/s). F is that of the scaled rest
  /// triangle times the inverse of a plastic part, which is what the batch remembers; areas at rest stay. ConfigError: column
  /// of another length.
  void set_creep(std::vector<double> yield, std::vector<double> rate);
  void set_time(double t) override;
  std::string_view name() const override { return model<double>().name; }
  int width() const override { return 3; }
  std::span<const int> vertices() const override { return vertices_; }
  std::span<const TriangleRest<double>> rests() const { return rests_; }
  void values(const PositionsView& x, double* energy) const override;
  void derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const override;
  std::vector<std::size_t> cusps(const PositionsView& x) const override;
  std::span<const double> memory() const override { return plastic_inv_; }
  void set_memory(std::span<const double> memory) override;
  void flow(const PositionsView& x, double dt, std::span<double> memory) const override;

 private:
  template <class T>
  const MembraneModel<T>& model() const {
    return *std::get<const MembraneModel<T>*>(models_);
  }

  std::tuple<const MembraneModel<double>*, const MembraneModel<float>*> models_;
  bool planar_;
  std::vector<int> vertices_;
  std::vector<TriangleRest<double>> rests_;
  std::vector<double> lame_mu_, lame_lambda_;
  void place(std::size_t e);

  std::vector<TriangleRest<double>> given_;  // before any creep and shrinking over time; empty: no such thing
  ShrinkSchedule shrink_;
  std::vector<double> factor_;                      // of each list of it, 1
  std::vector<double> yield_, rate_, plastic_inv_;  // plastic_inv_: [4 n], columns of 2 x 2
  Precision precision_;
};

}  // namespace bb
