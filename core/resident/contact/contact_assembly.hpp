// From rows to gradient, matrix and the force of a given motion.
#pragma once

#include "core/linear/executor/resident_matrix.hpp"
#include "core/resident/contact/contact_pattern.hpp"
#include "core/resident/contact/resident_surface.hpp"
#include "core/resident/contact/sum_kernels.hpp"
#include "core/resident/contact/term_kernels.hpp"

namespace bb::resident {

struct AssemblyOptions {
  Index pairs_a_chunk = Index{1} << 26;  // of the pattern's sorts
  Index hessians_a_chunk = 1 << 18;      // rows whose Hessians are kept at a time, 720 B each
};

/// Sums over rows whose energy, force and stiffness are set. Results do not depend on the chunks.
class ContactAssembly {
 public:
  /// surface must outlive it.
  ContactAssembly(exec::Executor& executor, const ResidentSurface& surface, int n_vertices,
                  const AssemblyOptions& options = {});

  /// For the rows of an iterate: slots and, with blocks, the pattern of the matrix. Skip it while the stencils are the
  /// same (RowFinder::same()). Errors: as ContactPattern::build.
  void set_pattern(ResidentRows& rows, bool blocks = true);

  /// gradient [3 n_vertices] (N) += that of B at x.
  void add_gradient(ResidentRows& rows, const PositionsView& x, PositionsSpan gradient);
  /// The Hessian of B at x, both triangles; valid until the next call. Errors: std::invalid_argument for the
  /// modes that project numerically, which have no kernel.
  MatrixPart matrix(ResidentRows& rows, const PositionsView& x, const HessianChoice& choice);
  Index n_blocks() const { return pattern_.n_blocks(); }
  /// force [3 n_vertices] (N) += how the gradient changes along motion [3 n_vertices] (m, 0 at free vertices).
  void add_given_motion(ResidentRows& rows, const PositionsView& x, const PositionsView& motion,
                        PositionsSpan force);
  /// Energies of the rows at x: parts of a sum.
  RowEnergy row_energy(ResidentRows& rows, const PositionsView& x);

  /// Gives back values and scratch memory of matrix().
  void free_matrix() { row_hessians_.free(), value_.free(); }
  /// What an executor that only counts buffers is to take the rows for.
  void expect(const ExpectedContacts& expected) { pattern_.expect(expected); }

  const ContactPattern& pattern() const { return pattern_; }

 private:
  void mollify(ResidentRows& rows, const PositionsView& x);
  template <class Term>
  void gather(ResidentRows& rows, const Term& term, PositionsSpan out);
  void add_hessians(ResidentRows& rows, const PositionsView& x, const HessianChoice& choice);

  exec::Executor& executor_;
  const ResidentSurface& surface_;
  AssemblyOptions options_;
  ContactPattern pattern_;
  exec::Buffer<double> mollified_, mollifier_;  // [12][mollified], [mollified]
  exec::Buffer<double> row_hessians_, value_;
};

}  // namespace bb::resident
