// Sums over independent items on all threads, equal for any number of threads: integers and a minimum only.
#pragma once

#include <optional>

#include "core/audit/surface.hpp"
#include "core/math/parallel.hpp"

namespace bb::audit {

/// Keeps the lower of two names.
inline void keep_first(std::optional<PairName>& kept, const std::optional<PairName>& found) {
  if (found && (!kept || *found < *kept)) kept = found;
}

/// item(i, tally) for i in [0, n); Tally has `merge(const Tally&)`, commutative and associative.
template <class Tally, class F>
Tally tally_over(std::size_t n, F&& item) {
  return reduce_items(
      n, 64, Tally{},
      [&](std::size_t begin, std::size_t end, Tally sum) {
        for (std::size_t i = begin; i != end; ++i) item(i, sum);
        return sum;
      },
      [](Tally a, const Tally& b) {
        a.merge(b);
        return a;
      });
}

}  // namespace bb::audit
