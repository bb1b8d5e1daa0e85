// What terms do with the contacts of one state (core/terms/lagged_contacts.hpp): an energy of the relative motion of the closest
// points of every row, as columns; number k of a row is column[k n + row].
#pragma once

#include "core/contact/combine_rule.hpp"
#include "core/contact/contact_table.hpp"
#include "core/contact/obstacle_arm.hpp"
#include "core/energy/friction.hpp"
#include "core/energy/friction_list.hpp"
#include "core/energy/restitution.hpp"
#include "core/resident/contact/pattern_view.hpp"
#include "core/resident/contact/resident_surface.hpp"
#include "core/resident/contact/slot_kernels.hpp"
#include "core/resident/contact/sum_kernels.hpp"

namespace bb::resident {

/// Rows that are kept.
struct LagView {
  Index n;
  const int* vertex;         // [4, n], -1 padded
  const double* weight;      // [4, n]
  const double* normal;      // [3, n] unit
  const std::uint8_t* free;  // [n] bit k: vertex k is free
  const double* strength;    // [n] N times the unit of 1 over the coefficient
  const double* load;        // [n] N
  const double* x_n;         // [3 n_vertices] m, from where motions are counted

  BB_HD Vec3d normal_of(Index r) const { return Vec3d(normal[r], normal[n + r], normal[2 * n + r]); }
  /// Sum of the weights times what at(vertex) says.
  template <class At>
  BB_HD Vec3d weighted(Index r, const At& at) const {
    Vec3d out = Vec3d::Zero();
    for (int k = 0; k < 4; ++k) {
      const Index v = vertex[k * n + r];
      if (v >= 0) out += weight[k * n + r] * at(v);
    }
    return out;
  }
  /// Since x_n, m.
  BB_HD Vec3d motion(const double* x, Index r) const {
    const double* const from = x_n;
    return weighted(r, [=](Index v) {
      return Vec3d(x[3 * v] - from[3 * v], x[3 * v + 1] - from[3 * v + 1], x[3 * v + 2] - from[3 * v + 2]);
    });
  }
  /// What of a motion [3 n_vertices] (m, 0 at free vertices) is relative, m.
  BB_HD Vec3d moved(const double* motion, Index r) const {
    return weighted(r, [=](Index v) { return Vec3d(motion[3 * v], motion[3 * v + 1], motion[3 * v + 2]); });
  }
};

/// Friction. Law: of core/energy/friction_laws.
template <class Law>
struct RubbingRows : LagView {
  const double*
      spin;    // [3, n] m, what the turn of an obstacle takes its surface along by; null: nothing turns
  double eps;  // m

  BB_HD LawWithEps<Law, double> law() const { return {eps}; }
  BB_HD Vec3d slide(const double* x, Index r) const {
    Vec3d way = motion(x, r);
    if (spin) way -= Vec3d(spin[r], spin[n + r], spin[2 * n + r]);
    return slide_of<double>(way, normal_of(r));
  }
  BB_HD double value(const double* x, Index r) const {
    return friction_value<double>(slide(x, r), strength[r], law());
  }
  BB_HD MotionTerms<double> terms(const double* x, Index r) const {
    return friction_of_slide<double>(slide(x, r), normal_of(r), strength[r], law());
  }
};

/// Restitution.
struct DampingRows : LagView {
  double dt;  // s

