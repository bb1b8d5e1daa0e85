// Whether a symmetric matrix is positive definite, and where it is not, a direction in which it curves downwards.
#pragma once

#include <cstdint>
#include <functional>

#include "core/linear/block_system.hpp"

namespace bb {

class Preconditioner;
class SymmetricProduct;
struct LinearReport;

struct Definiteness {
  enum class Verdict { positive, negative, unknown };
  Verdict verdict = Verdict::unknown;
  bool by_factor = false;  // positive: a Cholesky factor exists; else no iteration met negative curvature
  int factorizations = 0;  // that were made for it
  int iterations = 0;      // of conjugate gradients
  double curvature =
      0;            // negative: v^T A v / v^T v of the direction v; the smallest eigenvalue is not larger
  VecXd direction;  // negative: v
};

/// A positive definite matrix with the pattern of the one in question and close to it, made when it is requested.
using NearMatrix = std::function<const ReducedSystem&()>;

/// While all curvature met is positive, the part of the residual along a direction of negative curvature only grows, so
/// that a residual below b's own part there is impossible: no answer `positive` is wrong unless b has less than 1e-6 of
/// its length along the eigenvector, which a random b has with a probability of about 1e-6 sqrt(n).
inline constexpr double definiteness_tolerance = 1e-6;
/// Seeded, [n].
VecXd definiteness_right_hand_side(Eigen::Index n);

/// What conjugate gradients on that right-hand side b say, to that tolerance, on the host or on an executor: verdict and
/// iterations. direction and curvature are for the caller, from the last direction of the iterations.
Definiteness definiteness_of(const LinearReport& report);

/// By conjugate gradients on a seeded right-hand side b, until the residual is 1e-6 |b|. A direction that is found is
/// improved by Lanczos, at most 40 products. preconditioner: set up from a positive definite matrix.
Definiteness examine_by_gradients(const SymmetricProduct& a, const Preconditioner& preconditioner,
                                  int max_iterations);
Definiteness examine_by_gradients(const ReducedSystem& a, const Preconditioner& preconditioner,
                                  int max_iterations);

/// The same with a preconditioner that is set up from `near`. Unknown where it cannot be. rows: of an earlier matrix, whose
/// pattern is kept where it is still that one; afterwards of one of these two.
Definiteness examine_preconditioned(const ReducedSystem& a, const NearMatrix& near,
                                    Preconditioner& preconditioner, int max_iterations,
                                    SymmetricProduct& rows);

}  // namespace bb
