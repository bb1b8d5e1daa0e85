// At what gaps a run carries its contact loads, body pair by body pair: what Comparability is judged by.
#pragma once

#include <map>
#include <vector>

#include "core/base/record/run_record.hpp"
#include "core/terms/report.hpp"
#include "experiments/run/body_pair.hpp"

namespace bb {

class Archive;

/// A weighted sample in bins of equal ratio, 64 to a factor 2: quantiles are right to 1.1 %. Memory: 64 bytes a bin that
/// was met, at most 64 for each halving of the smallest value. What is <= 0 (surfaces that overlap) has one bin below all others,
/// which a quantile says as 0.
class LogHistogram {
 public:
  /// weight > 0.
  void add(double value, double weight);
  double weight() const { return weight_; }
  /// Below which the share q of the weight lies, q in [0, 1]; inside a bin by its logarithm. Requires a value.
  double quantile(double q) const;
  void keep(Archive& archive);

 private:
  std::map<int, double> bins_;
  double weight_ = 0;
};

/// d/d_hat of the rows at converged step ends, each with kappa |b'| times the length of its step.
class ContactGaps {
 public:
  /// The scene must outlive it.
  explicit ContactGaps(const Scene& scene) : scene_(scene) {}
  /// The end of a converged step of `dt` s.
  void add(const std::vector<ContactLoad>& loads, double dt);
  /// So far; a pair without load has no entry.
  GapMap summary() const;
  void keep(Archive& archive);

 private:
  struct OfPair {
    LogHistogram gaps;
    double time = 0;  // s, of the steps at whose end it had load
    void keep(Archive& archive);
  };

  const Scene& scene_;
  std::map<BodyPair, OfPair> pairs_;
  double time_ = 0;  // s, of all converged steps
};

}  // namespace bb
