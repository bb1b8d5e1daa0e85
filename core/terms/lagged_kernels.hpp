// What terms on lagged contacts do with their rows once a step: coefficients, turns of obstacles, speeds at which pairs met, and what
// a step says of them.
#pragma once

#include "core/contact/combine_rule.hpp"
#include "core/contact/obstacle_arm.hpp"
#include "core/contact/pair_id.hpp"
#include "core/exec/sums/search.hpp"
#include "core/exec/sums/sum_kernels.hpp"
#include "core/terms/lagged_rows.hpp"

namespace bb {

/// The coefficient of a contact from those of its two sides: the body of its first vertex, and its obstacle or the body of its last
/// vertex.
struct SideCoefficients {
  const double* of_body;      // [bodies] 1
  const double* of_obstacle;  // [obstacles]
  const int* body;            // [n_vertices]
  CombineRule rule;
  /// vertex[k stride]: vertex k of four, -1 padded.
  BB_HD double of(const int* vertex, exec::Index stride, PairId pair) const {
    const double first = of_body[body[vertex[0]]];
    const int obstacle = pair_obstacle(pair);
    if (obstacle >= 0) return combined(rule, first, of_obstacle[obstacle]);
    int last = vertex[0];
    for (int k = 1; k < 4; ++k) {
      const int v = vertex[k * stride];
      if (v >= 0) last = v;
    }
    return combined(rule, first, of_body[body[last]]);
  }
};

/// strength [n]: coefficient times load.
struct RowStrengths {
  LaggedRows rows;
  SideCoefficients sides;
  const PairId* pair;
  double* strength;
  BB_HD void operator()(exec::Index r) const {
    strength[r] = sides.of(rows.vertex + r, rows.n, pair[r]) * rows.load[r];
  }
};

/// How far an obstacle has turned, column-major: where the rows are of, and at both ends of the step.
struct ObstacleTurn {
  ObstacleKind kind;
  double axis[3], radius;  // m
  double lag[9], begin[9], end[9];
  bool turns;
};

/// spin [3, n]: what the turn of its obstacle takes the surface of a row along by in the step, m.
struct FindSpins {
  LaggedRows rows;
  const PairId* pair;
  const ObstacleTurn* turn;
  const double* lagged;  // [3 n_vertices] m, the state that the rows are of
  double* spin;
  BB_HD void operator()(exec::Index r) const {
    Vec3d out = Vec3d::Zero();
    const int o = pair_obstacle(pair[r]);
    if (o >= 0 && turn[o].turns) {
      const ObstacleTurn& of = turn[o];
      const AnalyticSurface<double> surface{of.kind, Vec3d::Zero(), Vec3d(of.axis[0], of.axis[1], of.axis[2]),
                                            of.radius, false};
      // From the point of the obstacle, which is a vertex that moves, to the other side of the contact.
      const Vec3d arm = rows.moved(lagged, r);
      out = way_of_turn<double>(arm_to_surface<double>(surface, arm), matrix(of.lag), matrix(of.begin),
                                matrix(of.end));
    }
    for (int c = 0; c < 3; ++c) spin[c * rows.n + r] = out[c];
  }

 private:
  BB_HD static Mat3d matrix(const double* numbers) {
    Mat3d out;
    for (int c = 0; c < 9; ++c) out.data()[c] = numbers[c];
    return out;
  }
};

/// What a step says of friction.
struct FrictionNumbers {
  resident::Compensated work;  // J
  exec::Key sticking, sliding;
  BB_HD static FrictionNumbers zero() { return {resident::Compensated::zero(), 0, 0}; }
  friend BB_HD FrictionNumbers operator+(const FrictionNumbers& a, const FrictionNumbers& b) {
    return {a.work + b.work, a.sticking + b.sticking, a.sliding + b.sliding};
  }
};
/// Parts of SumParts.
template <class Law>
struct FrictionOfRows {
  using Sum = FrictionNumbers;
  FrictionRows<Law> rows;
  const double* x;
  BB_HD void operator()(exec::Index r, FrictionNumbers& sum) const {
    if (!(rows.strength[r] > 0)) return;
    const double y = rows.slide(x, r).norm();
    sum.work.add(friction_work<double>(y, rows.strength[r], rows.law()));
    (y < rows.eps ? sum.sticking : sum.sliding) += 1;
  }
};

/// Parts of a sum: force times way of restitution, J.
struct RestitutionWork {
  RestitutionRows rows;
  const double* x;
  BB_HD void operator()(exec::Index r, resident::Compensated& sum) const {
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
    const exec::Index at = resident::first_not_below(known.pair, exec::Index{0}, known.n, pair[r]);
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
