// kappa of resident rows from iterate to iterate: what core/terms/stiffness_update.hpp does, pair by pair.
#pragma once

#include <span>

#include "core/contact/kappa_memory.hpp"
#include "core/resident/contact/compaction.hpp"
#include "core/resident/contact/stiffness_kernels.hpp"

namespace bb::resident {

/// The columns that rows need for a policy. Where the rule is uniform, its one kappa is in ResidentStiffness::set_uniform.
inline KappaColumns columns_of(const StiffnessRule& rule) {
  if (rule.uniform) return KappaColumns::uniform;
  if (rule.potential()) return KappaColumns::potential;
  return rule.refresh == Refresh::per_iteration ? KappaColumns::compared : KappaColumns::kept;
}

class ResidentStiffness {
 public:
  /// mass: [n_vertices] kg.
  ResidentStiffness(exec::Executor& executor, const StiffnessRule& rule, std::span<const double> mass);

  /// N/m, of all rows from now on.
  void set_uniform(double kappa) { uniform_kappa_ = kappa; }
  /// Step length (s) and inertia weight c.
  void set_time(double dt, double c) { dt_ = dt, c_ = c; }
  /// Forgets the kappa of the step before.
  void begin_step() { n_known_ = 0; }

  /// kappa of the rows of a Newton iterate. elastic: the elastic matrix H, read where needs_hessian(); a potential
  /// asks for that of the step's first iterate all through the step. @return the largest relative change of a
  /// row's kappa since its iterate was accepted; 0 where there is one kappa, or kappa is kept for the step.
  double refresh(ResidentRows& rows, const MatrixPart& elastic);
  /// kappa of the rows of a trial: known pairs keep theirs, new ones get the policy's at d = d_hat. iterate: rows of
  /// the last refresh, or those accepted since. Of a potential, what is new is known from then on.
  void freeze(ResidentRows& trial, ResidentRows& iterate, const MatrixPart& elastic);
  /// The pairs of an accepted trial keep their kappa for the rest of the step.
  void keep(ResidentRows& rows);

  const StiffnessRule& rule() const { return rule_; }
  Index n_known() const { return n_known_; }
  /// The pairs whose kappa is frozen for the step, copied to the host.
  KnownStiffness known() const;

 private:
  /// One kappa a pair and iterate: the rows of the iterate are the memory.
  bool rows_are_memory() const { return rule_.refresh == Refresh::per_iteration; }
  KnownPairs memory() const;
  void compute(ResidentRows& rows, const std::uint8_t* missing, bool at_d_hat, const MatrixPart& elastic);
  void recall_and_compute(ResidentRows& rows, const KnownPairs& known, bool at_d_hat,
                          const MatrixPart& elastic);

  exec::Executor& executor_;
  StiffnessRule rule_;
  double uniform_kappa_ = 0, dt_ = 0, c_ = 1;
  exec::Buffer<double> mass_;
  Compaction missing_;
  exec::Buffer<Key> known_pair_;
  exec::Buffer<double> known_kappa_, known_per_gap_;
  Index n_known_ = 0;
  exec::Buffer<Key> change_;
};

/// The gaps of pairs at two step ends, for policies that adapt between steps. Keeps the pairs of the last end.
class StepEndGaps {
 public:
  explicit StepEndGaps(exec::Executor& executor);
  /// Pairs that have a row now and had one at the end before, and whose gap shrank: no others count. park: ccd_park.
  std::vector<StiffnessPolicy::PairEnd> end_step(ResidentRows& rows, double park);
  /// The pairs of the last end and their gaps (m), ascending by pair: out, and back.
  void download(std::vector<Key>& pair, std::vector<double>& gap) const;
  void upload(const std::vector<Key>& pair, const std::vector<double>& gap);

 private:
  exec::Executor& executor_;
  exec::Buffer<Key> pair_;
  exec::Buffer<double> gap_;
  Compaction shrinking_;
};

}  // namespace bb::resident
