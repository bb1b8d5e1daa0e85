// Local energies, gradients and Hessians of the rows, from the columns of the tables alone.
#pragma once

#include <vector>

#include "core/contact/contact_table.hpp"
#include "core/contact/gap_along.hpp"
#include "core/math/precision.hpp"
#include "core/math/projection.hpp"

namespace bb {

/// What the Hessian of a row holds, and how it is projected: kappa b'' n n^T alone; with grad^2 d, projected in the at
/// most five directions in which it is not zero; the same matrix, projected from its 12 x 12 numbers alone
/// (numeric_projection.hpp): what projections that know a contact are measured against.
enum class HessianMode {
  gauss_newton,
  projected_full,
  projected_numeric,
  projected_lapack,
  projected_low_rank
};
constexpr bool is_numeric(HessianMode mode) { return mode >= HessianMode::projected_numeric; }

/// Local gradients [12 n] and Hessians [90 n, lower blocks of 4 points] of the rows on the compact free
/// slots (slots beyond n_free are 0), from kappa, b', b'' in the table: kappa b' w_i n and kappa b'' w_i
/// w_j n n^T, plus kappa b' grad^2 d in the other modes. The block of a row's free points is projected;
/// without grad^2 d it is positive semi-definite as it is. x: [3 x n]. precision: the scalars of either. Resizes the outputs, no other
/// allocation.
void contact_terms(const ContactTable& rows, const PositionsView& x, HessianMode mode, Projection projection,
                   std::vector<double>& grad, std::vector<double>& hess,
                   Precision precision = Precision::full);
void mollified_terms(const MollifiedTable& rows, const PositionsView& x, Projection projection,
                     std::vector<double>& grad, std::vector<double>& hess,
                     Precision precision = Precision::full);
/// Adds to the free columns of `force` [3 x n] (N) how the gradient of B at x changes, to first order, when
/// its prescribed vertices move by `motion` [3 x n] (m, 0 at free vertices): they have no block in the matrix.
/// Rows of both tables count; a ContactTable's by kappa b'' w_i w_j n n^T in either Hessian mode, a
/// mollified row's by its whole Hessian. From kappa, b', b'' in the tables. Cost O(rows).
void add_given_motion(const ContactTable& rows, const PositionsView& motion, PositionsSpan force);
void add_given_motion(const MollifiedTable& rows, const PositionsView& x, const PositionsView& motion,
                      PositionsSpan force);
/// Adds to `force` [3 x n] (N) kappa b'' w_i n times what the gap of every row misses (gap_along.hpp) along dx
/// [3 x n] (m, 0 at prescribed vertices): with it on the right-hand side of Newton's system the gaps at x + dx are those
/// that their slopes say. Rows without mollifier alone. Returns when they hold dx. From kappa and b'' in the table, in
/// double. Cost O(rows).
HoldTimes add_curvature_correction(const ContactTable& rows, const PositionsView& x, const PositionsView& dx,
                                   PositionsSpan force);
/// The mollifier e of row r at x, in double.
double mollifier_of(const MollifiedTable& rows, std::size_t r, const PositionsView& x);
/// Gradient of kappa e b in the four points of row r as they stand in its stencil, in double, N; 0 at those of an axis.
Vec<double, 12> mollified_gradient(const MollifiedTable& rows, std::size_t r, const PositionsView& x);
/// Energies kappa b (and kappa e b) of every row, J.
void contact_energies(const ContactTable& rows, std::vector<double>& energy,
                      Precision precision = Precision::full);
void mollified_energies(const MollifiedTable& rows, const PositionsView& x, std::vector<double>& energy,
                        Precision precision = Precision::full);

}  // namespace bb
