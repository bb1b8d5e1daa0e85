// What the contact term does in a step, whichever matrix engine reads it: when its policy starts and what it learns between steps, what
// bounds a motion, what is reported of the rows and what is kept.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/archive/archive.hpp"
#include "core/contact/pair_name.hpp"
#include "core/terms/policy_start.hpp"
#include "core/terms/row_report.hpp"
#include "core/terms/step_end_gaps.hpp"
#include "core/terms/term.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

/// Base: a term of a matrix engine.
template <class Base>
class ContactSteps : public Base {
 public:
  std::string_view name() const override { return "contact"; }
  TermGroup group() const override { return TermGroup::contact; }
  Phase phase() const override { return Phase::contact_terms; }

  void change_step(const StepColumns& step) override {
    time_ = {step.dt, step.c};
    policy().set_time(time_);
  }
  /// Passes to a policy that adapts which pairs had a row at two step ends in a row.
  void end_step(const PositionsView& x, PhaseClock& clock) override {
    if (!policy().adapts()) return;
    const ScopedPhase timer(clock, Phase::stiffness);
    visit_rows(x, [this](const EndRow& row) {
      gaps_.add({row.pair, row.d, options_.contact_options.min_gap_fraction * row.d_hat});
    });
    policy().end_step(gaps_.end_step());
  }
  void keep(Archive& archive) override {
    bool started = policy_start_.started();
    archive(started);
    policy_start_.set_started(started);
    gaps_.keep(archive);
    policy().keep(archive);
  }

  double bound(const Motion& motion, IterateNumbers& out, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::step_bound);
    bound_ = find_bound(motion);
    out.bound = bound_;
    return out.alpha_ccd = bound_.alpha;
  }
  std::string describe_bound() const override { return pair_name(scene_, bound_.key, bound_.kind); }

  void report(const PositionsView& x, IterateNumbers& out, PhaseClock&) override {
    out.kappa_change_rel = kappa_change();
    const RowTotals rows = totals(x);
    report_rows(rows, smallest_gap(), out);
  }
  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock&) override {
    const RowTotals rows = totals(x);
    report_rows_of_end(
        rows, smallest_gap(), options_.precision, [&] { return largest_coordinate(x); },
        [&](const auto& f) { visit_rows(x, f); }, out);
  }

 protected:
  template <class... OfBase>
  ContactSteps(const Scene& scene, const TermOptions& options, OfBase&&... of_base)
      : Base(std::forward<OfBase>(of_base)...), scene_(scene), options_(options) {}

  // --- what a matrix engine has of its own, of the rows of the iterate x
  virtual RowTotals totals(const PositionsView& x) = 0;
  /// m; infinity without rows.
  virtual double smallest_gap() const = 0;
  /// In magnitude, m.
  virtual double largest_coordinate(const PositionsView& x) = 0;
  /// f(each row): those without mollifier in the order of their pairs.
  virtual void visit_rows(const PositionsView& x, const std::function<void(const EndRow&)>& f) = 0;
  /// Of the last linearise(), as StiffnessUpdate::change().
  virtual double kappa_change() const = 0;
  /// With kappa = 1. others: gradient of all other terms, N. None on an executor that only counts buffers.
  virtual std::optional<StartSums> start_sums(const PositionsView& x, const PositionsView& others) = 0;
  virtual StepBound find_bound(const Motion& motion) = 0;

  /// Before kappa of an iterate with so many rows is refreshed.
  void start_policy(const PositionsView& x, const PositionsView& others, std::size_t n_rows) {
    if (!policy_start_.due(policy(), n_rows)) return;
    const std::optional<StartSums> sums = start_sums(x, others);
    if (!sums) return policy_start_.set_started(true);
    policy_start_.start(policy(), scene_, options_.contact, *sums, time_);
  }
  StiffnessPolicy& policy() const { return *options_.stiffness; }

  const Scene& scene_;
  const TermOptions& options_;
  StiffnessTime time_;
  PolicyStart policy_start_;
  StepEndGaps gaps_;
  StepBound bound_;
};

}  // namespace bb
