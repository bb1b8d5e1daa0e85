// Doubles as integers over one common power of two: the exact arithmetic behind every sign of the audit.
#pragma once

#include <gmpxx.h>

#include <span>
#include <vector>

namespace bb::audit {

/// Integers z_i with values_i = z_i 2^s for one s common to all: signs of homogeneous polynomials are
/// kept. Errors: none; values must be finite. Cost: O(n) allocations, meant for the rare pairs a
/// filter cannot settle.
std::vector<mpz_class> to_integers(std::span<const double> values);

}  // namespace bb::audit
