// Loops over springs.
#include "core/energy/spring_batch.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/spring.hpp"

namespace bb {

SpringBatch::SpringBatch(std::span<const std::array<int, 2>> edges, const Positions& x_rest,
                         std::vector<double> stiffness)
    : stiffness_(std::move(stiffness)) {
  check_column("spring/stiffness", edges.size(), stiffness_, false);
  for (const auto& [a, b] : edges) {
    vertices_.insert(vertices_.end(), {a, b});
    rest_length_.push_back((x_rest.col(b) - x_rest.col(a)).norm());
  }
}

void SpringBatch::values(const Positions& x, double* energy) const {
  for_each_element(size(), [&](std::size_t e) {
    const Points<2> p(x, vertices_, e);
    energy[e] = spring_value<double>(p.x, stiffness_[e], rest_length_[e]);
  });
}

void SpringBatch::derivatives(const Positions& x, Projection projection, LocalTerms& out) const {
  out.resize(size(), width());
  for_each_element(size(), [&](std::size_t e) {
    const Points<2> p(x, vertices_, e);
    store_terms(spring_terms<double>(p.x, stiffness_[e], rest_length_[e], projection), e, out);
  });
}

}  // namespace bb
