// Loops over springs.
#include "core/energy/spring_batch.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/spring.hpp"

namespace bb {

SpringBatch::SpringBatch(std::span<const std::array<int, 2>> edges, const PositionsView& x_rest,
                         std::vector<double> stiffness, Precision precision)
    : stiffness_(std::move(stiffness)), precision_(precision) {
  check_column("spring/stiffness", edges.size(), stiffness_, false);
  for (const auto& [a, b] : edges) {
    vertices_.insert(vertices_.end(), {a, b});
    rest_length_.push_back((x_rest.col(b) - x_rest.col(a)).norm());
  }
}

void SpringBatch::values(const PositionsView& x, double* energy) const {
  const auto value = [&]<class T>(std::size_t e) {
    const Points<2, T> p(x, vertices_, e);
    return spring_value<T>(p.x, static_cast<T>(stiffness_[e]), static_cast<T>(rest_length_[e]));
  };
  store_energies(size(), precision_, value, energy);
}

void SpringBatch::derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const {
  out.resize(size(), width());
  const auto terms = [&]<class T>(std::size_t e) {
    const Points<2, T> p(x, vertices_, e);
    return spring_terms<T>(p.x, static_cast<T>(stiffness_[e]), static_cast<T>(rest_length_[e]), projection);
  };
  store_elements(size(), precision_, terms, out);
}

}  // namespace bb
