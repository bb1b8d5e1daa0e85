// The few numbers that leave the rows: energies, and what the policy ipc_adaptive starts from.
#pragma once

#include "core/exec/sums/resident_sum.hpp"
#include "core/resident/contact/contact_assembly.hpp"
#include "core/resident/contact/sum_kernels.hpp"

namespace bb::resident {

class RowSums {
 public:
  explicit RowSums(exec::Executor& executor) : sum_(executor), energy_(executor) {}

  /// Energy of all rows at x, J. Sums of two tables are compared as sums: rows come and go.
  Compensated energy(ResidentRows& rows, const PositionsView& x, ContactAssembly& assembly) {
    look_at_energy(rows, x, assembly);
    return energy();
  }
  /// The same in two calls: a launch, and what it found.
  void look_at_energy(ResidentRows& rows, const PositionsView& x, ContactAssembly& assembly);
  Compensated energy() const { return energy_.get(); }
  /// a . b over free degrees of freedom; both [3 n_vertices], fixed: 3 bits a vertex.
  double product(const PositionsView& a, const PositionsView& b, const exec::Buffer<std::uint8_t>& fixed);
  /// Mean mass of the free vertices of the rows, counted once a row, kg. Requires rows.
  double mean_mass(ResidentRows& rows, const exec::Buffer<double>& mass);

 private:
  template <class Parts>
  Compensated sum(Index n, const Parts& parts);

  ResidentSum sum_, energy_;
};

}  // namespace bb::resident
