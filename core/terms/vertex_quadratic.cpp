#include "core/terms/vertex_quadratic.hpp"

#include "core/energy/vertex_loads.hpp"
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
    const Vec3d from = off(x, e);
    local.energy[e] = quadratic_value<double>(matrix(e), from);
    Vec3d::Map(&local.grad[3 * e]) = matrix(e) * from;
  });
}

void VertexQuadratic::evaluate(const PositionsView& x) {
  std::vector<double>& energy = families_[0].trial_energy;
  parallel_items(n_elements(), block_items, [&](std::size_t e) {
    const Vec3d from = off(x, e);
    energy[e] = quadratic_value<double>(matrix(e), from);
  });
}

void VertexQuadratic::change(const PositionsView& x0, const PositionsView& x1, EnergyParts& out) const {
  const std::size_t begin = out.size();
  out.resize(begin + n_elements());
  parallel_items(n_elements(), block_items, [&](std::size_t e) {
    const Vec3d from = off(x0, e), to = off(x1, e), step = x1.col(vertices_[e]) - x0.col(vertices_[e]);
    const auto part = quadratic_change<double>(matrix(e), from, to, step);
    out[begin + e] = {part.change, part.magnitude};
  });
}

}  // namespace bb
