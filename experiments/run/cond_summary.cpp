#include "experiments/run/cond_summary.hpp"

#include <cmath>

#include "core/base/archive/archive.hpp"

namespace bb {
namespace {

void add_log10(std::vector<double>& list, const Number& n) {
  if (n.finite() && n.value > 0) list.push_back(std::log10(n.value));
}

}  // namespace

void CondSummary::add(const ConditionSample& sample) {
  const std::string form = sample.matrix == MatrixForm::clamped ? "" : "solved/";
  Samples& samples =
      samples_[form + std::string(to_string(sample.stage)) + "/" + std::string(to_string(sample.scaling))];
  ++samples.statuses[std::string(to_string(sample.status))];
  const bool unbounded =
      sample.status == ConditionStatus::singular || sample.status == ConditionStatus::not_pd;
  add_log10(samples.cond, unbounded ? Number(largest_known_cond) : sample.cond);
  add_log10(samples.lambda_min, sample.lambda_min);
  add_log10(samples.lambda_max, sample.lambda_max);
}

void CondSummary::append(const CondSummary& other) {
  const auto join = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const auto& [key, from] : other.samples_) {
    Samples& to = samples_[key];
    join(to.cond, from.cond);
    join(to.lambda_min, from.lambda_min);
    join(to.lambda_max, from.lambda_max);
    for (const auto& [status, count] : from.statuses) to.statuses[status] += count;
  }
}

void CondSummary::keep(Archive& archive) {
  std::vector<std::string> keys;
  for (const auto& [key, samples] : samples_) keys.push_back(key);
  archive(keys);
  for (const std::string& key : keys) {
    Samples& samples = samples_[key];
    archive.grown("cond " + key, samples.cond);
    archive.grown("lambda_min " + key, samples.lambda_min);
    archive.grown("lambda_max " + key, samples.lambda_max);
    archive(samples.statuses);
  }
}

CondMap CondSummary::summary() const {
  CondMap out;
  for (const auto& [key, samples] : samples_) {
    out[key] = {summarize(samples.cond), summarize(samples.lambda_min), summarize(samples.lambda_max),
                samples.statuses};
  }
  return out;
}

}  // namespace bb
