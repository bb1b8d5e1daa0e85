// All strain-limited triangles of a scene, or all tetrahedra, as a family of elements on any executor: singular values, barrier terms,
// stiffness, step bound. Which state is measured, and when the stiffness is made anew, is StrainLimitState's (core/terms).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/barrier/shape.hpp"
#include "core/barrier/stiffness_policy.hpp"
#include "core/energy/families/element_family.hpp"
#include "core/energy/families/limit_values.hpp"
#include "core/exec/sums/executor_sum.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

/// LimitNumbers as numbers.
struct LimitReport {
  double max_stretch, load_max, gap_min_rel;  // 1, N/m or Pa, 1
};

/// values(), gradients(), hessians() and derivatives() are those of the state that was measured last, whose x they are given. kappa is 0
/// until it is made. Pointers are memory of the executor. Not thread-safe: it writes its columns.
class LimitFamily : public ElementFamily {
 public:
  explicit LimitFamily(exec::Executor& executor)
      : executor_(executor),
        kappa_(executor, "limit stiffness"),
        least_(executor),
        bounds_(executor),
        numbers_(executor) {}

  /// Singular values and pseudo-gaps at x. Cost: one SVD an element.
  virtual void measure(const double* x) = 0;
  /// Barrier terms at the measured pseudo-gaps; infinite at or beyond the limit.
  virtual void fill_barrier(const BarrierFunction& barrier) = 0;
  /// Both, with energies [n] (J) by the kappa that there is; the first element at or beyond its limit, or without a number, is
  /// brought to *beyond.
  virtual void measure(const double* x, const BarrierFunction& barrier, double* energy,
                       exec::Key* beyond) = 0;
  /// States that were measured so far.
  long long sweeps() const { return sweeps_; }

  /// kappa_e at the measured pseudo-gaps; where the policy has a potential it is folded into the barrier terms from here on, which
  /// are to be filled then.
  virtual void make_kappa(const StiffnessPolicy& policy, const KappaSources& from) = 0;
  /// [n] J, what the policy has for these pseudo-gaps [n]; a number also where it has a potential. In the host's memory alone; a state is to
  /// be measured and its kappa to be made before anything else is called.
  virtual std::vector<double> kappa_at(std::span<const double> gaps, const StiffnessPolicy& policy,
                                       const KappaSources& from) = 0;
  /// Largest relative change of an active element's kappa by the last make_kappa(). Of a policy that is not uniform. Waits.
  virtual double kappa_change() = 0;
  /// [n] J.
  exec::Buffer<double>& kappa() { return kappa_; }

  // --- a motion
  /// Launches what bound() reads: the largest alpha in [0, alpha_max] whose state x + alpha dx, rounded coordinate by coordinate,
  /// keeps every pseudo-gap above park x width (strain_step_bound).
  void look_along(const double* x, const double* dx, double park, double alpha_max = 1);
  /// Waits. x and dx are as they were. Cost: about 60 SVD of those that would pass their limit.
  double bound();

  /// Launches what report() reads of the measured state.
  void announce();
  /// Waits.
  LimitReport report() const;

  // --- in the host's memory alone
  /// Smallest pseudo-gap of an element.
  virtual double smallest_gap(std::size_t e) const = 0;
  /// Those of all elements at x, which is measured.
  std::vector<double> smallest_gaps(const double* x);
  /// Area (m^2) or volume (m^3) of an element at rest.
  virtual double measure_of(std::size_t e) const = 0;

 protected:
  /// Brings the least of the elements' bounds below alpha, or below *before where that is given, to *smallest.
  virtual void launch_bound(const double* x, const double* dx, double alpha, double park,
                            const exec::Key* before, exec::Key* smallest) = 0;
  virtual void add_numbers(exec::ExecutorSums<LimitNumbers>& numbers) = 0;

  exec::Executor& executor_;
  exec::Buffer<double> kappa_;
  exec::ExecutorLeast least_;
  long long sweeps_ = 0;

 private:
  /// Ordered bits of the smallest bound, and of the smallest of a second look that begins with it; all ones: none.
  struct Bounds {
    exec::Key first, second;
  };
  struct Motion {
    const double *x, *dx;
    double park, alpha_max;
  };
  exec::Reading<Bounds> bounds_;
  exec::ExecutorSums<LimitNumbers> numbers_;
  Motion motion_{};  // of the last look_along()
};

/// The part outlives what is made. planar: F is 2 x 2 in the x-y plane. Errors: ConfigError for columns of another length or value,
/// elements without area or volume; OutOfMemory.
std::unique_ptr<LimitFamily> limited_triangles(const FamilyPlace& place, const StrainLimitPart& part,
                                               const PositionsView& x_rest, bool planar);
std::unique_ptr<LimitFamily> limited_tetrahedra(const FamilyPlace& place, const SolidLimitPart& part,
                                                const PositionsView& x_rest);

}  // namespace bb
