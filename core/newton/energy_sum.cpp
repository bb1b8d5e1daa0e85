#include "core/newton/energy_sum.hpp"

#include <cmath>

#include "core/math/parallel.hpp"

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
  void add(const Sum& block) {
    add(block.sum_);
    carry_ += block.carry_;
  }
  double value() const { return sum_ + carry_; }

 private:
  double sum_ = 0, carry_ = 0;
};

/// Change and magnitude, or energies, of some parts.
struct Sums {
  Sum change;
  double magnitude = 0;
};

/// add(k, sums) for k in [0, n): block by block, the blocks in order.
template <class Add>
void add_blocks(std::size_t n, const Add& add, Sums& total) {
  std::vector<Sums> blocks(n_blocks(n));
  parallel_blocks(n, [&](std::size_t b, std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) add(k, blocks[b]);
  });
  for (const Sums& block : blocks) {
    total.change.add(block.change);
    total.magnitude += block.magnitude;
  }
}

/// The terms on vertices, and the others.
struct Order {
  std::vector<std::size_t> on_vertices, others;
  explicit Order(const TermList& terms, TermSet set = TermSet::all()) {
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (!set.has(terms[i].group())) continue;
      (terms[i].on_vertices() ? on_vertices : others).push_back(i);
    }
  }
};

}  // namespace

EnergyChange EnergySums::change(const TermList& terms, const PositionsView& x0, const PositionsView& x1) {
  parts_.resize(terms.size());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    parts_[i].clear();
    terms[i].change(x0, x1, parts_[i]);
  }
  const auto add = [this](std::size_t i, std::size_t k, Sums& sums) {
    sums.change.add(parts_[i][k].change);
    sums.magnitude += parts_[i][k].magnitude;
  };
  const Order order(terms);
  Sums total;
  const auto add_vertex = [&](std::size_t v, Sums& sums) {
    for (const std::size_t i : order.on_vertices) add(i, v, sums);
  };
  if (!order.on_vertices.empty()) add_blocks(parts_[order.on_vertices[0]].size(), add_vertex, total);
  for (const std::size_t i : order.others) {
    add_blocks(
        parts_[i].size(), [&](std::size_t k, Sums& sums) { add(i, k, sums); }, total);
  }
  return {total.change.value(), total.magnitude};
}

double total_energy(const TermList& terms, TermSet set) {
  const auto energies = [&](std::size_t i) -> const std::vector<double>& {
    return terms[i].families()[0].local.energy;
  };
  const Order order(terms, set);
  Sums total;
  const auto add_vertex = [&](std::size_t v, Sums& sums) {
    for (const std::size_t i : order.on_vertices) sums.change.add(energies(i)[v]);
  };
  if (!order.on_vertices.empty()) add_blocks(energies(order.on_vertices[0]).size(), add_vertex, total);
  for (const std::size_t i : order.others) {
    for (const TermFamily& family : terms[i].families()) {
      const std::vector<double>& energy = family.local.energy;
      add_blocks(
          energy.size(), [&](std::size_t k, Sums& sums) { sums.change.add(energy[k]); }, total);
    }
  }
  return total.change.value();
}

}  // namespace bb
