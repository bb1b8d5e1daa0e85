// The strain limit S as a term, one of triangles and one of tetrahedra: barrier, stiffness per element, exact step bound.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <vector>

#include "core/barrier/folded_barrier.hpp"
#include "core/energy/strain_limit_batch.hpp"
#include "core/scene/scene.hpp"
#include "core/terms/term.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

/// The elements of both kinds in the same words.
inline const std::vector<std::array<int, 3>>& limited_elements(const StrainLimitPart& part) {
  return part.triangles;
}
inline const std::vector<std::array<int, 4>>& limited_elements(const SolidLimitPart& part) {
  return part.tetrahedra;
}

/// Batch: StrainLimitBatch or SolidLimitBatch.
template <class Batch>
class StrainLimitTermOf final : public Term {
 public:
  static constexpr bool of_solids = std::is_same_v<Batch, SolidLimitBatch>;

  /// All arguments must outlive the term. fixed: [3 n] prescribed or locked degrees of freedom.
  StrainLimitTermOf(const Scene& scene, const TermOptions& options, const std::vector<std::uint8_t>& fixed);
  std::string_view name() const override { return "strain_limit"; }
  TermGroup group() const override { return TermGroup::limit; }
  Phase phase() const override { return Phase::strain_limit; }

  void begin_step(const StepFrame& frame, PhaseClock& clock) override;
  void change_frame(const StepFrame& frame) override;
  void linearise(const PositionsView& x, const TermContext& context) override;
  void clamp(const PositionsView& x) override;
  double bound(const Motion& motion, IterateNumbers& report, PhaseClock& clock) override;
  std::string describe_bound() const override {
    return of_solids ? "the strain limit of solids" : "the strain limit";
  }
  bool admits(const PositionsView& x, PhaseClock& clock) override;
  void evaluate(const PositionsView& x) override;
  void report(const PositionsView& x, IterateNumbers& out, PhaseClock& clock) override;
  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock& clock) override;
  void report_overload(const PositionsView& x, const PositionsView& others, const PositionsView& dx,
                       StepNumbers& out) override;

  /// SVD sweeps over the limited elements so far: one a state that was measured.
  long long sweeps() const { return batch_.sweeps(); }

 private:
  void refresh_stiffness(const PositionsView& x, const TermContext& context);
  void fill(const PositionsView& x, Projection projection, LocalTerms& out);
  void fill_sums(const TermContext& context, bool with_hessian);
  void fold();
  double stiffness_change() const;
  const auto& part() const {
    if constexpr (of_solids) {
      return scene_.solid_limit;
    } else {
      return scene_.limit;
    }
  }
  const StiffnessPolicy& policy() const {
    return of_solids ? *options_.solid_limit_stiffness : *options_.limit_stiffness;
  }
  /// Whether triangles have said their part of what is reported before.
  bool adds() const { return of_solids && !scene_.limit.triangles.empty(); }
  double smallest_gap(std::size_t e) const { return batch_.smallest_gap(e); }
  template <class Numbers>
  void say_state(Numbers& out) const;
  double force(std::size_t e, double gap) const;
  double load_max() const;
  std::string element_name(std::size_t e) const;
  double times_larger(std::size_t e, const PositionsView& others) const;

  const Scene& scene_;
  const TermOptions& options_;
  const std::vector<std::uint8_t>& fixed_;
  Batch batch_;
  Positions x_n_;
  StiffnessTime time_;
  /// kappa_e(y) (J) with its potential, as the batch asks a barrier: at all pseudo-gaps of every element.
  struct Folded {
    FoldedBarrier barrier;
    std::vector<KappaParts> parts;  // [N n] all of an element equal
    void eval(std::size_t n, const double* y, const double* width, double* s, double* ds, double* d2s) {
      barrier.eval(n, y, width, parts.data(), s, ds, d2s);
    }
  };
  std::optional<Folded> folded_;             // where kappa_e has a potential
  std::vector<KappaParts> parts_;            // [n] J
  std::vector<double> kappa_;                // [n] J, at the smaller pseudo-gap; 1 where folded_ has it
  std::vector<ElementSums<double>> sums_;    // [n]
  std::vector<double> smallest_gaps_;        // [n]
  std::vector<double> kappa_before_, hess_;  // [n] J, [(3 P)^2 n] N/m
  bool kappa_fresh_ = false, first_iterate_ = true;
  double kappa_change_ = 0;
};

using StrainLimitTerm = StrainLimitTermOf<StrainLimitBatch>;
using SolidLimitTerm = StrainLimitTermOf<SolidLimitBatch>;

}  // namespace bb
