#include "core/terms/vertex_quadratic.hpp"

#include "core/math/parallel.hpp"

namespace bb {

VertexQuadratic::VertexQuadratic(std::vector<int> vertices)
    : vertices_(std::move(vertices)), place_(vertices_.size(), Vec3d::Zero()) {
  TermFamily& family = families_.emplace_back();
  family.stencils = {1, vertices_};
  family.local.resize(vertices_.size(), 1);
  family.trial_energy.resize(vertices_.size());
}

void VertexQuadratic::set(std::size_t e, const Vec3d& place, const Mat3d& matrix) {
  place_[e] = place;
  Mat3d::Map(&families_[0].local.hess[9 * e]) = matrix;
}

void VertexQuadratic::linearise(const PositionsView& x, const TermContext&) {
  LocalTerms& local = families_[0].local;
  parallel_items(n_elements(), block_items, [&](std::size_t e) {
    const Vec3d from = off(x, e), force = matrix(e) * from;
    local.energy[e] = 0.5 * from.dot(force);
    Vec3d::Map(&local.grad[3 * e]) = force;
  });
}

void VertexQuadratic::evaluate(const PositionsView& x) {
  std::vector<double>& energy = families_[0].trial_energy;
  parallel_items(n_elements(), block_items, [&](std::size_t e) {
    const Vec3d from = off(x, e);
    energy[e] = 0.5 * from.dot(matrix(e) * from);
  });
}

void VertexQuadratic::change(const PositionsView& x0, const PositionsView& x1, EnergyParts& out) const {
  const std::size_t begin = out.size();
  out.resize(begin + n_elements());
  parallel_items(n_elements(), block_items, [&](std::size_t e) {
    const Vec3d from = off(x0, e), to = off(x1, e), step = x1.col(vertices_[e]) - x0.col(vertices_[e]);
    const double change = 0.5 * step.dot(matrix(e) * (from + to));
    out[begin + e] = {change, 0.5 * (from.dot(matrix(e) * from) + to.dot(matrix(e) * to))};
  });
}

}  // namespace bb
