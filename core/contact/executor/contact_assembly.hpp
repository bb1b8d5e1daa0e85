// From rows to gradient, matrix and the force of a given motion.
#pragma once

#include "core/contact/executor/contact_pattern.hpp"
#include "core/contact/executor/executor_surface.hpp"
#include "core/contact/executor/sum_kernels.hpp"
#include "core/contact/executor/term_kernels.hpp"
#include "core/linear/executor/executor_matrix.hpp"

namespace bb::exec {

struct AssemblyOptions {
  Index pairs_a_chunk = Index{1} << 26;  // of the pattern's sorts
  Index hessians_a_chunk = 1 << 18;      // rows whose Hessians are kept at a time, 720 B each
};

/// Sums over rows whose energy, force and stiffness are set. Results do not depend on the chunks.
class ContactAssembly {
 public:
  /// surface must outlive it.
  ContactAssembly(Executor& executor, const ExecutorSurface& surface, int n_vertices,
                  const AssemblyOptions& options = {});

  /// For the rows of an iterate: slots and, with blocks, the pattern of the matrix. Skip it while the stencils are the
  /// same (RowFinder::same()). Errors: as ContactPattern::build.
  void set_pattern(ExecutorRows& rows, bool blocks = true);

  /// gradient [3 n_vertices] (N) += that of B at x.
  void add_gradient(ExecutorRows& rows, const PositionsView& x, PositionsSpan gradient);
  /// The Hessian of B at x, both triangles; valid until the next call. Errors: std::invalid_argument for the
  /// modes that project numerically, which have no kernel.
  MatrixPart matrix(ExecutorRows& rows, const PositionsView& x, const HessianChoice& choice);
  Index n_blocks() const { return pattern_.n_blocks(); }
  /// force [3 n_vertices] (N) += how the gradient changes along motion [3 n_vertices] (m, 0 at free vertices).
  void add_given_motion(ExecutorRows& rows, const PositionsView& x, const PositionsView& motion,
                        PositionsSpan force);
  /// Energies of the rows at x: parts of a sum.
  RowEnergy row_energy(ExecutorRows& rows, const PositionsView& x);

  /// Gives back values and scratch memory of matrix().
  void free_matrix() { row_hessians_.free(), value_.free(); }
  /// What an executor that only counts buffers is to take the rows for.
  void expect(const ExpectedContacts& expected) { pattern_.expect(expected); }

  const ContactPattern& pattern() const { return pattern_; }

 private:
  void mollify(ExecutorRows& rows, const PositionsView& x);
  template <class Term>
  void gather(ExecutorRows& rows, const Term& term, PositionsSpan out);
  void add_hessians(ExecutorRows& rows, const PositionsView& x, const HessianChoice& choice);

  Executor& executor_;
  const ExecutorSurface& surface_;
  AssemblyOptions options_;
  ContactPattern pattern_;
  Buffer<double> mollified_, mollifier_;  // [12][mollified], [mollified]
  Buffer<double> row_hessians_, value_;
};

}  // namespace bb::exec
