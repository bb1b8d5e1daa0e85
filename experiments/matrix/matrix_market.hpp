// Symmetric matrices as Matrix Market text: what is written is read back bit for bit.
#pragma once

#include <Eigen/SparseCore>
#include <string>

namespace bb {

/// "coordinate real symmetric": the lower triangle, column by column, every number in the fewest digits that
/// give the same double again. Stored zeros stay entries.
std::string matrix_market_text(const Eigen::SparseMatrix<double>& lower);

/// What |A_ij - A_ji| may be in a file that holds both triangles, relative to the largest entry: what a
/// summation in another order leaves. The mean of the two is taken.
inline constexpr double symmetry_tolerance = 1e-10;

/// The lower triangle of a matrix given as `coordinate real symmetric` (lower triangle) or `coordinate real
/// general` (both); `integer` is read as real.
/// @param name  of the file, for messages
/// Errors: ConfigError with file and line for another banner, a matrix that is empty, not square or not
/// symmetric, an entry that is not a finite number, an index outside the matrix or above the diagonal of a
/// symmetric file, an entry that is there twice, fewer or more entries than announced.
Eigen::SparseMatrix<double> parse_matrix_market(const std::string& text, const std::string& name);

}  // namespace bb
