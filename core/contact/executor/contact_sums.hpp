// The few numbers that leave the rows: energies, and what the policy ipc_adaptive starts from.
#pragma once

#include "core/contact/executor/contact_assembly.hpp"
#include "core/contact/executor/sum_kernels.hpp"
#include "core/exec/sums/executor_sum.hpp"

namespace bb::exec {

class RowSums {
 public:
  explicit RowSums(Executor& executor) : sum_(executor), energy_(executor) {}

  /// Energy of all rows at x, J. Sums of two tables are compared as sums: rows come and go.
  Compensated energy(ExecutorRows& rows, const PositionsView& x, ContactAssembly& assembly) {
    look_at_energy(rows, x, assembly);
    return energy();
  }
  /// The same in two calls: a launch, and what it found.
  void look_at_energy(ExecutorRows& rows, const PositionsView& x, ContactAssembly& assembly);
  Compensated energy() const { return energy_.get(); }
  /// a . b over free degrees of freedom; both [3 n_vertices], fixed: 3 bits a vertex.
  double product(const PositionsView& a, const PositionsView& b, const Buffer<std::uint8_t>& fixed);
  /// Mean mass of the free vertices of the rows, counted once a row, kg. Requires rows.
  double mean_mass(ExecutorRows& rows, const Buffer<double>& mass);

 private:
  template <class Parts>
  Compensated sum(Index n, const Parts& parts);

  ExecutorSum sum_, energy_;
};

}  // namespace bb::exec
