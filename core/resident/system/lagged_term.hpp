// A term on an executor that acts on the contacts of one state with the loads that these carry there: what LaggedContacts
// (core/terms) is on the host. Rows: those of core/resident/contact/lag_kernels.hpp.
#pragma once

#include "core/exec/sums/vector_kernels.hpp"
#include "core/resident/contact/resident_lag.hpp"
#include "core/resident/system/resident_contact.hpp"
#include "core/terms/known_step.hpp"

namespace bb::resident {

/// As a term on the host adopts it.
KnownLag known_lag(std::string_view term, const ResidentLag::Columns& columns, const Column& lagged,
                   double t);

/// The contacts that terms of later lines read. Errors: std::logic_error without any.
ResidentContact& contact_of(ResidentTermList& terms);

template <class Rows>
class LaggedTerm : public ResidentTerm {
 public:
  TermGroup group() const final { return TermGroup::friction; }
  Phase phase() const final { return Phase::contact_terms; }

  // --- a step
  void begin_step(const ResidentFrame& frame) override {
    rows_.x_n = frame.x_n->data();
    take(*frame.x_n);
    change_frame(frame);
  }
  void drop_caches() override { matrix_ = {}; }

  // --- an iterate
  void linearise(const Column& x, const ResidentContext&, Column& g) override {
    pattern_changed_ = taken_;
    taken_ = false;
    if (!lag_.known()) learn(x);
    executor_.each(size(), MotionGradients<Rows>{rows(), x.data(), energy_.data(), force_.data()});
    lag_.add_forces(force_.data(), g);
  }
  void add_matrix(const Column& x, const HessianRequest&) override {
    matrix_ = {};
    if (size() == 0) return;
    hess_.fit(6 * size());
    executor_.each(size(), MotionHessians<Rows>{rows(), x.data(), hess_.data()});
    matrix_ = lag_.matrix(hess_.data());
  }
  ChangingMatrix changing_matrix() const override {
    return {matrix_, matrix_.row_begin ? lag_.n_blocks() : 0};
  }
  bool pattern_changed() const override { return pattern_changed_; }
  void add_given_motion(const Column& x, const Column& motion, Column& force) override {
    executor_.each(size(), MotionChanges<Rows>{rows(), x.data(), motion.data(), force_.data()});
    lag_.add_forces(force_.data(), force);
  }

  // --- a trial state
  void evaluate(const Column& trial) override { values(trial, trial_energy_); }
  void add_change(const Column&, const Column&, ResidentChange& out) override {
    out.add(size(), energy_.data(), trial_energy_.data());
  }
  void take_energies() override { energy_.swap(trial_energy_); }
  void evaluate_iterate(const Column& x) override { values(x, energy_); }

  // --- what is said of it
  void add_energy(const Column&, ResidentEnergy& out) override { out.add(size(), nullptr, energy_.data()); }
  Index first_not_finite(ResidentLeast& least) override {
    least.clear();
    executor_.each(size(), FirstNotFinite{energy_.data(), least.data()});
    return least.first();
  }
  void add_known(KnownStep& out) const override {
    if (lag_.known()) out.lags.push_back(known_lag(name(), lag_.on_host(), lagged_, t_lag_));
  }

  // --- memory
  void expect(const ExpectedContacts& expected) override { lag_.expect(expected); }

 protected:
  LaggedTerm(const ResidentInputs& inputs, ResidentContact& contact, CombineRule rule,
             std::span<const double> of_body, std::span<const double> of_obstacle)
      : executor_(inputs.executor),
        contact_(contact),
        lag_(executor_, contact.surface(), inputs.scene.n_vertices(), rule, of_body, of_obstacle),
        lagged_(executor_, "lagged state"),
        energy_(executor_, "lagged energies"),
        trial_energy_(executor_, "lagged energies of the trial"),
        force_(executor_, "lagged forces"),
        hess_(executor_, "lagged Hessians") {}

  /// Requires x to be the iterate.
  void take(const Column& x) {
    lagged_.copy_from(x);
    lag_.take(contact_.rows(x));
    for (auto* column : {&energy_, &trial_energy_}) column->fit(size());
    force_.fit(3 * size());
    matrix_ = {};
    taken_ = true;
  }
  /// The rows carry loads now: strengths become those of the term.
  virtual void strengthen() {}
  Index size() const { return lag_.size(); }
  /// As kernels read them.
  Rows rows() const {
    Rows out = rows_;
    static_cast<LagView&>(out) = lag_.view(rows_.x_n);
    return out;
  }

  exec::Executor& executor_;
  ResidentContact& contact_;
  ResidentLag lag_;
  Column lagged_;     // m, the state that the rows are of
  Rows rows_{};       // what is not of the lag
  double t_lag_ = 0;  // s, of that state

 private:
  void learn(const Column& x) {
    lag_.learn(contact_.forces(x));
    strengthen();
  }
  void values(const Column& x, Buffer<double>& energy) {
    executor_.each(size(), MotionValues<Rows>{rows(), x.data(), energy.data()});
  }

  Buffer<double> energy_, trial_energy_, force_, hess_;
  MatrixPart matrix_{};
  bool taken_ = false, pattern_changed_ = false;
};

}  // namespace bb::resident
