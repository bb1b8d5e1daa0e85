// All springs of a scene.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/energy/element_batch.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// l - l0 = 0 of every spring, compliance 1/k in m/N.
class SpringConstraints final : public ConstraintBatch {
 public:
  /// Columns of the batch, which must outlive it. stiffness [n] N/m.
  SpringConstraints(std::span<const int> vertices, std::span<const double> rest_length,
                    std::span<const double> stiffness);
  std::string_view name() const override { return "spring"; }
  ConstraintKind kind() const override { return ConstraintKind::equality; }
  std::string_view unit() const override { return "m"; }
  int width() const override { return 2; }
  std::span<const int> vertices() const override { return vertices_; }
  std::span<const double> compliance() const override { return compliance_; }
  double value(std::size_t e, const PositionsView& x, double* gradient) const override;

 private:
  std::span<const int> vertices_;
  std::span<const double> rest_length_;
  std::vector<double> compliance_;
};

class SpringBatch final : public EnergyBatch {
 public:
  /// @param stiffness [n] N/m; the rest lengths are those at x_rest (m). ConfigError: column
  /// of another length.
  SpringBatch(std::span<const std::array<int, 2>> edges, const PositionsView& x_rest,
              std::vector<double> stiffness, Precision precision = Precision::full);
  /// @param rest_length [n] m
  SpringBatch(std::span<const std::array<int, 2>> edges, std::vector<double> rest_length,
              std::vector<double> stiffness, Precision precision = Precision::full);
  std::string_view name() const override { return "spring"; }
  int width() const override { return 2; }
  std::span<const int> vertices() const override { return vertices_; }
  std::span<const double> rest_lengths() const { return rest_length_; }  // [n] m
  void values(const PositionsView& x, double* energy) const override;
  void derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const override;
  std::vector<std::size_t> cusps(const PositionsView& x) const override;
  const ConstraintBatch* constraints() const override { return &*constraints_; }

 private:
  std::vector<int> vertices_;
  std::vector<double> stiffness_, rest_length_;
  Precision precision_;
  std::optional<SpringConstraints> constraints_;  // of the columns above
};

}  // namespace bb
