// Rows of restitution (docs/theory/friction.md): the damping of contacts, and the speeds at which their pairs met.
#pragma once

#include "core/energy/restitution.hpp"
#include "core/exec/sums/search.hpp"
#include "core/exec/sums/sum_kernels.hpp"
#include "core/terms/lagged_rows.hpp"

namespace bb {

struct RestitutionRows : LaggedRows {
  double dt;  // s

  template <class T = double>
  BB_HD ContactDamping<T> damping(exec::Index r) const {
    return {static_cast<T>(strength[r] / dt), static_cast<T>(load[r])};
  }
  template <class T = double>
  BB_HD T value(const double* x, exec::Index r) const {
    return damping_value<T>(motion<T>(x, r), normal_of<T>(r), damping<T>(r));
  }
  template <class T = double>
  BB_HD MotionTerms<T> terms(const double* x, exec::Index r) const {
    return damping_terms<T>(motion<T>(x, r), normal_of<T>(r), damping<T>(r));
  }
};

/// Parts of a sum: force times way of restitution, J.
struct RestitutionWork {
  RestitutionRows rows;
  const double* x;
  BB_HD void operator()(exec::Index r, exec::Compensated& sum) const {
    sum.add(damping_work<double>(rows.motion(x, r), rows.normal_of(r), rows.damping(r)));
  }
};

/// Speeds at which pairs met; pairs ascending.
struct MetPairs {
  const PairId* pair;
  const double* speed;  // m/s
  exec::Index n;
};

/// met [n]: the speed at which the pair of each row met. Pairs that were in contact keep it; those that are new meet now, with the
/// speed at which their gap closes.
struct RememberMeeting {
  LaggedRows rows;
  const PairId* pair;
  MetPairs known;
  const double* speed;  // [3 n_vertices] m/s, of the step before
  double* met;
  BB_HD void operator()(exec::Index r) const {
    const exec::Index at = exec::first_not_below(known.pair, exec::Index{0}, known.n, pair[r]);
    if (at < known.n && known.pair[at] == pair[r]) {
      met[r] = known.speed[at];
    } else {
      met[r] = -rows.moved(speed, r).dot(rows.normal_of(r));
    }
  }
};

/// Pairs that meet slower, m/s, are damped as those that meet with it.
constexpr double least_meeting_speed = 1e-2;

/// strength /= the speed at which the pair of a row met.
struct DampByMeeting {
  const double* met;
  double* strength;
  BB_HD void operator()(exec::Index r) const {
    strength[r] /= met[r] < least_meeting_speed ? least_meeting_speed : met[r];
  }
};

/// out = (to - from)/dt.
struct SpeedOfStep {
  const double *to, *from;
  double dt;
  double* out;
  BB_HD void operator()(exec::Index i) const { out[i] = (to[i] - from[i]) / dt; }
};

}  // namespace bb
