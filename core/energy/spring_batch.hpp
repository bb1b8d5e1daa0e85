// All springs of a scene.
#pragma once

#include <array>

#include "core/energy/element_batch.hpp"
#include "core/math/precision.hpp"

namespace bb {

class SpringBatch final : public EnergyBatch {
 public:
  /// @param stiffness [n] N/m; the rest lengths are those at x_rest (m). ConfigError: column
  /// of another length.
  SpringBatch(std::span<const std::array<int, 2>> edges, const PositionsView& x_rest,
              std::vector<double> stiffness, Precision precision = Precision::full);
  std::string_view name() const override { return "spring"; }
  int width() const override { return 2; }
  std::span<const int> vertices() const override { return vertices_; }
  std::span<const double> rest_lengths() const { return rest_length_; }  // [n] m
  void values(const PositionsView& x, double* energy) const override;
  void derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const override;

 private:
  std::vector<int> vertices_;
  std::vector<double> stiffness_, rest_length_;
  Precision precision_;
};

}  // namespace bb
