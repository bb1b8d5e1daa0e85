// All bending hinges of a scene.
#pragma once

#include <array>

#include "core/energy/element_batch.hpp"
#include "core/energy/hinge.hpp"
#include "core/math/precision.hpp"

namespace bb {

class HingeBatch final : public EnergyBatch {
 public:
  /// @param hinges e0 e1 v0 v1   @param stiffness [n] J   @param rest_angle [n] rad, convention of
  /// hinge_angle. ConfigError: column of another length.
  HingeBatch(std::span<const std::array<int, 4>> hinges, std::vector<double> stiffness,
             std::vector<double> rest_angle, Precision precision = Precision::full);
  /// Adds an exponential part to the stiffness (stiffening.hpp): `exponential` [n] J at rest, >= 0, `exponent` [n] 1/rad, > 0.
  /// ConfigError: column of another length.
  void set_stiffening(std::vector<double> exponential, std::vector<double> exponent);
  /// Lets rest angles follow: a deviation beyond yield [n] (rad) creeps at rate [n] (1/s). The batch remembers the rest angles.
  /// ConfigError: column of another length.
  void set_creep(std::vector<double> yield, std::vector<double> rate);
  std::string_view name() const override { return "hinge"; }
  int width() const override { return 4; }
  std::span<const int> vertices() const override { return vertices_; }
  void values(const PositionsView& x, double* energy) const override;
  void derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const override;
  std::vector<std::size_t> cusps(const PositionsView& x) const override;
  std::span<const double> memory() const override;
  void set_memory(std::span<const double> memory) override;
  void flow(const PositionsView& x, double dt, std::span<double> memory) const override;

 private:
  template <class T>
  HingeEnergy<T> energy_of(const Vec<T, 3> (&p)[4], std::size_t e) const;
  template <class T>
  void fill(const PositionsView& x, Projection projection, PassParts parts, LocalTerms& out) const;

  std::vector<int> vertices_;
  std::vector<double> stiffness_, rest_angle_;
  std::vector<double> exponential_, exponent_;  // empty: no exponential part
  std::vector<double> yield_, rate_;            // empty: rest angles stay
  Precision precision_;
};

}  // namespace bb
