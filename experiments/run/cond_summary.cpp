#include "experiments/run/cond_summary.hpp"

#include <cmath>

namespace bb {

void CondSummary::add(const ConditionSample& sample) {
  const ConditionEstimate& e = sample.estimate;
  Samples& samples =
      samples_[std::string(to_string(sample.stage)) + "/" + std::string(to_string(sample.scaling))];
  ++samples.statuses[std::string(to_string(e.status))];
  const bool unbounded = e.status == ConditionStatus::singular || e.status == ConditionStatus::not_pd;
  const double cond = unbounded ? largest_known_cond : e.cond;
  if (std::isfinite(cond)) samples.log10_cond.push_back(std::log10(cond));
  if (e.lambda_min > 0) samples.log10_min.push_back(std::log10(e.lambda_min));
  if (e.lambda_max > 0) samples.log10_max.push_back(std::log10(e.lambda_max));
}

std::map<std::string, Summary::Conditioning> CondSummary::summary() const {
  std::map<std::string, Summary::Conditioning> out;
  for (const auto& [key, samples] : samples_) {
    out[key] = {summarize(samples.log10_cond), summarize(samples.log10_min), summarize(samples.log10_max),
                samples.statuses};
  }
  return out;
}

}  // namespace bb
