// What rows on lagged contacts (core/terms/lagged_family.hpp) take from the rows of contact of an executor, without a copy on the host,
// and where their forces and Hessians are summed.
#pragma once

#include "core/contact/executor/contact_pattern.hpp"
#include "core/contact/executor/lagged_kernels.hpp"
#include "core/terms/lagged_family.hpp"

namespace bb::exec {

class LaggedAssembly {
 public:
  /// columns: of the family; they outlive it.
  LaggedAssembly(Executor& executor, LaggedColumns& columns, int n_vertices);

  /// The columns become those of these rows, without loads. Errors: as ContactPattern::build.
  void take(ExecutorRows& rows);
  /// The loads become those that the rows carry, which were taken.
  void learn(const RowEnergy& contact);
  /// out [3 n_vertices] (N) += forces [3, n] of the rows.
  void add_forces(const double* force, PositionsSpan out);
  /// hess [6, n] N/m. Both triangles; valid until the next call.
  MatrixPart matrix(const double* hess);
  Index n_blocks() const { return pattern_.n_blocks(); }
  /// What an executor that only counts buffers is to take the rows for.
  void expect(const ExpectedContacts& expected) { pattern_.expect(expected); }

 private:
  Executor& executor_;
  LaggedColumns& columns_;
  Buffer<std::uint8_t> free_;  // [n] bit k: vertex k is free
  ContactPattern pattern_;
  Buffer<double> value_;
};

}  // namespace bb::exec
