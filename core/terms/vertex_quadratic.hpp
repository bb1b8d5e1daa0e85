// A term that pulls single vertices to given places: 1/2 (x - y)^T K (x - y), K a matrix of each.
#pragma once

#include <vector>

#include "core/terms/term.hpp"

namespace bb {

class VertexQuadratic : public Term {
 public:
  /// One element each.
  explicit VertexQuadratic(std::vector<int> vertices);
  TermGroup group() const override { return TermGroup::load; }
  Phase phase() const override { return Phase::assembly; }

  void linearise(const PositionsView& x, const TermContext&) override;
  void evaluate(const PositionsView& x) override;
  /// A square of differences, not a difference of squares.
  void change(const PositionsView& x0, const PositionsView& x1, EnergyParts& out) const override;

 protected:
  std::size_t n_elements() const { return vertices_.size(); }
  int vertex(std::size_t e) const { return vertices_[e]; }
  /// y (m) and K (N/m) of element e; K symmetric without negative eigenvalues.
  void set(std::size_t e, const Vec3d& place, const Mat3d& matrix);

 private:
  Vec3d off(const PositionsView& x, std::size_t e) const { return x.col(vertices_[e]) - place_[e]; }
  Eigen::Map<const Mat3d> matrix(std::size_t e) const {
    return Eigen::Map<const Mat3d>(&families_[0].local.hess[9 * e]);
  }

  std::vector<int> vertices_;
  std::vector<Vec3d> place_;  // m
};

}  // namespace bb
