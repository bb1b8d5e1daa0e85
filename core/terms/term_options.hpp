// What a run chooses of its terms: barriers, stiffness, how contacts are computed. What differs between two
// runs of a comparison is here and in the rest of the method (core/newton/method.hpp).
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/barrier/shape.hpp"
#include "core/barrier/stiffness_policy.hpp"
#include "core/contact/combine_rule.hpp"
#include "core/contact/contact_system.hpp"
#include "core/contact/contact_terms.hpp"
#include "core/math/precision.hpp"
#include "core/terms/barrier_multipliers.hpp"
#include "core/terms/contact_multipliers.hpp"

namespace bb {

/// exact: the second derivatives. adaptive: a share of the secant (core/energy/friction.hpp) after steps that the line search
/// shortened. secant: all of it always, where nothing requests the exact one.
enum class FrictionHessian { exact, adaptive, secant };

/// When friction takes rows and loads from contact: when a step begins (and converges, lag_iterations), or at every iterate.
enum class FrictionRefresh { per_step, per_iteration };

struct FrictionOptions {
  std::string law = "smoothed_coulomb";  // of core/energy/friction_laws/registry.inc
  double mu = 0;                         // of bodies and obstacles that have none of their own
  std::optional<double> mu_static =
      {};  // the same, while they stick; none: mu. Of laws with two coefficients
  CombineRule combine = CombineRule::min;
  int lag_iterations = 1;  // times that a step is solved, with loads of its start and of the ends before
  double eps_v = 1e-3;     // m/s, sliding speed from which the force is whole
  std::optional<double> eps_m = {};  // m, the slide of a step itself, in the place of eps_v times its length
  std::optional<double> kinetic_v = {};                 // m/s, > eps_v, from which the coefficient is mu
  FrictionHessian hessian = FrictionHessian::adaptive;  // of step solvers with a line search on E
  FrictionRefresh refresh = FrictionRefresh::per_step;
};

/// m, the slides of a step of dt (s) from which the force is whole, and from which a law with two coefficients has the kinetic one.
inline double whole_slide(const FrictionOptions& of, double dt) { return of.eps_m.value_or(of.eps_v * dt); }
inline double kinetic_slide(const FrictionOptions& of, double dt) {
  return of.kinetic_v ? *of.kinetic_v * dt : 10 * whole_slide(of, dt);
}

/// Contact without a barrier (core/terms/linear_contact.hpp).
struct LinearContactRules {
  double standoff = 0.1;         // d_hat of the pair, gap that constraints require
  double penalty = 0;            // N/m; 0: set_penalty()
  double recovery_speed = 0.01;  // m/s, at which a gap comes back to its standoff
  double decay = 0.9;            // of the weight of a constraint that is not active, an update
  double least_weight = 0.01;    // below which it goes
  double advance = 0.9;          // part of the way to the first contact that is gone
  double stall_time = 1e-4;      // smaller advances count as none
  int stall_updates = 50;        // that many of them in a row double the penalty and halve the standoff
};

struct TermOptions {
  BarrierFunction contact;
  bool overlap =
      false;  // states with d <= 0 are feasible; contact goes on there by the formula of its bounded shape
  std::optional<MultiplierRules> multipliers;                 // of contact, in the place of its barrier
  std::optional<BarrierMultiplierRules> barrier_multipliers;  // of contact, beside its barrier
  std::optional<LinearContactRules> linear_contact;           // in the place of all of contact
  std::unique_ptr<StiffnessPolicy> stiffness;
  Precision precision = Precision::full;  // of all terms; contact and limit have in_float set accordingly
  HessianMode hessian_mode = HessianMode::gauss_newton;
  ContactOptions contact_options;
  bool strain_limit = true;  // false: limits of the scene are left out, those of solids too
  BarrierFunction limit;
  std::unique_ptr<StiffnessPolicy> limit_stiffness;  // of the elements; read where a triangle has a limit
  std::unique_ptr<StiffnessPolicy> solid_limit_stiffness;  // the same of tetrahedra
  FrictionOptions friction;
};

}  // namespace bb
