// The Poisson's ratios for which the energy of a model is bounded below and smallest at rest.
#pragma once

#include <string_view>

namespace bb {

struct PoissonRange {
  double from;                 // 1
  bool closed;                 // whether `from` itself is allowed
  std::string_view otherwise;  // what is wrong with the energy outside; empty where every material is inside

  constexpr bool contains(double poisson) const { return closed ? poisson >= from : poisson > from; }
  constexpr std::string_view relation() const { return closed ? ">=" : ">"; }
};

// What lines of registry.inc and solids.inc name.
inline constexpr PoissonRange any_poisson{-1, false, ""};
/// Two singular values of stable_neo_hookean: lambda has to be positive.
inline constexpr PoissonRange poisson_above_zero{
    0, false, "an equal stretch in all directions costs no energy at 0 and lowers it without bound below"};
/// Three of them: lambda > mu/3.
inline constexpr PoissonRange poisson_above_eighth{0.125, false, "its energy is not smallest at rest"};
/// baraff_witkin: lambda is the stiffness against shear.
inline constexpr PoissonRange poisson_from_zero{0, true, "shear lowers its energy without bound"};

}  // namespace bb
