// What the pipeline knows of a stiffness policy: batch calls over columns that fill the kappa of contacts (N/m), and kernels for the
// kappa of limited elements (J).
// The policies themselves live in barriers/stiffness/.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "core/barrier/stiffness_sums.hpp"
#include "core/math/host_device.hpp"

namespace bb {

class Archive;

enum class Refresh { per_iteration, per_step };  // when kappa is computed anew

/// kappa as a function of the gap alone: fixed + per_gap_sq/d^2. Of a strain limit the gap is y and both parts
/// are in J.
template <class T>
struct KappaPartsOf {
  T fixed = T(0);       // N/m
  T per_gap_sq = T(0);  // N m
  /// kappa at the gap d (m); d is read only where kappa depends on it.
  BB_HD T at(T d) const { return per_gap_sq == T(0) ? fixed : fixed + per_gap_sq / (d * d); }
};
using KappaParts = KappaPartsOf<double>;

/// Columns of n contact rows, free vertices only; row r owns slots 4 r .. 4 r + n_free[r].
struct StiffnessBatch {
  std::size_t n = 0;
  const int* n_free = nullptr;      // [n] 1..4
  const double* weight = nullptr;   // [4 n] w_i of the free vertices
  const double* normal = nullptr;   // [3 n] unit normal
  const double* d = nullptr;        // [n] gap, m
  const double* d_hat = nullptr;    // [n] m
  const double* mass = nullptr;     // [4 n] lumped vertex masses, kg
  const double* hessian = nullptr;  // [144 n] 12 x 12 column-major sub-matrix of the elastic Hessian, N/m;
                                    // null unless the policy reports needs_hessian
  StiffnessTime time;
};

/// Sums over the state that a policy with memory may read. grad_b: gradient of B with kappa = 1; grad_e: of E
/// without B (both over free degrees of freedom).
struct StiffnessGlobals {
  double grad_b_dot_grad_e = 0;  // m N
  double grad_b_sq = 0;          // m^2
  double mean_contact_mass = 0;  // kg
  double max_free_mass = 0;      // kg, of the vertices that are not prescribed, in contact or not
  double d2b_half = 0;           // b''(d_hat/2) for kappa = 1
  double d_hat = 0;              // m, the smallest of the scene
  StiffnessTime time;
};

/// Whether a pair came closer from one step end to the next: no other can make a policy adapt. Host-device.
BB_HD constexpr bool closes(double gap, double gap_before) { return gap < gap_before; }

class GapStiffness;
struct PolicyLaunches;  // launches.hpp

/// A stiffness policy of one run, of its contacts or of its strain limit. Not thread-safe: one object a run, called by the step driver only.
class StiffnessPolicy {
 public:
  virtual ~StiffnessPolicy() = default;
  virtual std::string_view name() const = 0;
  virtual Refresh refresh() const = 0;
  virtual bool needs_hessian() const { return false; }
  virtual bool needs_globals() const { return false; }

  /// One stiffness for all items: state() has the kappa of the rows, and nothing is remembered of them.
  virtual bool uniform() const { return false; }
  /// Whether kappa stays as the first iterate of a step has it.
  bool frozen_in_step() const { return uniform() || refresh() == Refresh::per_step; }

  /// Called once, at the first iterate that has contacts, when needs_globals().
  virtual void start(const StiffnessGlobals&) {}
  /// Called where a step begins or goes on with another length, before kappa is requested.
  virtual void set_time(const StiffnessTime&) {}
  /// kappa (N/m) of every row. Requires start() first when needs_globals().
  virtual void fill(const StiffnessBatch& rows, double* kappa) const = 0;
  /// Whether B has to be the potential of kappa(d) b'(d): kappa's dependence on the gap is then part of B, and
  /// all else of kappa is frozen for the step, pair by pair. Such a policy is refreshed per step.
  virtual bool has_potential() const { return false; }
  /// kappa of every row as a function of its gap; d is not read. Called when has_potential().
  virtual void fill_parts(const StiffnessBatch&, KappaParts*) const {}
  /// Where kappa is another function of the gap than KappaParts::at (gap_stiffness.hpp): fill_parts gives what it freezes of
  /// a pair. Lives as long as the policy.
  virtual const GapStiffness* gap_stiffness() const { return nullptr; }

  /// A pair that has a row at the end of this step and of the one before.
  struct PairEnd {
    double gap = 0, gap_before = 0;  // m
    double park = 0;                 // m, min_gap_fraction times the row's d_hat
    bool closing() const { return closes(gap, gap_before); }
  };
  /// Kernels that do what fill does, and those of limited elements; null: there are none.
  virtual const PolicyLaunches* launches() const { return nullptr; }
  /// Whether end_step has to be called: listing the pairs costs a sort a step.
  virtual bool adapts() const { return false; }
  /// Called after each step with all such pairs, by identity: lets a policy adapt between steps.
  virtual void end_step(std::span<const PairEnd>) {}

  /// What the record keeps: kappa now, number of doublings, whether the bound was reached.
  struct State {
    double kappa_start = 0, kappa = 0;  // N/m, 0 when the policy has no single value
    int doublings = 0;
    bool saturated = false;
  };
  virtual State state() const { return {}; }
  /// What it remembers from step to step (core/base/archive): a policy with memory lists it all.
  virtual void keep(Archive&) {}
};

}  // namespace bb
