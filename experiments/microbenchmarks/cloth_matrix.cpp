#include "experiments/microbenchmarks/cloth_matrix.hpp"

#include <algorithm>
#include <random>

#include "core/math/lower_blocks.hpp"

namespace bb::bench {

void Family::add(const std::vector<int>& v, const VecXd& weights, const Vec3d& n, double kappa) {
  width = static_cast<int>(v.size());
  vertices.insert(vertices.end(), v.begin(), v.end());
  const Mat3d block = kappa * (n * n.transpose() + 0.1 * Mat3d::Identity());
  const auto entry = [&](int i, int j) { return weights[i / 3] * weights[j / 3] * block(i % 3, j % 3); };
  const std::size_t at = hess.size();
  hess.resize(at + n_lower_numbers(v.size()));
  store_lower_blocks(width, entry, &hess[at]);
}

Cloth::Cloth(int vertices_a_side) : side(vertices_a_side), n(side * side) {
  const int m = side;
  const auto id = [m](int i, int j) { return i * m + j; };
  const Vec3d up = Vec3d::UnitZ(), across = Vec3d(1, 1, 0).normalized();
  for (int i = 0; i + 1 < m; ++i) {
    for (int j = 0; j + 1 < m; ++j) {
      const int a = id(i, j), b = id(i + 1, j), c = id(i, j + 1), d = id(i + 1, j + 1);
      triangles.add({a, b, c}, Vec3d(1, -0.4, -0.6), across, 1e3);
      triangles.add({d, c, b}, Vec3d(1, -0.6, -0.4), across, 1e3);
      const Eigen::Vector4d w(1, 1, -1, -1);
      hinges.add({b, c, a, d}, w, up, 1e-1);
      if (j + 2 < m) hinges.add({c, d, b, id(i + 1, j + 2)}, w, up, 1e-1);
      if (i + 2 < m) hinges.add({b, d, c, id(i + 2, j)}, w, up, 1e-1);
    }
  }
  fill_contacts(contacts_a, 1);
  fill_contacts(contacts_b, 2);
}

// A fold: vertices touch triangles in the other half of the sheet.
void Cloth::fill_contacts(Family& contacts, unsigned seed) const {
  std::mt19937_64 random(seed);
  const auto below = [&random](int k) { return static_cast<int>(random() % static_cast<unsigned>(k)); };
  for (int k = 0; k < 2 * n - n / 4; ++k) {
    const int i = below(side / 2 - 1), j = below(side - 1);
    const int p = i * side + j, t = (side - 2 - i) * side + std::min(j + below(3), side - 2);
    contacts.add({p, t, t + 1, t + side}, Eigen::Vector4d(1, -0.3, -0.3, -0.4), Vec3d::UnitZ(), 1e4);
  }
}

std::unique_ptr<BlockSystem> Cloth::system() const {
  auto s = std::make_unique<BlockSystem>(n, std::vector<std::uint8_t>(3 * static_cast<std::size_t>(n), 0));
  s->set_elements({triangles.stencils(), hinges.stencils()});
  return s;
}

const ReducedSystem& Cloth::assemble(BlockSystem& s, const Family& contacts) const {
  s.clear();
  s.add_diagonal(std::vector<double>(static_cast<std::size_t>(n), 1.0));
  s.add_elements(0, triangles.hess);
  s.add_elements(1, hinges.hess);
  s.add_contacts(0, contacts.hess);
  return s.reduce(s.values());
}

}  // namespace bb::bench
