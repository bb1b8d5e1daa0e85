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

/// Calls f(i, part) for every part of every term i in the order of the sums.
template <class F>
void for_each_part(const TermList& terms, const std::vector<EnergyParts>& parts, const F& f) {
  std::vector<std::size_t> on_vertices, others;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    (terms[i].on_vertices() ? on_vertices : others).push_back(i);
  }
  const std::size_t n_vertices = on_vertices.empty() ? 0 : parts[on_vertices[0]].change.size();
  for (std::size_t v = 0; v < n_vertices; ++v) {
    for (const std::size_t i : on_vertices) f(i, v);
  }
  for (const std::size_t i : others) {
    for (std::size_t e = 0; e < parts[i].change.size(); ++e) f(i, e);
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
  for_each_part(terms, parts_, [&](std::size_t i, std::size_t part) {
    sum.add(parts_[i].change[part]);
    magnitude += parts_[i].magnitude[part];
  });
  return {sum.value(), magnitude};
}

double EnergySums::total(const TermList& terms) {
  parts_.resize(terms.size());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    parts_[i].clear();
    for (const TermFamily& family : terms[i].families()) {
      for (const double energy : family.local.energy) parts_[i].add(energy, 0);
    }
  }
  Sum sum;
  for_each_part(terms, parts_, [&](std::size_t i, std::size_t part) { sum.add(parts_[i].change[part]); });
  return sum.value();
}

}  // namespace bb
