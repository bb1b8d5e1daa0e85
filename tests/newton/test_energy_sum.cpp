// E and its change as sums over terms: the order of the parts, and what is compensated.
#include <gtest/gtest.h>

#include <cmath>

#include "core/newton/energy_sum.hpp"

namespace bb::energy_sum_test {
namespace {

/// Energies that are given, in one family.
class Given final : public HostTerm {
 public:
  Given(std::vector<double> from, std::vector<double> to, bool vertices, bool fixed = true)
      : vertices_(vertices), fixed_(fixed) {
    TermFamily& family = families_.emplace_back();
    family.local.energy = std::move(from);
    family.trial_energy = std::move(to);
  }
  std::string_view name() const override { return "given"; }
  TermGroup group() const override { return TermGroup::load; }
  Phase phase() const override { return Phase::elastic; }
  bool on_vertices() const override { return vertices_; }
  bool fixed_stencils() const override { return fixed_; }
  void linearise(const PositionsView&, const TermContext&) override {}
  void evaluate(const PositionsView&) override {}

 private:
  bool vertices_, fixed_;
};

struct Sums {
  EnergyChange change;
  double total;
};

Sums sums_of(TermList terms) {
  EnergySums sums;
  const Positions none;
  const double total = total_energy(terms, TermSet::all());
  return {sums.change(terms, none, none), total};
}

template <class... Terms>
TermList list_of(Terms... terms) {
  TermList list;
  (list.add(std::move(terms)), ...);
  return list;
}

TEST(EnergySum, adds_the_parts_of_every_term) {
  const auto fixed = [] {
    return std::make_unique<Given>(std::vector{1.0, 2.0}, std::vector{1.5, 0.25}, false);
  };
  const auto rows = [] {
    return std::make_unique<Given>(std::vector{0.5, 3.0, 4.0}, std::vector{0.25}, false, false);
  };
  const Sums sums = sums_of(list_of(fixed(), rows()));
  EXPECT_EQ(sums.total, 3 + 7.5);
  EXPECT_EQ(sums.change.change, -1.25 + (0.25 - 7.5));
  EXPECT_EQ(sums.change.magnitude, 4.75 + 7.75);
}

TEST(EnergySum, keeps_a_small_change_among_large_parts_that_cancel) {
  const auto large = [](double from, double to) {
    return std::make_unique<Given>(std::vector{from}, std::vector{to}, false);
  };
  const Sums sums = sums_of(list_of(large(0, 1e17), large(0, 1), large(1e17, 0)));
  EXPECT_EQ(sums.change.change, 1);
  EXPECT_EQ(sums.change.magnitude, 2e17);
}

/// The parts of one term are summed in blocks: what rounding took of a block belongs to the whole.
TEST(EnergySum, keeps_a_small_change_among_large_parts_of_one_term) {
  const Sums sums = sums_of(
      list_of(std::make_unique<Given>(std::vector{0.0, 0.0, 1e17}, std::vector{1e17, 1.0, 0.0}, false)));
  EXPECT_EQ(sums.change.change, 1);
}

/// 1e17 and 1 are added before their vertex's -1e17 and not after the other vertex's: seen in the plain sum
/// of magnitudes, in which the order decides what is rounded away.
TEST(EnergySum, takes_terms_on_vertices_vertex_by_vertex_before_the_others) {
  const double tiny = 1,
               huge = std::ldexp(1.0, 53);  // huge + tiny is rounded to huge, tiny + tiny + huge is not
  const auto on_vertices = [](std::vector<double> to) {
    return std::make_unique<Given>(std::vector<double>(to.size(), 0.0), std::move(to), true);
  };
  const auto other = [](double to) {
    return std::make_unique<Given>(std::vector{0.0}, std::vector{to}, false);
  };
  // vertex by vertex: tiny + tiny, then huge + 0; term by term it would be tiny + huge + tiny
  EXPECT_EQ(sums_of(list_of(on_vertices({tiny, huge}), on_vertices({tiny, 0}))).change.magnitude, huge + 2);
  // vertices first, whatever the place in the list
  EXPECT_EQ(sums_of(list_of(other(huge), on_vertices({tiny, tiny}))).change.magnitude, huge + 2);
}

}  // namespace
}  // namespace bb::energy_sum_test
