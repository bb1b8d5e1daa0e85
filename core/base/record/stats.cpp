// Order statistics of a sample.
#include <algorithm>
#include <cmath>

#include "core/base/record/run_record.hpp"

namespace bb {

Stats summarize(std::vector<double> sample) {
  std::erase_if(sample, [](double v) { return !std::isfinite(v); });
  Stats out;
  out.n = sample.size();
  if (sample.empty()) {
    out.min = out.p05 = out.median = out.p95 = out.max = out.sum = Number::missing("empty");
    return out;
  }
  std::sort(sample.begin(), sample.end());
  const auto quantile = [&](double q) {
    const double at = q * static_cast<double>(sample.size() - 1);
    const auto low = static_cast<std::size_t>(at);
    const std::size_t high = std::min(low + 1, sample.size() - 1);
    return sample[low] + (at - static_cast<double>(low)) * (sample[high] - sample[low]);
  };
  double sum = 0;
  for (double v : sample) sum += v;
  out.min = sample.front();
  out.p05 = quantile(0.05);
  out.median = quantile(0.5);
  out.p95 = quantile(0.95);
  out.max = sample.back();
  out.sum = sum;
  return out;
}

}  // namespace bb
