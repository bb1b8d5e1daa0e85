// The whole Newton step in an executor's memory (docs/design.md, Resident pipeline): the same sum of terms as
// NewtonSystem, with numbers alone going to the host inside a step.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/linear/forcing.hpp"
#include "core/newton/hessian_level.hpp"
#include "core/newton/newton_system.hpp"
#include "core/newton/step_system.hpp"
#include "core/resident/elements/resident_elements.hpp"
#include "core/resident/elements/vectors.hpp"
#include "core/resident/linear/resident_pcg.hpp"
#include "core/resident/system/resident_contact.hpp"
#include "core/resident/system/row_totals.hpp"

namespace bb::resident {

class ResidentSystem final : public StepSystem {
 public:
  using Column = exec::Buffer<double>;

  /// scene and method must outlive the system. Errors: ConfigError for what has no device form; OutOfMemory.
  ResidentSystem(std::unique_ptr<exec::Executor> executor, const Scene& scene, Method& method,
                 const Plan& plan);
  ~ResidentSystem() override;

  void begin_step(const Positions& x_n, const Prediction& prediction, double dt, double load_factor) override;
  void restart_step(const Prediction& prediction, double dt) override;
  void end_step() override;
  void set_target(const Positions& target) override;
  void hold() override { set_target(x()); }
  bool at_target() const override;
  void keep(Archive& archive) override;
  void drop_caches() override;

  void assemble() override;
  double add_tikhonov(double relative, double absolute) override;
  SolveReport find_direction() override;
  DirectionSize direction_size() override;
  void scale_direction(double factor) override;
  double direction_curvature() override;
  EndCheck check_end() override;
  void aim_at_escape(double length) override;
  bool solved_is_exact() const override { return level_.exact(); }

  void prepare_motion(MotionEnd end, bool to_bound) override;
  double bound_motion(IterationReport& report) override;
  bool make_detour(double bound, SolveReport& report) override;
  void restore_direction() override { dx_.swap(escape_); }
  std::string describe_bound() const override { return holder_; }
  std::optional<EnergyChange> try_motion(double alpha) override;
  void accept() override;

  const Scene& scene() const override { return scene_; }
  Precision precision() const override { return Precision::full; }
  const Positions& x() const override;
  const Positions& x_before() const override;
  const Positions& gradient() const override;
  double grad_inf() const override { return vectors_.free_max(g_); }
  double energy() const override;
  double energy(TermGroup group) const override;
  bool pattern_changed() const override { return contact_ && contact_->pattern_changed(); }
  int n_free() const override { return n_free_; }
  std::size_t nnz() const override;
  const std::vector<std::uint8_t>& fixed() const override { return fixed_; }
  void report(IterateNumbers& out) const override;
  void report_end(StepNumbers& out) const override;
  void report_overload(bool with_direction, StepNumbers& out) override;
  std::string describe_non_finite() const override;
  NewtonSystem& on_cpu() override;

  /// On an executor that only counts buffers: every stage of a step with so many contacts, so that memory().peak() is
  /// what a step needs.
  void count_memory(const ExpectedContacts& expected);
  /// As ResidentContact::set_frugal_from.
  void set_frugal_from(Index rows) {
    if (contact_) contact_->set_frugal_from(rows);
  }
  /// As ResidentContact::set_list_budget.
  void set_list_budget(std::size_t bytes) {
    if (contact_) contact_->set_list_budget(bytes);
  }
  /// Who holds how much memory.
  const exec::MemoryLedger& memory() const { return executor_->memory(); }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  /// A column on the host, copied when it is asked for.
  struct HostCopy {
    Positions values;
    bool valid = false;
  };
  const Positions& copy(const Column& column, HostCopy& to) const;
  void forget_copies();
  ResidentMatrix matrix() const;
  void move(double alpha, Column& to);
  void fill_elastic();
  void keep_elastic();
  MatrixPart kept_elastic() const;
  HessianRequest request_of(StepHessian choice, bool exact) const;
  HessianChoice contact_choice(bool exact) const;
  void fill_matrix(bool exact);
  double largest_force();
  bool direction(SolveReport& report);
  LinearReport solve_linear();
  double multiply(const Column& v, Column& out);
  /// Requires contact_.
  RowTotals row_totals() const;
  void keep_contact(Archive& archive);
  NewtonSystem& cpu();

  std::unique_ptr<exec::Executor> executor_;
  const Scene& scene_;
  Method& method_;
  const Plan plan_;
  const std::vector<std::uint8_t> fixed_;
  int n_free_;
  mutable VectorTools vectors_;
  mutable ResidentElements elements_;
  mutable std::unique_ptr<ResidentContact> contact_;  // where something can touch
  std::unique_ptr<ResidentPcg> pcg_;
  Forcing forcing_;
  int max_pcg_iterations_;
  HessianLevel level_;
  bool served_at_once_ = false;

  Column x_, trial_, end_, dx_, g_, x_n_, x_tilde_, b_, step_, work_;  // [3 n]
  Column escape_, body_size_;  // [3 n] a direction of negative curvature, or dx before its detour; [n] m
  ExactHessians exact_hessians_;
  Column force_;          // [n] N
  Column elastic_value_;  // H that stiffness policies read
  bool has_step_elastic_ = false;
  exec::Buffer<double> product_partial_;
  mutable ResidentSum sum_;
  mutable ResidentSums<RowTotals> row_totals_;
  MatrixPart contact_matrix_{};
  ResidentFrame frame_;
  Prediction prediction_;  // as it came, for the CPU's view
  Positions x_start_, target_;
  std::uint64_t pattern_id_ = 1;  // of the matrix
  MotionEnd motion_ = MotionEnd::free;
  std::string holder_;  // of the last bound
  double limit_kappa_change_ = 0;
  mutable HostCopy host_x_, host_before_, host_g_;
  std::unique_ptr<NewtonSystem> cpu_;
};

}  // namespace bb::resident
