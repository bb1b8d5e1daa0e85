// The condition numbers of a run in one table: every sample counts.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/record/run_record.hpp"

namespace bb {

class Archive;

class CondSummary {
 public:
  /// A matrix that is singular or not positive definite has no finite condition number: it counts with the
  /// largest that is claimed, 1e14. An estimate that did not converge has no value and is only counted.
  void add(const ConditionSample& sample);
  /// Adds all samples of `other`, after those that are here.
  void append(const CondSummary& other);
  /// By "<stage>/<scaling>", with "solved/" before it for matrices that are not the clamped ones.
  CondMap summary() const;
  void keep(Archive& archive);

 private:
  struct Samples {
    std::vector<double> cond, lambda_min, lambda_max;  // log10
    CountMap statuses;
  };
  std::map<std::string, Samples> samples_;
};

}  // namespace bb
