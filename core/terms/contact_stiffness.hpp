// kappa of the contact tables of the host: a StiffnessUpdate, with the columns that a policy reads of new rows and the matrix as
// blocks of the host's system.
#pragma once

#include <span>
#include <vector>

#include "core/contact/contact_table.hpp"
#include "core/contact/stiffness_update.hpp"
#include "core/linear/block_system.hpp"

namespace bb {

/// Owned columns behind a StiffnessBatch; reused, so no allocation once they have grown.
struct PolicyColumns {
  std::vector<int> n_free;
  std::vector<double> weight, normal, d, d_hat, mass, hessian;
  StiffnessBatch batch(const StiffnessTime& time, bool with_hessian) const;
};

/// Rows of one state.
struct ContactTables {
  ContactTable& rows;
  MollifiedTable& mollified;
};

class ContactStiffness {
 public:
  /// All outlive this object; the executor is in the host's memory. mass: [n_vertices] kg. kappa of a row is that of the policy
  /// times its share, where rows have one.
  ContactStiffness(exec::Executor& executor, StiffnessPolicy& policy, std::span<const double> mass)
      : policy_(policy), mass_(mass), update_(executor, policy) {}

  void begin_step() { update_.begin_step(); }
  /// Step length (s) and inertia weight c that a policy reads beside its rows.
  void set_time(const StiffnessTime& time) { time_ = time; }

  // --- as those of StiffnessUpdate. elastic: values of the elastic matrix H, read only when the policy needs it
  /// Returns StiffnessUpdate::change().
  double refresh(const ContactTables& rows, const BlockSystem& blocks, const BlockSystem::Values& elastic);
  void freeze(const ContactTables& trial, const ContactTables& iterate, const BlockSystem& blocks,
              const BlockSystem::Values& elastic);
  void keep(const ContactTables& rows);
  void adopt(const KnownStiffness& known) { update_.adopt(known); }
  KnownStiffness known() const { return update_.known(); }

  /// Columns of one row as the policy sees it (for matching at the contact that carried the load).
  PolicyColumns columns(const ContactTable& rows, int row, const BlockSystem& blocks,
                        const BlockSystem::Values& elastic);

 private:
  /// Where sub-matrices of H come from; without values none are read.
  struct Hessian {
    const BlockSystem& blocks;
    const BlockSystem::Values* values = nullptr;
    bool of_elements = false;  // values as element_values() has them
    void submatrix(const int* vertices, int k, double* out) const;
  };
  /// A StiffnessUpdate::Compute, handed over by reference so that nothing is allocated.
  struct Fill {
    ContactStiffness& of;
    ContactTables rows;
    Hessian hessian;
    void operator()(std::size_t table, const std::uint8_t* missing, bool at_d_hat) const;
  };
  /// Of the iterate, or for a policy with a potential of the step's first one.
  Hessian hessian_of(const BlockSystem& blocks, const BlockSystem::Values& elastic);
  template <class Table>
  void gather(const Table& table, std::span<const int> rows, const Hessian& hessian, bool at_d_hat);
  template <class Table>
  void fill(Table& table, const std::uint8_t* missing, const Hessian& hessian, bool at_d_hat);
  /// kappa of the rows where it is no function of their parts alone.
  void fill_kappa(const ContactTables& rows) const;

  StiffnessPolicy& policy_;
  std::span<const double> mass_;
  StiffnessTime time_;
  StiffnessUpdate update_;
  PolicyColumns columns_;
  std::vector<int> listed_;
  std::vector<double> kappa_;
  std::vector<KappaParts> parts_;
  BlockSystem::Values step_elastic_;  // H of the step's first iterate, as element_values() has it
};

}  // namespace bb
