// Terms on the contacts of one state with the loads that these carry there: friction, restitution (docs/theory/friction.md). Which contacts and
// how much is taken at the start of a step, so that E stays one function of x within it. One family on every executor: what a step,
// a state of it and its end mean for the rows is here; where contacts come from and where sums go is the term's.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/energy/families/element_family.hpp"
#include "core/exec/buffer.hpp"
#include "core/model/scene/scene.hpp"
#include "core/terms/known_step.hpp"
#include "core/terms/lagged_rows.hpp"
#include "core/terms/report.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

/// Rows as a term takes them from contacts; LaggedRows are views of them.
struct LaggedColumns {
  explicit LaggedColumns(exec::Executor& executor);
  /// Columns of n rows. Values are lost; loads and strengths are 0.
  void fit(exec::Index n);
  exec::Index size() const { return pair.size(); }

  exec::Buffer<int> vertex;             // [4, n]
  exec::Buffer<double> weight, normal;  // [4, n], [3, n]
  exec::Buffer<PairId> pair;            // [n] ascending
  exec::Buffer<double> load, strength;  // [n]
};

/// Pointers are memory of the executor; x: [3 n_vertices] m. Results do not depend on the executor, its threads or its order.
class LaggedFamily {
 public:
  LaggedFamily(const LaggedFamily&) = delete;
  LaggedFamily& operator=(const LaggedFamily&) = delete;
  virtual ~LaggedFamily() = default;

  // --- rows: the term fills rows() and says so
  LaggedColumns& rows() { return rows_; }
  exec::Index size() const { return rows_.size(); }
  /// As rows() are combined, also before they are filled. Pointers are memory of the executor.
  SideCoefficients sides() const { return sides_with(of_body_, of_obstacle_); }
  /// rows() are those of the state x, which has n_numbers coordinates, all but their loads.
  void take(const double* x, exec::Index n_numbers);
  /// rows().load are known now.
  void know_loads();
  bool loads_known() const { return loads_known_; }
  /// m, the state that the rows are of.
  const exec::Buffer<double>& lagged() const { return lagged_; }

  // --- a step
  /// A step begins. take() of its start comes next.
  void begin_step(const FamilyStep& step) {
    x_n_ = step.x_n;
    step_begins(step);
  }
  /// The same step with another length.
  virtual void change_step(const FamilyStep&) {}
  /// As Term::take_secant.
  virtual bool take_secant(double /*share*/) { return false; }
  /// The iterate is another one than rows() are of: whether they are taken anew there.
  virtual bool refreshes() { return false; }
  /// The step has converged: whether rows are taken anew from where it did.
  virtual bool renews() { return false; }
  /// The step has ended at x.
  virtual void end_step(const double* /*x*/) {}
  /// What it remembers from step to step.
  virtual void keep(Archive&) {}
  /// Its rows, as they are, for the same term of another system, which looks at this step.
  LaggedState known(std::string_view term) const;
  void adopt(const LaggedState& known);

  // --- energies; motions are counted from the start of the step
  /// [n] J.
  virtual void values(const double* x, double* energy) = 0;
  /// force [3, n] (N): gradients in the motion of each row.
  virtual void gradients(const double* x, double* energy, double* force) = 0;
  /// hess [6, n] N/m: lower triangles, column by column.
  virtual void hessians(const double* x, double* hess) = 0;
  /// force [3, n] (N): how gradients change, to first order, along a motion of prescribed vertices (m, 0 at free ones).
  virtual void changes(const double* x, const double* motion, double* force) = 0;
  /// In the host's memory alone: terms of elements of four vertices. out is large enough for them.
  virtual void derivatives(const double* x, LocalTerms& out) = 0;
  /// In the host's memory alone: way [3 n] m, the relative motion of each row since the start of the step, with what the turn of
  /// an obstacle takes its surface along by.
  virtual void ways(const double* x, double* way) const = 0;
  /// What a step that ends at x says. Requires known loads.
  virtual void report_end(const double* x, StepNumbers& out) = 0;

 protected:
  /// body [n_vertices]: of the executor, outlives it. of_body, of_obstacle: coefficients of the sides of the scene, 1.
  LaggedFamily(const FamilyPlace& place, const int* body, CombineRule rule, std::span<const double> of_body,
               std::span<const double> of_obstacle);
  virtual void step_begins(const FamilyStep& step) { change_step(step); }
  /// The same sides with other coefficients.
  SideCoefficients sides_with(const exec::Buffer<double>& of_body,
                              const exec::Buffer<double>& of_obstacle) const {
    return {of_body.data(), of_obstacle.data(), body_, rule_};
  }
  /// rows() are others, or taken elsewhere.
  virtual void rows_changed() {}
  /// Strengths are coefficients times loads; they become those of the term.
  virtual void strengthen() {}
  /// What the kind keeps of a step besides its rows, and takes over with those of another system.
  virtual std::vector<double> kept() const = 0;
  virtual void adopt_kept(const LaggedState& known) = 0;
  LaggedRows view() const {
    return {rows_.size(),
            rows_.vertex.data(),
            rows_.weight.data(),
            rows_.normal.data(),
            rows_.strength.data(),
            rows_.load.data(),
            x_n_};
  }

  FamilyPlace place_;
  LaggedColumns rows_;
  const double* x_n_ = nullptr;  // [3 n_vertices] m, start of the step; restitution reads it

 private:
  const int* body_;
  CombineRule rule_;
  exec::Buffer<double> of_body_, of_obstacle_, lagged_;
  bool loads_known_ = false;
};

/// Makes the rows of a line of registry.inc. body [n_vertices]: of the executor. All of it outlives them. Errors: ConfigError.
using MakeLagged = std::unique_ptr<LaggedFamily>(const FamilyPlace& place, const Scene& scene,
                                                 const TermOptions& options, const int* body);
#define ENTRY(...)
#define PART(...)
#define LAGGED(name, ...) MakeLagged name##_family;
#include "core/terms/registry.inc"
#undef ENTRY
#undef PART
#undef LAGGED

}  // namespace bb
