// Stiffness of rows: a policy's kappa with w^T H w streamed from the blocks of the matrix, and the pairs that have a
// kappa already.
#pragma once

#include "core/barrier/relative_change.hpp"
#include "core/barrier/scaled_policy.hpp"
#include "core/linear/executor/sub_matrix.hpp"
#include "core/resident/contact/compaction_kernels.hpp"
#include "core/resident/contact/resident_rows.hpp"

namespace bb::resident {

struct RowKappaInputs {
  RowView rows;
  const std::uint8_t* missing;  // only rows marked here; null: all
  bool with_hessian;
  StiffnessTime time;
  bool at_d_hat;       // the gap is d_hat
  const double* mass;  // [n_vertices] kg
  MatrixPart elastic;
};

/// kappa of rows by a policy of contacts, P its struct of values.
template <class P>
struct RowKappa : RowKappaInputs {
  ScaledPolicy<P> policy;

  BB_HD void operator()(Index r) const {
    if (missing && missing[r] == 0) return;
    double weight[4], masses[4], normal[3];
    int vertex[4], n = 0;
    for (int k = 0; k < 4; ++k) {
      if (!rows.is_free(r, k)) continue;
      vertex[n] = rows.vertex[k * rows.n + r];
      weight[n] = rows.weight[k * rows.n + r];
      masses[n] = mass[vertex[n]];
      ++n;
    }
    for (int c = 0; c < 3; ++c) normal[c] = rows.normal[c * rows.n + r];
    const SubMatrix h(elastic, vertex, with_hessian ? n : 0);
    const ContactSums<double> sums = contact_sums(n, weight, normal, masses, h, with_hessian);
    const double d_hat = rows.d_hat[r];
    if (rows.per_gap_sq) {
      const KappaParts one = policy.contact_parts(sums, d_hat, time);
      rows.kappa[r] = one.fixed;
      rows.per_gap_sq[r] = one.per_gap_sq;
      return;
    }
    rows.kappa[r] = policy.contact_kappa(sums, at_d_hat ? d_hat : rows.d[r], d_hat, time);
  }
};

/// Pairs that have a kappa, ascending.
struct KnownPairs {
  Index n;
  const Key* pair;
  const double *kappa, *per_gap_sq;  // per_gap_sq null where kappa is one number
};

/// Rows of known pairs get their kappa; the others are marked.
struct RecallKappa {
  RowView rows;
  KnownPairs known;
  std::uint8_t* missing;
  BB_HD void operator()(Index r) const {
    const Index at = first_not_below(known.pair, Index{0}, known.n, rows.pair[r]);
    const bool found = at < known.n && known.pair[at] == rows.pair[r];
    missing[r] = found ? 0 : 1;
    if (!found) return;
    rows.kappa[r] = known.kappa[at];
    if (rows.per_gap_sq) rows.per_gap_sq[r] = known.per_gap_sq[at];
  }
};

/// Where new pairs are compared with nothing: kappa_before of trial rows.
struct NoteKappaBefore {
  RowView rows;
  const std::uint8_t* missing;
  BB_HD void operator()(Index r) const { rows.kappa_before[r] = missing[r] != 0 ? 0.0 : rows.kappa[r]; }
};

/// Largest relative_change of a row's kappa, as the complement of its bits; then kappa is what the next change is
/// against.
struct SettleKappa {
  RowView rows;
  Key* largest;
  BB_HD void operator()(Index r) const {
    const double change = relative_change(rows.kappa_before[r], rows.kappa[r]);
    rows.kappa_before[r] = rows.kappa[r];
    if (change > 0)
      exec::atomic_min(largest, ~exec::ordered_bits(change));  // two infinite kappa: not a number
  }
};

/// Marks rows whose pair is not known.
struct MarkUnknown {
  RowView rows;
  KnownPairs known;
  std::uint8_t* mark;
  BB_HD void operator()(Index r) const {
    const Index at = first_not_below(known.pair, Index{0}, known.n, rows.pair[r]);
    mark[r] = at < known.n && known.pair[at] == rows.pair[r] ? 0 : 1;
  }
};

/// Known pairs move up by the new ones before them.
struct MergeKnown {
  KnownPairs known;
  RowView rows;
  Places fresh;  // of rows that are not known
  Index n_fresh;
  Key* pair;
  double *kappa, *per_gap_sq;
  BB_HD void operator()(Index i) const {
    const Index row = first_not_below(rows.pair, Index{0}, rows.n, known.pair[i]);
    const Index at = i + (row < rows.n ? fresh.of(row) : n_fresh);
    pair[at] = known.pair[i];
    kappa[at] = known.kappa[i];
    if (per_gap_sq) per_gap_sq[at] = known.per_gap_sq[i];
  }
};

/// New pairs go behind the known ones before them.
struct MergeFresh {
  KnownPairs known;
  RowView rows;
  const std::uint8_t* mark;
  Places fresh;
  Key* pair;
  double *kappa, *per_gap_sq;
  BB_HD void operator()(Index r) const {
    if (mark[r] == 0) return;
    const Index at = fresh.of(r) + first_not_below(known.pair, Index{0}, known.n, rows.pair[r]);
    pair[at] = rows.pair[r];
    kappa[at] = rows.kappa[r];
    if (per_gap_sq) per_gap_sq[at] = rows.per_gap_sq[r];
  }
};

/// Pairs with a row at the end of two steps whose gap shrank: no others can make a policy adapt.
struct MarkShrinking {
  RowView rows;
  const Key* pair_before;
  const double* gap_before;
  Index n_before;
  std::uint8_t* mark;
  BB_HD void operator()(Index r) const {
    const Index at = first_not_below(pair_before, Index{0}, n_before, rows.pair[r]);
    mark[r] = at < n_before && pair_before[at] == rows.pair[r] && closes(rows.d[r], gap_before[at]) ? 1 : 0;
  }
};
struct ListShrinking {
  RowView rows;
  const Key* pair_before;
  const double* gap_before;
  Index n_before;
  const std::uint8_t* mark;
  Places places;
  double* out;  // [3 marked] gap, gap before, d_hat
  BB_HD void operator()(Index r) const {
    if (mark[r] == 0) return;
    const Index to = 3 * places.of(r);
    out[to] = rows.d[r];
    out[to + 1] = gap_before[first_not_below(pair_before, Index{0}, n_before, rows.pair[r])];
    out[to + 2] = rows.d_hat[r];
  }
};

}  // namespace bb::resident
