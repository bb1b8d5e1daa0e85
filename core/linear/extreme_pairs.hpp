// The two ends of the spectrum of B = L^-1 A L^-T by solves and products: the estimators inverse_power, spectra and lanczos of the condition
// estimate. The factor of A serves every scaling, since B^-1 = L^T A^-1 L.
#pragma once

#include "core/linear/block_scaling.hpp"
#include "core/linear/cholmod_factor.hpp"
#include "core/linear/condition.hpp"
#include "core/linear/symmetric_product.hpp"

namespace bb {

/// What the estimator holds for one matrix.
struct FactoredMatrix {
  const ReducedSystem* system = nullptr;  // every diagonal entry stored
  SymmetricProduct product;
  CholmodFactor factor;   // of A
  bool positive = false;  // the factorisation succeeded
  CholmodFactor shifted;  // of +-(A - sigma D), proofs and shifts
  ReducedSystem shifted_system;
};

/// inverse_power: four inverse-power steps and twenty Lanczos products. Both ends from inside the spectrum:
/// lambda_min by a Rayleigh quotient in long double, lambda_max a Ritz value lowered by its rounding.
ConditionEstimate estimate_inverse_power(FactoredMatrix& matrix, const BlockScaling& scaling,
                                         std::uint64_t seed);

/// spectra and lanczos: Spectra's solvers, or Lanczos with full reorthogonalisation of our own, on B and on B^-1. Ours takes
/// over for an end that Spectra leaves unresolved within its budget, and for a matrix without a factor. A factorisation
/// shifted just beyond each end proves that nothing lies there; an end that stays unresolved or is disproven is
/// shifted to.
ConditionEstimate estimate_ends(FactoredMatrix& matrix, const BlockScaling& scaling,
                                const ConditionOptions& options);

/// cond and status from both ends; `resolved` is false where an end is only a bound.
/// Above 1e14 cond is 1e14 and the status lower_bound; below the rounding of the entries of A it is singular.
void classify(ConditionEstimate& estimate, bool resolved);

}  // namespace bb
