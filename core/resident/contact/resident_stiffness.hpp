// kappa of resident rows from iterate to iterate: what core/terms/stiffness_update.hpp does, pair by pair.
#pragma once

#include <span>
#include <string>

#include "core/contact/kappa_memory.hpp"
#include "core/resident/contact/compaction.hpp"
#include "core/resident/contact/stiffness_kernels.hpp"

namespace bb::resident {

/// The columns that rows need for a policy. Where it is uniform, its one kappa is in ResidentStiffness::set_uniform.
inline KappaColumns columns_of(const StiffnessPolicy& policy) {
  if (policy.uniform()) return KappaColumns::uniform;
  if (policy.has_potential()) return KappaColumns::potential;
  return policy.refresh() == Refresh::per_iteration ? KappaColumns::compared : KappaColumns::kept;
}

/// Errors: ConfigError at `where` for a policy that has no kernel: one of a plugin.
void require_kernel(const StiffnessPolicy& policy, const std::string& where);

class ResidentStiffness {
 public:
  /// policy must outlive it. mass: [n_vertices] kg. Errors: those of require_kernel.
  ResidentStiffness(exec::Executor& executor, const StiffnessPolicy& policy, std::span<const double> mass);

  /// N/m, of all rows from now on.
  void set_uniform(double kappa) { uniform_kappa_ = kappa; }
  double uniform_kappa() const { return uniform_kappa_; }
  /// Step length (s) and inertia weight c.
  void set_time(const StiffnessTime& time) { time_ = time; }
  /// Forgets the kappa of the step before.
  void begin_step() { n_known_ = 0; }

  /// kappa of the rows of a Newton iterate. elastic: the elastic matrix H, read where the policy needs it; a potential
  /// asks for that of the step's first iterate all through the step.
  void refresh(ResidentRows& rows, const MatrixPart& elastic);
  /// The largest relative change of a row's kappa in the last refresh(), since its iterate was accepted; 0 where there is
  /// one kappa, or kappa is kept for the step. Waits.
  double change() const;
  /// kappa of the rows of a trial: known pairs keep theirs, new ones get the policy's at d = d_hat. iterate: rows of
  /// the last refresh, or those accepted since. Of a potential, what is new is known from then on.
  void freeze(ResidentRows& trial, ResidentRows& iterate, const MatrixPart& elastic);
  /// The pairs of an accepted trial keep their kappa for the rest of the step.
  void keep(ResidentRows& rows);

  Index n_known() const { return n_known_; }
  /// The pairs whose kappa is frozen for the step, copied to the host.
  KnownStiffness known() const;

 private:
  /// One kappa a pair and iterate: the rows of the iterate are the memory.
  bool rows_are_memory() const { return !policy_.frozen_in_step(); }
  KnownPairs memory() const;
  void compute(ResidentRows& rows, const std::uint8_t* missing, bool at_d_hat, const MatrixPart& elastic);
  void recall_and_compute(ResidentRows& rows, const KnownPairs& known, bool at_d_hat,
                          const MatrixPart& elastic);

  exec::Executor& executor_;
  const StiffnessPolicy& policy_;
  double uniform_kappa_ = 0;
  StiffnessTime time_;
  exec::Buffer<double> mass_;
  Compaction missing_;
  exec::Buffer<Key> known_pair_;
  exec::Buffer<double> known_kappa_, known_per_gap_;
  Index n_known_ = 0;
  exec::Reading<Key> change_;
  bool compares_ = false;  // change_ is that of the last refresh()
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
