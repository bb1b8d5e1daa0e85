// E in an executor's memory (docs/device.md): a list of terms as kernels, of which it knows none by name, and conjugate
// gradients on the matrix where it was assembled. Numbers alone go to the host.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/contact/executor/expected_contacts.hpp"
#include "core/linear/executor/executor_pcg.hpp"
#include "core/linear/forcing.hpp"
#include "core/newton/incremental_potential.hpp"
#include "core/newton/method.hpp"
#include "core/terms/cusps.hpp"
#include "core/terms/executor/term_inputs.hpp"
#include "core/terms/plan.hpp"

namespace bb {
class NewtonSystem;
}

namespace bb::exec {

class ExecutorEngine final : public IncrementalPotential {
 public:
  /// scene, method and plan must outlive it. fixed: [3 n] prescribed or locked degrees of freedom. Errors: ConfigError for
  /// what has no device form; OutOfMemory.
  ExecutorEngine(std::unique_ptr<Executor> executor, const Scene& scene, Method& method, const Plan& plan,
                 const std::vector<std::uint8_t>& fixed, PhaseClock& clock);
  ~ExecutorEngine() override;
  Executor& executor() override { return *executor_; }

  void drop_caches() override;
  /// From now on the end of a phase waits for what the phase launched (PhaseClock::wait_at_ends). What a kernel did wrong
  /// is reported by the next call that waits.
  void synchronize_phases();

  bool pattern_changed() const override;
  void fill_matrix(const Column& x, const HessianRegularisation& level, const Column& force) override;
  void fill_exact(const Column& x, const Column& force) override;
  /// Errors: std::logic_error always: only article_literal calls it, and it runs on the host.
  double add_tikhonov(double relative, double absolute) override;
  void multiply(const Column& v, Column& out) override;
  void solve(const Column& b, RightSide of, Column& step, SolveReport& report) override;
  Definiteness examine(const Column& x, const HessianRegularisation& near, const Column& force, Column& b,
                       Column& step, Column& direction) override;
  std::size_t nnz() const override;

  Cusps cusps(const Column& x, double t_end) override;
  std::string describe_non_finite() override;
  KnownStep known_step() const override;

  /// On an executor that only counts buffers: what the rows are to be taken for.
  void expect(const ExpectedContacts& expected);
  /// As ExecutorTerm::set_frugal_from.
  void set_frugal_from(Index rows);
  /// As ExecutorTerm::set_list_budget.
  void set_list_budget(std::size_t bytes);
  /// Who holds how much memory.
  const MemoryLedger& memory() const { return executor_->memory(); }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  /// How far a matrix is from the exact one: t and threshold of HessianRegularisation.
  struct Filled {
    double t = 0, threshold = infinity;
    const double* force = nullptr;
  };
  void solver_begins_step() override { forcing_.begin_step(); }
  void linearise_terms(const Column& x, Column& g) override;
  bool is_finite(Column& trial, bool seen_by_terms) override {
    return seen_by_terms || vectors_.first_not_finite(trial) < 0;
  }
  void room_was_made(const Column& x) override { fill(x, level_); }
  EnergyChange sum_change(const Column& x, const Column& trial) override;
  bool launches() const override { return true; }
  void announce_energy(const Column& x) override { sum_energies(TermSet::all(), x, energy_); }
  double sum_energy(TermSet set, const Column& x, bool announced) override;
  ExecutorMatrix matrix() const;
  void fill(const Column& x, const Filled& level);
  void fill_elastic(const Column& x);
  void sum_energies(TermSet set, const Column& x, ExecutorSum& sum);

  std::unique_ptr<Executor> executor_;
  const Scene& scene_;
  Method& method_;
  const Plan& plan_;
  VectorTools vectors_;
  Buffer<double> mass_;
  ElementMatrix elements_;  // of all terms with stencils that stay
  ExecutorTerms terms_;
  std::unique_ptr<ExecutorPcg> pcg_;
  std::unique_ptr<CuspSearch> cusps_;  // made when it is requested
  Forcing forcing_;
  int max_pcg_iterations_;

  Buffer<double> product_partial_;
  ExecutorSum sum_, energy_;  // the second: what was announced
  ExecutorLeast least_;
  Filled level_;                  // of the last fill_matrix()
  std::uint64_t pattern_id_ = 1;  // of the matrix
};

/// Goes through every stage of a step with so many contacts on an executor that only counts buffers, so that
/// memory().peak() is what a step needs. system: of that potential.
void count_memory(NewtonSystem& system, ExecutorEngine& potential, const Scene& scene,
                  const ExpectedContacts& expected);

}  // namespace bb::exec
