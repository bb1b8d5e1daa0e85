// Loops over springs.
#include "core/energy/spring_batch.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/spring.hpp"

namespace bb {

SpringConstraints::SpringConstraints(std::span<const int> vertices, std::span<const double> rest_length,
                                     std::span<const double> stiffness)
    : vertices_(vertices), rest_length_(rest_length) {
  for (const double k : stiffness) compliance_.push_back(1 / k);
}

double SpringConstraints::value(std::size_t e, const PositionsView& x, double* gradient) const {
  const Points<2> p(x, vertices_, e);
  Vec3d of[2];
  const double out = spring_stretch<double>(p.x, rest_length_[e], of);
  for (std::size_t i = 0; i < 2; ++i) Vec3d::Map(gradient + 3 * i) = of[i];
  return out;
}

namespace {

std::vector<double> lengths(std::span<const std::array<int, 2>> edges, const PositionsView& x) {
  std::vector<double> out;
  for (const auto& [a, b] : edges) out.push_back((x.col(b) - x.col(a)).norm());
  return out;
}

}  // namespace

SpringBatch::SpringBatch(std::span<const std::array<int, 2>> edges, const PositionsView& x_rest,
                         std::vector<double> stiffness, Precision precision)
    : SpringBatch(edges, lengths(edges, x_rest), std::move(stiffness), precision) {}

SpringBatch::SpringBatch(std::span<const std::array<int, 2>> edges, std::vector<double> rest_length,
                         std::vector<double> stiffness, Precision precision)
    : stiffness_(std::move(stiffness)), rest_length_(std::move(rest_length)), precision_(precision) {
  check_column("spring/stiffness", edges.size(), stiffness_, false);
  check_column("spring/rest_length", edges.size(), rest_length_, false);
  for (const auto& edge : edges) vertices_.insert(vertices_.end(), edge.begin(), edge.end());
  constraints_.emplace(vertices_, rest_length_, stiffness_);
}

void SpringBatch::values(const PositionsView& x, double* energy) const {
  const auto value = [&]<class T>(std::size_t e) {
    const Points<2, T> p(x, vertices_, e);
    return spring_value<T>(p.x, static_cast<T>(stiffness_[e]), static_cast<T>(rest_length_[e]));
  };
  store_energies(size(), precision_, value, energy);
}

std::vector<std::size_t> SpringBatch::cusps(const PositionsView& x) const {
  return elements_where(size(), precision_, [&]<class T>(std::size_t e) {
    const Points<2, T> p(x, vertices_, e);
    return spring_is_cusp<T>(p.x, static_cast<T>(stiffness_[e]), static_cast<T>(rest_length_[e]));
  });
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
