// All bending hinges of a scene.
#pragma once

#include <array>

#include "core/energy/element_batch.hpp"
#include "core/math/precision.hpp"

namespace bb {

class HingeBatch final : public EnergyBatch {
 public:
  /// @param hinges e0 e1 v0 v1   @param stiffness [n] J   @param rest_angle [n] rad, convention of
  /// hinge_angle. ConfigError: column of another length.
  HingeBatch(std::span<const std::array<int, 4>> hinges, std::vector<double> stiffness,
             std::vector<double> rest_angle, Precision precision = Precision::full);
  std::string_view name() const override { return "hinge"; }
  int width() const override { return 4; }
  std::span<const int> vertices() const override { return vertices_; }
  void values(const PositionsView& x, double* energy) const override;
  void derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const override;

 private:
  template <class T>
  void fill(const PositionsView& x, Projection projection, PassParts parts, LocalTerms& out) const;

  std::vector<int> vertices_;
  std::vector<double> stiffness_, rest_angle_;
  Precision precision_;
};

/// Angles [n] (rad) of hinges e0 e1 v0 v1 at x: the rest angles when x is the rest shape.
std::vector<double> hinge_angles(std::span<const std::array<int, 4>> hinges, const PositionsView& x);

}  // namespace bb
