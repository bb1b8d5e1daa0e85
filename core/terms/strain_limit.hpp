// The strain limit S as a term of the host, one of triangles and one of tetrahedra.
#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/terms/strain_limit_state.hpp"
#include "core/terms/term.hpp"

namespace bb {

/// H of every limited element, as a policy reads it. out: [(3 width)^2 n] N/m, resized, where the result lies.
ElasticMatrix gather_elastic(const LimitFamily& family, const BlockSystem& blocks,
                             const BlockSystem::Values& elastic, std::vector<double>& out);

class StrainLimitTerm final : public Term {
 public:
  /// All arguments must outlive the term. fixed: [3 n] prescribed or locked degrees of freedom.
  StrainLimitTerm(exec::Executor& executor, const Scene& scene, const TermOptions& options,
                  const std::vector<std::uint8_t>& fixed, bool of_solids);
  std::string_view name() const override { return "strain_limit"; }
  TermGroup group() const override { return TermGroup::limit; }
  Phase phase() const override { return Phase::strain_limit; }

  void begin_step(const StepFrame& frame, PhaseClock& clock) override;
  void change_frame(const StepFrame& frame) override { state_.set_time({frame.dt, frame.c}); }
  void linearise(const PositionsView& x, const TermContext& context) override;
  void clamp(const PositionsView& x) override;
  double bound(const Motion& motion, IterateNumbers& report, PhaseClock& clock) override;
  std::string describe_bound() const override { return std::string(state_.describe_bound()); }
  bool admits(const PositionsView& x, PhaseClock& clock) override;
  void evaluate(const PositionsView& x) override {
    state_.evaluate(x.data(), families_[0].trial_energy.data());
  }
  void evaluate_iterate(const PositionsView& x) override;
  void accept(PhaseClock&) override { state_.accept(); }
  void report(const PositionsView& x, IterateNumbers& out, PhaseClock& clock) override;
  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock& clock) override;
  void report_overload(const PositionsView& x, const PositionsView& others, const PositionsView& dx,
                       StepNumbers& out) override;

  const LimitFamily& family() const { return state_.family(); }

 private:
  double* energies() { return families_[0].local.energy.data(); }
  double times_larger(std::size_t e, const PositionsView& others) const;
  std::string element_name(std::size_t e) const;

  const Scene& scene_;
  const TermOptions& options_;
  const std::vector<std::uint8_t>& fixed_;
  StrainLimitState state_;
  std::vector<double> hess_;  // of gather_elastic()
};

}  // namespace bb
