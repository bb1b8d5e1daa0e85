// Matrices of the tests: known spectra, grids, and dense matrices as reduced systems.
#pragma once

#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "core/linear/block_system.hpp"

namespace bb {

/// Blocks of 3 degrees of freedom, the last one smaller when n is not a multiple.
ReducedSystem from_sparse(const Eigen::SparseMatrix<double>& a, std::uint64_t id = 0);
ReducedSystem from_dense(const Eigen::MatrixXd& a, std::uint64_t id = 0);
Eigen::MatrixXd dense(const ReducedSystem& system);

/// Q diag(spectrum) Q^T, dense, Q of four random reflections; computed in long double, rounded once.
Eigen::MatrixXd with_spectrum(const VecXd& spectrum, unsigned seed);
/// The same, sparse: three layers of random plane rotations.
Eigen::SparseMatrix<double> sparse_with_spectrum(const VecXd& spectrum, unsigned seed);

/// Spectra from 1 / cond to 1, by name.
VecXd spectrum(const std::string& kind, int n, double cond, unsigned seed = 5);
const std::vector<std::string>& spectrum_kinds();

/// A well-conditioned symmetric positive definite sparse matrix: a grid of m x m vertices with
/// 3 unknowns each.
ReducedSystem grid_system(int m, double diagonal, std::uint64_t id = 0);

/// Such a grid whose second half is tied to the first by springs between opposite vertices.
ReducedSystem folded_grid(int m, double stiffness);

VecXd random_vector(Eigen::Index n, unsigned seed);

}  // namespace bb
