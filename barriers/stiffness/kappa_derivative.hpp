// What becomes of kappa'(d) where kappa depends on the gap.
#pragma once

namespace bb {

/// Left out of the curvature, kappa being a number, or included, the force kappa(d) b'(d) being derived from its potential
/// (core/barrier/folded_barrier.hpp, core/barrier/gap_potential.hpp).
enum class KappaDerivative { dropped, included };

}  // namespace bb
