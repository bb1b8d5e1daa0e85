// E in an executor's memory (docs/device.md): a list of terms as kernels, of which it knows none by name, and conjugate
// gradients on the matrix where it was assembled. Numbers alone go to the host.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/linear/executor/resident_pcg.hpp"
#include "core/linear/forcing.hpp"
#include "core/newton/incremental_potential.hpp"
#include "core/newton/method.hpp"
#include "core/resident/contact/expected_contacts.hpp"
#include "core/resident/elements/term_inputs.hpp"
#include "core/terms/cusps.hpp"
#include "core/terms/plan.hpp"

namespace bb {
class NewtonSystem;
}

namespace bb::resident {

class ResidentPotential final : public IncrementalPotential {
 public:
  /// scene, method and plan must outlive it. fixed: [3 n] prescribed or locked degrees of freedom. Errors: ConfigError for
  /// what has no device form; OutOfMemory.
  ResidentPotential(std::unique_ptr<exec::Executor> executor, const Scene& scene, Method& method,
                    const Plan& plan, const std::vector<std::uint8_t>& fixed, PhaseClock& clock);
  ~ResidentPotential() override;
  exec::Executor& executor() override { return *executor_; }

  void begin_step(const StepColumns& step) override;
  void change_step(const StepColumns& step) override;
  bool renew_lag(const Column& x) override;
  void end_step(const Column& x) override;
  void keep(Archive& archive) override;
  void drop_caches() override;

  void linearise(const Column& x, Column& g) override;
  bool pattern_changed() const override;
  void fill_matrix(const Column& x, const HessianLevel& level, const Column& force) override;
  void fill_exact(const Column& x, const Column& force) override;
  /// Errors: std::logic_error always: only article_literal asks, which runs on the host.
  double add_tikhonov(double relative, double absolute) override;
  void multiply(const Column& v, Column& out) override;
  void add_given_motion(const Column& x, const Column& motion, Column& force) override;
  void solve(const Column& b, RightSide of, Column& step, SolveReport& report) override;
  Definiteness examine(const Column& x, const HessianLevel& near, const Column& force, Column& b,
                       Column& step, Column& direction) override;
  std::size_t nnz() const override;

  void prepare(const Column& x0, const Column& x1, const Column& dx, bool to_bound) override;
  double bound(const Column& x0, const Column& x1, const Column& dx, IterationReport& report) override;
  std::string describe_bound() const override { return holder_ ? holder_->describe_bound() : std::string(); }
  bool make_room(const Column& x, const Column& dx, double bound, Column& force) override;
  bool admits(const Column& x, Column& trial) override;
  EnergyChange change(const Column& x, const Column& trial) override;
  void accept() override;

  void announce(const Column& x) override;
  double energy(TermSet set, const Column& x) override;
  void report(const Column& x, IterateNumbers& out) override;
  void report_end(const Column& x, StepNumbers& out) override;
  Cusps cusps(const Column& x) override;
  std::string describe_non_finite() override;
  KnownStep known_step() const override;

  /// On an executor that only counts buffers: what the rows are to be taken for.
  void expect(const ExpectedContacts& expected);
  /// As ResidentTerm::set_frugal_from.
  void set_frugal_from(Index rows);
  /// As ResidentTerm::set_list_budget.
  void set_list_budget(std::size_t bytes);
  /// Who holds how much memory.
  const exec::MemoryLedger& memory() const { return executor_->memory(); }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  /// How far a matrix is from the exact one: t and threshold of HessianLevel.
  struct Filled {
    double t = 0, threshold = infinity;
    const double* force = nullptr;
  };
  ResidentFrame frame(const StepColumns& step) const {
    return {&step.x_n, &step.x_tilde, step.dt, step.c, step.load_factor, step.t_end, step.at_start};
  }
  ResidentMatrix matrix() const;
  void fill(const Column& x, const Filled& level);
  void fill_elastic(const Column& x);
  bool is_finite(const Column& trial);
  void know_energies(const Column& x);
  void sum_energies(TermSet set, const Column& x, ResidentSum& sum);

  std::unique_ptr<exec::Executor> executor_;
  const Scene& scene_;
  Method& method_;
  const Plan& plan_;
  VectorTools vectors_;
  Buffer<double> mass_;
  ElementMatrix elements_;  // of all terms with stencils that stay
  ResidentTermList terms_;
  std::unique_ptr<ResidentPcg> pcg_;
  std::unique_ptr<CuspSearch> cusps_;  // made when it is asked for
  Forcing forcing_;
  int max_pcg_iterations_;

  Buffer<double> product_partial_;
  ResidentSum sum_, energy_;
  bool announced_ = false;  // energy_ is E at the iterate
  ResidentLeast least_;
  Filled level_;                                           // of the last fill_matrix()
  std::uint64_t pattern_id_ = 1;                           // of the matrix
  const ResidentTerm* holder_ = nullptr;                   // of the last bound
  bool energies_known_ = false, trial_evaluated_ = false;  // at the iterate, at the trial
};

/// Goes through every stage of a step with so many contacts on an executor that only counts buffers, so that
/// memory().peak() is what a step needs. system: of that potential.
void count_memory(NewtonSystem& system, ResidentPotential& potential, const Scene& scene,
                  const ExpectedContacts& expected);

}  // namespace bb::resident
