#include "core/newton/energy_sum.hpp"

#include <cmath>

namespace bb {
namespace {

// Neumaier's compensated sum: the order is fixed, the error does not grow with the number of parts.
class Sum {
 public:
  void add(double part) {
    const double next = sum_ + part;
    carry_ += std::abs(sum_) >= std::abs(part) ? (sum_ - next) + part : (part - next) + sum_;
    sum_ = next;
  }
  double value() const { return sum_ + carry_; }

 private:
  double sum_ = 0, carry_ = 0;
};

/// Calls f(term, its part) for every part of every term in the order of the sums; n(i): how many parts
/// term i has.
template <class Count, class F>
void for_each_part(const TermList& terms, const Count& n, const F& f) {
  std::vector<std::size_t> on_vertices, others;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    (terms[i].on_vertices() ? on_vertices : others).push_back(i);
  }
  const std::size_t n_vertices = on_vertices.empty() ? 0 : n(on_vertices[0]);
  for (std::size_t v = 0; v < n_vertices; ++v) {
    for (const std::size_t i : on_vertices) f(i, v);
  }
  for (const std::size_t i : others) {
    for (std::size_t e = 0; e < n(i); ++e) f(i, e);
  }
}

}  // namespace

EnergyChange EnergySums::change(const TermList& terms, const Positions& x0, const Positions& x1) {
  parts_.resize(terms.size());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    parts_[i].clear();
    terms[i].change(x0, x1, parts_[i]);
  }
  Sum sum;
  double magnitude = 0;
  for_each_part(
      terms, [&](std::size_t i) { return parts_[i].size(); },
      [&](std::size_t i, std::size_t k) {
        sum.add(parts_[i][k].change);
        magnitude += parts_[i][k].magnitude;
      });
  return {sum.value(), magnitude};
}

double total_energy(const TermList& terms) {
  // of terms on vertices, which have one family, by element; of the others family by family
  Sum sum;
  const auto energies = [&](std::size_t i) -> const std::vector<double>& {
    return terms[i].families()[0].local.energy;
  };
  for_each_part(
      terms, [&](std::size_t i) { return terms[i].on_vertices() ? energies(i).size() : 1; },
      [&](std::size_t i, std::size_t k) {
        if (terms[i].on_vertices()) return sum.add(energies(i)[k]);
        for (const TermFamily& family : terms[i].families()) {
          for (const double energy : family.local.energy) sum.add(energy);
        }
      });
  return sum.value();
}

}  // namespace bb
