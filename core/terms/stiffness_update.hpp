// Feeds the contact table to the stiffness policy: when kappa is refreshed, kept, or given to a row that
// appears during a line search (docs/design.md). Knows no policy by name.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/barrier/relative_change.hpp"
#include "core/barrier/stiffness_policy.hpp"
#include "core/contact/kappa_memory.hpp"
#include "core/linear/block_system.hpp"

namespace bb {

/// Owned columns behind a StiffnessBatch; reused, so no allocation once they have grown.
struct PolicyColumns {
  std::vector<int> n_free;
  std::vector<double> weight, normal, d, d_hat, mass, hessian;
  StiffnessBatch batch(const StiffnessTime& time, bool with_hessian) const;
};

class StiffnessUpdate {
 public:
  /// policy must outlive this object. mass: [n_vertices] kg. kappa of a row is that of the policy times its share, where
  /// rows have one.
  StiffnessUpdate(StiffnessPolicy& policy, std::span<const double> mass);

  /// Forgets the kappa and the H of the step before.
  void begin_step();
  /// Step length (s) and inertia weight c that policies read.
  void set_time(const StiffnessTime& time) {
    time_ = time;
    policy_.set_time(time);
  }

  /// kappa of the rows of a Newton iterate. elastic: values of the elastic matrix H, read only when the
  /// policy needs it. per_iteration computes every row anew; per_step keeps the first value that a pair had
  /// in this step; a policy with a potential reads the H of the step's first iterate all through it. Returns the largest relative_change of a row's kappa against its kappa_before; 0 where
  /// the policy gives all rows one kappa or keeps it for the step.
  double refresh(ContactTable& rows, MollifiedTable& mollified, const BlockSystem& blocks,
                 const BlockSystem::Values& elastic);

  /// kappa of the rows of a trial state: known pairs keep theirs, new ones get the policy's value at d =
  /// d_hat with the same H, so that kappa does not depend on the trial. Writes kappa_before too: what is
  /// known of a trial stays in its own rows. Only of a policy with a potential a new pair is known from then on,
  /// whether the trial is accepted or not: its weights belong to the state where it was first met, and E has to
  /// be one function of x for the rest of the step.
  void freeze(ContactTable& rows, MollifiedTable& mollified, const BlockSystem& blocks,
              const BlockSystem::Values& elastic);

  /// The pairs of an accepted trial keep their kappa for the rest of the step.
  void keep(const ContactTable& rows, const MollifiedTable& mollified);

  /// The kappa that pairs have in the step that another system is in. After begin_step().
  void adopt(const KnownStiffness& known) { memory_.adopt(known); }
  const KnownStiffness& known() const { return memory_.known(); }

  StiffnessPolicy& policy() { return policy_; }

  /// Columns of one row as the policy sees it (for matching at the contact that carried the load).
  PolicyColumns columns(const ContactTable& rows, int row, const BlockSystem& blocks,
                        const BlockSystem::Values& elastic);

 private:
  void fill_missing(ContactTable& rows, MollifiedTable& mollified, const BlockSystem& blocks,
                    const BlockSystem::Values& elastic, bool at_d_hat);
  /// Where sub-matrices of H come from; without values none are read.
  struct Hessian {
    const BlockSystem& blocks;
    const BlockSystem::Values* values = nullptr;
    bool of_elements = false;  // values as element_values() has them
    void submatrix(const int* vertices, int k, double* out) const;
  };
  template <class Table>
  void gather(const Table& table, std::span<const int> rows, const Hessian& hessian, bool at_d_hat);
  /// Of the iterate, or for a policy with a potential of the step's first one.
  Hessian hessian_of(const BlockSystem& blocks, const BlockSystem::Values& elastic);
  template <class Table>
  void fill(Table& table, std::span<const int> rows, const Hessian& hessian, bool at_d_hat);

  StiffnessPolicy& policy_;
  std::span<const double> mass_;
  StiffnessTime time_;
  KappaMemory memory_;
  PolicyColumns columns_;
  std::vector<int> missing_, missing_mollified_;
  std::vector<double> kappa_;
  std::vector<KappaParts> parts_;
  BlockSystem::Values step_elastic_;  // H of the step's first iterate, as element_values() has it
  bool has_step_elastic_ = false;
};

}  // namespace bb
