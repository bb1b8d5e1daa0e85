// Stiffness policy `elasticity_inclusive`: kappa of each contact from its masses and its elastic Hessian, and kappa_e of
// each limited triangle. Everything that the policy is stands here: parameters, refusals, formula.
#pragma once

#include "core/barrier/stiffness_policy.hpp"
#include "core/math/host_device.hpp"

namespace bb {

enum class MassTerm { paper, inertia, scaled, none };  // docs/theory/barriers.md, Stiffness policies
/// What becomes of kappa'(d): left out of the curvature, kappa being a number, or included, the force kappa(d)
/// b'(d) being derived from its potential (core/barrier/folded_barrier.hpp).
enum class KappaDerivative { dropped, included };

/// kappa = w^T (M' + H) w/(w^T w) in N/m of a contact, w its weighted normals; kappa_e = w^T (M' + H) w in J of a
/// limited triangle, w its points from their centroid. H is the PSD elastic Hessian of the free vertices, off-diagonal
/// blocks included.
/// Source: Ando 2024, section on elasticity-inclusive stiffness; differs by: off-diagonal blocks of H kept as
/// in the published code, w over free vertices only, the mass terms inertia and scaled.
struct ElasticityInclusive {
  MassTerm mass_term = MassTerm::paper;
  bool elastic_term = true;  // whether H counts
  Refresh refresh = Refresh::per_iteration;
  double gap_floor = 0;  // in units of the width of the barrier
  KappaDerivative derivative = KappaDerivative::dropped;

  static constexpr const char* limit_doc = "kappa_e from the element's Hessian and mass";
  /// Each parameter once; what of it differs for a strain limit is read from the list.
  template <class List>
  static void describe(List& list) {
    using P = ElasticityInclusive;
    const bool limit = list.of_limit();  // which needs a mass: the last word is for contacts alone
    list.choice("mass_term", &P::mass_term, {"paper", "inertia", "scaled", "none"},
                limit ? "m_e/y^2 times 1 m^2/s^2, M/(c h^2), or M/(c h^2) (width/y)^2"
                      : "M/d^2 times 1 m^2/s^2, M/(c h^2), M/(c h^2) (d_hat/d)^2, or 0",
                limit ? 3 : 4);
    list.flag("elastic_term", &P::elastic_term, "whether the elastic Hessian counts");
    list.refresh(&P::refresh);
    // a pair that ended a step parked near contact would have m/d^2 of that gap in the next one
    list.fraction(
        "gap_floor", &P::gap_floor, "d_hat",
        "smallest gap at which kappa is evaluated, in units of d_hat, or of the width of a strain limit");
    list.choice("derivative", &P::derivative, {"dropped", "included"},
                "kappa'(d) left out of the curvature, or the force derived from its potential");
  }
  /// What does not go together.
  template <class Refuse>
  void check(Refuse& refuse) const {
    if (mass_term == MassTerm::none && !elastic_term) {
      refuse.all("mass_term none with elastic_term false", "at least one term, else kappa is 0");
    }
    if (derivative == KappaDerivative::dropped) return;
    if (!depends_on_gap()) {
      refuse("derivative",
             mass_term == MassTerm::none ? "\"included\" with mass_term none"
                                         : "\"included\" with mass_term inertia",
             "dropped, or mass_term paper or scaled: this kappa does not depend on the gap");
    }
    if (refresh != Refresh::per_step) {
      refuse("refresh", "\"per_iteration\"",
             "per_step, or derivative dropped: a potential is frozen for a step");
    }
    if (gap_floor > 0) {
      refuse("gap_floor", gap_floor, "0, or derivative dropped: a potential has no floor");
    }
  }

  bool needs_hessian() const { return elastic_term; }
  bool has_potential() const { return derivative == KappaDerivative::included; }
  /// Whether the mass term falls with the gap, as 1/d^2.
  bool depends_on_gap() const { return mass_term == MassTerm::paper || mass_term == MassTerm::scaled; }

  /// w^T M' w: what is the same at every gap, what counts over d^2 times 1 m^2/s^2 (the unit constant is the paper's:
  /// not invariant under a change of units), and what counts times (width/d)^2.
  template <class T>
  struct MassPart {
    T fixed = T(0), over_gap_sq = T(0), times_ratio_sq = T(0);
  };
  /// @param mass  w^T M w    @param paper  the mass that the paper puts over d^2
  template <class T>
  BB_HD MassPart<T> mass_part(T mass, T paper, const StiffnessTime& time) const {
    MassPart<T> out;
    if (mass_term == MassTerm::paper) out.over_gap_sq = paper;
    if (mass_term == MassTerm::inertia) out.fixed = time.inertia(mass);
    if (mass_term == MassTerm::scaled) out.times_ratio_sq = time.inertia(mass);
    return out;
  }

  /// kappa of a contact, N/m, at the gap d (m); d is read where the mass term depends on it.
  template <class T>
  BB_HD T contact_kappa(const ContactSums<T>& sums, T d, T d_hat, const StiffnessTime& time) const {
    const MassPart<T> part = mass_part(sums.mass, sums.mass, time);
    T mass = part.fixed;
    if (mass_term == MassTerm::paper) mass = part.over_gap_sq / (d * d);
    if (mass_term == MassTerm::scaled) mass = part.times_ratio_sq * (d_hat * d_hat / (d * d));
    return (mass + sums.elastic) / sums.w_sq;
  }
  /// The same as a function of the gap: at(d) is that kappa up to rounding.
  template <class T>
  BB_HD KappaPartsOf<T> contact_parts(const ContactSums<T>& sums, T d_hat, const StiffnessTime& time) const {
    return parts(mass_part(sums.mass, sums.mass, time), sums.elastic, sums.w_sq, d_hat, d_hat);
  }
  /// kappa_e of a limited triangle, J, as a function of its pseudo-gap.
  template <class T>
  BB_HD KappaPartsOf<T> element_parts(const ElementSums<T>& sums, T width, const StiffnessTime& time) const {
    return parts(mass_part(sums.mass, sums.element_mass, time), sums.elastic, T(1), width * width, T(1));
  }

 private:
  /// The square of the width is length times other_length, multiplied in this order: it is part of the results.
  template <class T>
  BB_HD static KappaPartsOf<T> parts(const MassPart<T>& mass, T elastic, T w_sq, T length, T other_length) {
    return {(elastic + mass.fixed) / w_sq,
            (mass.over_gap_sq + mass.times_ratio_sq * length * other_length) / w_sq};
  }
};

}  // namespace bb