  BB_HD ContactDamping<double> damping(Index r) const { return {strength[r] / dt, load[r]}; }
  BB_HD double value(const double* x, Index r) const {
    return damping_value<double>(motion(x, r), normal_of(r), damping(r));
  }
  BB_HD MotionTerms<double> terms(const double* x, Index r) const {
    return damping_terms<double>(motion(x, r), normal_of(r), damping(r));
  }
};

// --- Rows: LagView with value(x, row), J, and terms(x, row), MotionTerms.
template <class Rows>
struct MotionValues {
  Rows rows;
  const double* x;
  double* energy;  // [n] J
  BB_HD void operator()(Index r) const { energy[r] = rows.value(x, r); }
};

template <class Rows>
struct MotionGradients {
  Rows rows;
  const double* x;
  double *energy, *force;  // [n] J, [3, n] N
  BB_HD void operator()(Index r) const {
    const MotionTerms<double> terms = rows.terms(x, r);
    energy[r] = terms.energy;
    for (int c = 0; c < 3; ++c) force[c * rows.n + r] = terms.grad[c];
  }
};

/// Number c of [6, n] is entry (row, column) of the lower triangle, column by column.
BB_HD inline int lower_entry(int row, int column) {
  const int high = row > column ? row : column, low = row > column ? column : row;
  return low * (5 - low) / 2 + high;
}

template <class Rows>
struct MotionHessians {
  Rows rows;
  const double* x;
  double* hess;  // [6, n] N/m
  BB_HD void operator()(Index r) const {
    const Mat3d h = rows.terms(x, r).hess;
    int at = 0;
    for (int c = 0; c < 3; ++c) {
      for (int k = c; k < 3; ++k) hess[at++ * rows.n + r] = h(k, c);
    }
  }
};

/// How the forces change, to first order, along a motion of given vertices.
template <class Rows>
struct MotionChanges {
  Rows rows;
  const double *x, *motion;  // [3 n_vertices] m; motion 0 at free vertices
  double* force;             // [3, n] N
  BB_HD void operator()(Index r) const {
    const Vec3d moved = rows.moved(motion, r);
    Vec3d out = Vec3d::Zero();
    if (moved != Vec3d::Zero()) {
      const Mat3d h = rows.terms(x, r).hess;
      out = h * moved;
    }
    for (int c = 0; c < 3; ++c) force[c * rows.n + r] = out[c];
  }
};

/// out [3 n_vertices] += the forces of the rows of each vertex, weighted.
struct GatherMotions {
  LagView rows;
  VertexSlots slots;
  const double* force;  // [3, n] N
  double* out;
  BB_HD void operator()(Index v) const {
    double sum[3] = {0, 0, 0};
    for (Index s = slots.begin[v]; s < slots.begin[v + 1]; ++s) {
      const Index r = slot_row(slots.slot[s]);
      const double weight = rows.weight[slot_point(slots.slot[s]) * rows.n + r];
      for (int c = 0; c < 3; ++c) sum[c] += weight * force[c * rows.n + r];
    }
    for (int c = 0; c < 3; ++c) out[3 * v + c] += sum[c];
  }
};

/// Values of the upper blocks.
struct GatherMotionBlocks {
  LagView rows;
  BlockSources blocks;
  const double* hess;  // [6, n] N/m
  double* value;
  BB_HD void operator()(Index j) const {
    double sum[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    for (Index i = blocks.begin[j]; i < blocks.begin[j + 1]; ++i) {
      const std::uint32_t code = blocks.code[i];
      const Index r = pair_row_of(code);
      const double ww = rows.weight[pair_a(code) * rows.n + r] * rows.weight[pair_b(code) * rows.n + r];
      for (int c = 0; c < 9; ++c) sum[c] += ww * hess[lower_entry(c % 3, c / 3) * rows.n + r];
    }
    for (int c = 0; c < 9; ++c) value[value_index(j, c)] = sum[c];
  }
};

/// The coefficients of all sides: those of bodies, then those of obstacles.
struct SideCoefficients {
  const double* of_body;      // [bodies] 1
  const double* of_obstacle;  // [obstacles]
  CombineRule rule;
  /// Of a row of a pair with these vertices. body: of every vertex.
  BB_HD double of(const RowView& rows, Index r, const int* body) const {
    const double first = of_body[body[rows.vertex[r]]];
    const int list = pair_list(rows.pair[r]);
    if (list >= obstacle_pairs) return combined(rule, first, of_obstacle[pair_second(rows.pair[r])]);
    int last = rows.vertex[r];
    for (int k = 1; k < 4; ++k) {
      const int v = rows.vertex[k * rows.n + r];
      if (v >= 0) last = v;
    }
    return combined(rule, first, of_body[body[last]]);
  }
};

/// load [n]: the force that a row carries, its mollifier included; strength [n]: coefficient times load.
struct LearnLoads {
  RowEnergy contact;  // rows with their barrier, and mollifiers
  SideCoefficients sides;
  const int* body;  // [n_vertices]
  double *load, *strength;
  BB_HD void operator()(Index r) const {
    const RowView& rows = contact.rows;
    load[r] = -rows.force[r];
    if (rows.mollified(r)) load[r] *= contact.mollifier.number[contact.mollifier.of(r)];
    strength[r] = sides.of(rows, r, body) * load[r];
  }
};

/// How far an obstacle has turned, column-major: where the rows are of, and at both ends of the step.
struct ObstacleTurn {
  double lag[9], begin[9], end[9];
  bool turns;
};

/// spin [3, n]: what the turn of its obstacle takes the surface of a row along by in the step, m.
struct FindSpins {
  LagView rows;
  const Key* pair;
  const PlainObstacle* obstacle;
  const ObstacleTurn* turn;
  const double* lagged;  // [3 n_vertices] m, the state that the rows are of
  double* spin;
  BB_HD void operator()(Index r) const {
    Vec3d out = Vec3d::Zero();
    const int o = pair_obstacle(pair[r]);
    if (o >= 0 && turn[o].turns) {
      const double* const x = lagged;
      const Vec3d arm =
          rows.weighted(r, [=](Index v) { return Vec3d(x[3 * v], x[3 * v + 1], x[3 * v + 2]); });
      out = way_of_turn<double>(arm_to_surface<double>(obstacle[o].surface(lagged), arm), matrix(turn[o].lag),
                                matrix(turn[o].begin), matrix(turn[o].end));
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
  Compensated work;  // J
  Key sticking, sliding;
  BB_HD static FrictionNumbers zero() { return {Compensated::zero(), 0, 0}; }
  friend BB_HD FrictionNumbers operator+(const FrictionNumbers& a, const FrictionNumbers& b) {
    return {a.work + b.work, a.sticking + b.sticking, a.sliding + b.sliding};
  }
};
/// Parts of SumParts.
template <class Law>
struct FrictionOfRows {
  using Sum = FrictionNumbers;
  RubbingRows<Law> rows;
  const double* x;
  BB_HD void operator()(Index r, FrictionNumbers& sum) const {
    if (!(rows.strength[r] > 0)) return;
    const double y = rows.slide(x, r).norm();
    sum.work.add(friction_work<double>(y, rows.strength[r], rows.law()));
    (y < rows.eps ? sum.sticking : sum.sliding) += 1;
  }
};

/// Parts of a sum: force times way of restitution, J.
struct DampingOfRows {
  DampingRows rows;
  const double* x;
  BB_HD void operator()(Index r, Compensated& sum) const {
    sum.add(damping_work<double>(rows.motion(x, r), rows.normal_of(r), rows.damping(r)));
  }
};

/// Speeds at which pairs met; pairs ascending.
struct MetPairs {
  const Key* pair;
  const double* speed;  // m/s
  Index n;
};

/// met [n]: the speed at which the pair of each row met. Pairs that were in contact keep it; those that are new meet now, with the
/// speed at which their gap closes.
struct RememberMeeting {
  LagView rows;
  const Key* pair;
  MetPairs known;
  const double* speed;  // [3 n_vertices] m/s, of the step before
  double* met;
  BB_HD void operator()(Index r) const {
    const Index at = first_not_below(known.pair, Index{0}, known.n, pair[r]);
    if (at < known.n && known.pair[at] == pair[r]) {
      met[r] = known.speed[at];
    } else {
      met[r] = -rows.moved(speed, r).dot(rows.normal_of(r));
    }
  }
};

/// strength /= the speed at which the pair of a row met, `least` (m/s) at least.
struct DampByMeeting {
  const double* met;
  double least;
  double* strength;
  BB_HD void operator()(Index r) const { strength[r] /= met[r] < least ? least : met[r]; }
};

/// out = (to - from)/dt.
struct SpeedOfStep {
  const double *to, *from;
  double dt;
  double* out;
  BB_HD void operator()(Index i) const { out[i] = (to[i] - from[i]) / dt; }
};

}  // namespace bb::resident
