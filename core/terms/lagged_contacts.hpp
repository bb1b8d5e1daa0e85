// What terms have in common that act on the contacts of one state with the loads that these carry there: friction, restitution
// (docs/design.md). Which contacts and how much is taken at the start of a step, so that E stays one function of x within it.
#pragma once

#include <vector>

#include "core/contact/contact_loads.hpp"
#include "core/energy/element_loop.hpp"
#include "core/energy/friction.hpp"
#include "core/terms/known_step.hpp"
#include "core/terms/term.hpp"

namespace bb {

/// One element a contact whose coefficient is not 0, on the vertices of the contact. Its energy is a function of the motion
/// sum w_i (x_i - x_i^n), w_i those of the contact.
class LaggedContacts : public Term {
 public:
  TermGroup group() const final { return TermGroup::friction; }
  Phase phase() const final { return Phase::contact_terms; }
  bool fixed_stencils() const final { return false; }
  void adopt(const KnownStep& known) final;
  void adopt_from(const Term& other) override;
  void change(const PositionsView& x0, const PositionsView& x1, EnergyParts& out) const final;

 protected:
  /// All arguments outlive the term. before: the terms whose contacts are meant.
  LaggedContacts(const Scene& scene, Precision precision, const TermList& before);

  /// Of contact r of contacts(), 1; 0: it is left out.
  virtual double coefficient(std::size_t r) const = 0;
  /// strength is the coefficient times the load of each element now.
  virtual void loads_are_known(std::vector<double>& /*strength*/) {}

  /// The rows are those of another system's step, taken from its state at the time t (s).
  virtual void lag_is_adopted(double /*t*/) {}

  /// The step begins at x_n: motions are counted from there.
  void begin_at(const Positions& x_n) { x_n_ = x_n; }
  /// Elements are those of x, where the terms before hold their contacts; the loads are known once these have been linearised.
  void take_rows(const PositionsView& x);
  /// Requires the terms before to have been linearised where the rows are of. Errors: std::logic_error where they hold others.
  void learn_loads();
  bool loads_known() const { return loads_known_; }

  const ContactLoads& contacts() const { return contacts_; }
  const Positions& lagged() const { return lagged_; }  // m, where they are of
  std::size_t contact(std::size_t e) const { return row_[e]; }
  /// N times the unit of 1 over the coefficient.
  double strength(std::size_t e) const { return strength_[e]; }
  /// N, of the contact itself.
  double load(std::size_t e) const { return contacts_.load[row_[e]]; }
  template <class T>
  Vec<T, 3> normal(std::size_t e) const {
    return Vec3d::Map(&contacts_.normal[3 * row_[e]]).template cast<T>();
  }
  /// m.
  template <class T>
  Vec<T, 3> motion(std::size_t e, const PositionsView& x) const {
    const std::size_t first = 4 * row_[e];
    Vec<T, 3> out = Vec<T, 3>::Zero();
    for (std::size_t k = first; k < first + 4 && contacts_.stencil[k] >= 0; ++k) {
      const int v = contacts_.stencil[k];
      out += static_cast<T>(contacts_.weight[k]) * (x.col(v) - x_n_.col(v)).template cast<T>();
    }
    return out;
  }

  /// Energies, gradients and Hessians of all elements. terms(e): the MotionTerms<T> of one in its motion.
  template <class T, class Terms>
  void store_motion_terms(PassParts parts, const Terms& terms) {
    for_each_element(size(), [&](std::size_t e) {
      const Vec<T, 4> weight = Vec<double, 4>::Map(&contacts_.weight[4 * row_[e]]).template cast<T>();
      store_terms<T, 12>(motion_in_points<T, 4>(terms(e), weight), e, parts, families_[0].local);
    });
  }
  /// energy(e), J.
  template <class Energy>
  void store_trial(const Energy& energy) {
    for_each_element(size(), [&](std::size_t e) { families_[0].trial_energy[e] = energy(e); });
  }

  const Scene& scene() const { return scene_; }
  Precision precision() const { return precision_; }

 private:
  ContactLoads contacts_now() const;
  void make_elements(ContactLoads contacts);

  const Scene& scene_;
  Precision precision_;
  std::vector<const Term*> before_;
  Positions x_n_, lagged_;                      // m
  ContactLoads contacts_;                       // at lagged_
  std::vector<std::size_t> row_;                // [n] the contact of each element
  std::vector<double> coefficient_, strength_;  // [n]
  std::vector<int> vertices_;                   // [4 n]
  bool loads_known_ = false;
};

}  // namespace bb
