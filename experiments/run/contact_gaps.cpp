#include "experiments/run/contact_gaps.hpp"

#include <cmath>
#include <limits>
#include <set>

#include "core/base/archive/archive.hpp"

namespace bb {
namespace {

constexpr double bins_per_octave = 64;

}  // namespace

void LogHistogram::add(double value, double weight) {
  constexpr int below_all = std::numeric_limits<int>::min();
  bins_[value > 0 ? static_cast<int>(std::floor(bins_per_octave * std::log2(value))) : below_all] += weight;
  weight_ += weight;
}

double LogHistogram::quantile(double q) const {
  const double wanted = q * weight_;
  double below = 0;
  int bin = 0;
  for (const auto& [index, weight] : bins_) {
    bin = index;
    if (below + weight >= wanted) return std::exp2((index + (wanted - below) / weight) / bins_per_octave);
    below += weight;
  }
  return std::exp2((bin + 1) / bins_per_octave);  // rounding of the sums
}

void LogHistogram::keep(Archive& archive) { archive(bins_, weight_); }

void ContactGaps::OfPair::keep(Archive& archive) { archive(gaps, time); }

void ContactGaps::add(const std::vector<ContactLoad>& loads, double dt) {
  time_ += dt;
  std::set<BodyPair> met;
  for (const ContactLoad& each : loads) {
    const BodyPair pair = body_pair(scene_, each.key);
    OfPair& of = pairs_[pair];
    of.gaps.add(each.gap_rel, each.load_N * dt);
    if (met.insert(pair).second) of.time += dt;
  }
}

GapMap ContactGaps::summary() const {
  double all = 0;
  for (const auto& [pair, of] : pairs_) all += of.gaps.weight();
  GapMap out;
  for (const auto& [pair, of] : pairs_) {
    PairGaps& gaps = out[name_of(scene_, pair)];
    gaps.load_N = of.gaps.weight() / time_;
    gaps.load_share = of.gaps.weight() / all;
    gaps.time_share = of.time / time_;
    gaps.gap_rel_p05 = of.gaps.quantile(0.05);
    gaps.gap_rel_median = of.gaps.quantile(0.5);
    gaps.gap_rel_p95 = of.gaps.quantile(0.95);
  }
  return out;
}

void ContactGaps::keep(Archive& archive) { archive(pairs_, time_); }

}  // namespace bb
