// The strain limit S as a term of the host, one of triangles and one of tetrahedra.
#pragma once

#include <cstdint>
#include <vector>

#include "core/model/scene/scene.hpp"
#include "core/terms/host_term.hpp"
#include "core/terms/limit_steps.hpp"

namespace bb {

/// H of every limited element, as a policy reads it. out: [(3 width)^2 n] N/m, resized, where the result lies.
ElasticMatrix gather_elastic(const LimitFamily& family, const BlockSystem& blocks,
                             const BlockSystem::Values& elastic, std::vector<double>& out);

class StrainLimitTerm final : public LimitSteps<HostTerm> {
 public:
  /// All arguments must outlive the term. fixed: [3 n] prescribed or locked degrees of freedom.
  StrainLimitTerm(exec::Executor& executor, const Scene& scene, const TermOptions& options,
                  const std::vector<std::uint8_t>& fixed, bool of_solids);

  void linearise(const PositionsView& x, const TermContext& context) override;
  void clamp(const PositionsView& x) override;
  void report_overload(const PositionsView& x, const PositionsView& others, const PositionsView& dx,
                       StepNumbers& out) override;

  const LimitFamily& family() const { return state_->family(); }

 private:
  double times_larger(std::size_t e, const PositionsView& others) const;
  std::string element_name(std::size_t e) const;

  const Scene& scene_;
  const TermOptions& options_;
  const std::vector<std::uint8_t>& fixed_;
  std::vector<double> hess_;  // of gather_elastic()
};

}  // namespace bb
