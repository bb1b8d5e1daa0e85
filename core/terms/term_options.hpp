// What a run chooses of its terms: barriers, stiffness, how contacts are computed. What differs between two
// runs of a comparison is here and in the rest of the method (core/newton/method.hpp).
#pragma once

#include <memory>
#include <string>

#include "core/barrier/shape.hpp"
#include "core/barrier/stiffness_policy.hpp"
#include "core/contact/contact_system.hpp"
#include "core/contact/contact_terms.hpp"
#include "core/energy/strain_stiffness.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// Stiffness of the strain limit, J per element.
struct LimitStiffness {
  enum class Kind { fixed, elasticity_inclusive };
  Kind kind = Kind::fixed;
  double k_s = 0;                        // N/m, fixed: kappa_e = k_s x rest area
  MassTerm mass_term = MassTerm::paper;  // elasticity_inclusive
  bool elastic_term = true;              // elasticity_inclusive
  Refresh refresh = Refresh::per_iteration;
  KappaDerivative derivative = KappaDerivative::dropped;  // included: refreshed per step
  double gap_floor = 0;   // of the width: the smallest y at which a kappa without potential is asked
  double multiplier = 1;  // the config's own factor times s of the matching rule

  /// What elasticity_inclusive asks of one element, in a step of length dt (s) and inertia weight c.
  StrainStiffnessRule rule(double dt, double c) const { return {mass_term, elastic_term, dt, c}; }
  bool has_potential() const {
    return kind == Kind::elasticity_inclusive && derivative == KappaDerivative::included;
  }
  bool needs_hessian() const { return kind == Kind::elasticity_inclusive && elastic_term; }
};

/// How two coefficients of friction make one.
enum class FrictionRule { min, max, mean };

struct FrictionOptions {
  std::string law = "smoothed_coulomb";  // of core/energy/friction_laws/registry.inc
  double mu = 0;                         // of bodies and obstacles that have none of their own
  FrictionRule combine = FrictionRule::min;
  int lag_iterations = 1;  // times that a step is solved, with loads of its start and of the ends before
  double eps_v = 1e-3;     // m/s, sliding speed from which the force is whole
};

struct TermOptions {
  BarrierFunction contact;
  std::unique_ptr<StiffnessPolicy> stiffness;
  Precision precision = Precision::full;  // of all terms; contact and limit have in_float set accordingly
  HessianMode hessian_mode = HessianMode::gauss_newton;
  ContactOptions contact_options;
  bool strain_limit = true;  // false: limits of the scene are left out
  BarrierFunction limit;
  LimitStiffness limit_stiffness;
  FrictionOptions friction;
};

}  // namespace bb
