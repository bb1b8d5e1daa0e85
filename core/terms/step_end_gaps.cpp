#include "core/terms/step_end_gaps.hpp"

#include <algorithm>

#include "core/base/archive/archive.hpp"

namespace bb {

void PairGap::keep(Archive& archive) { archive(pair, gap, park); }

std::span<const StiffnessPolicy::PairEnd> StepEndGaps::end_step() {
  std::sort(now_.begin(), now_.end(), [](const PairGap& a, const PairGap& b) { return a.pair < b.pair; });
  ends_.clear();
  auto before = before_.begin();
  for (const PairGap& each : now_) {
    while (before != before_.end() && before->pair < each.pair) ++before;
    if (before == before_.end()) break;
    if (before->pair == each.pair) ends_.push_back({each.gap, before->gap, each.park});
  }
  before_.swap(now_);
  now_.clear();
  return ends_;
}

void StepEndGaps::keep(Archive& archive) {
  archive(before_);
  now_.clear();
}

}  // namespace bb
