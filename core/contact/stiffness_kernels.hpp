// The stiffness of contact rows by their pairs: kernels behind stiffness_update.hpp.
#pragma once

#include "core/barrier/relative_change.hpp"
#include "core/contact/stiffness_rows.hpp"
#include "core/exec/sums/compaction_kernels.hpp"
#include "core/exec/sums/search.hpp"

namespace bb {

/// Pairs whose stiffness is known, ascending; the parts of pair i at by * i.
struct KnownPairs {
  Index n = 0;
  const PairId* pair = nullptr;
  const double *fixed = nullptr, *per_gap_sq = nullptr;  // per_gap_sq null where kappa is one number
  Index by = 1;

  /// Of a pair; -1: it is not known.
  BB_HD Index find(PairId wanted) const {
    const Index at = first_not_below(wanted);
    return at < n && pair[at] == wanted ? at : -1;
  }
  BB_HD Index first_not_below(PairId wanted) const {
    return exec::first_not_below(pair, Index{0}, n, wanted);
  }
  BB_HD KappaParts parts(Index at) const { return {fixed[by * at], per_gap_sq ? per_gap_sq[by * at] : 0.0}; }
};

/// Rows of known pairs get their parts; the others are marked.
struct RecallKappa {
  StiffnessRows rows;
  KnownPairs known[2];  // of which no pair is in both
  std::uint8_t* missing;
  BB_HD void operator()(Index r) const {
    missing[r] = 1;
    for (const KnownPairs& of : known) {
      const Index at = of.find(rows.pair[r]);
      if (at < 0) continue;
      rows.set(r, of.parts(at));
      missing[r] = 0;
    }
  }
};

/// Where new pairs are compared with nothing: kappa_before of trial rows.
struct NoteKappaBefore {
  StiffnessRows rows;
  const std::uint8_t* missing;
  BB_HD void operator()(Index r) const { rows.kappa_before[r] = missing[r] != 0 ? 0.0 : rows.parts(r).fixed; }
};

/// Largest relative_change of a row's kappa, as the complement of its bits; then kappa is what the next change is
/// against.
struct SettleKappa {
  StiffnessRows rows;
  exec::Key* largest;
  BB_HD void operator()(Index r) const {
    const double kappa = rows.parts(r).fixed, change = relative_change(rows.kappa_before[r], kappa);
    rows.kappa_before[r] = kappa;
    if (change > 0)
      exec::atomic_min(largest, ~exec::ordered_bits(change));  // two infinite kappa: not a number
  }
};

/// Marks rows whose pair is not known.
struct MarkUnknown {
  StiffnessRows rows;
  KnownPairs known;
  std::uint8_t* mark;
  BB_HD void operator()(Index r) const { mark[r] = known.find(rows.pair[r]) < 0 ? 1 : 0; }
};

/// Where pairs and their parts go.
struct KnownPlaces {
  PairId* pair;
  double *fixed, *per_gap_sq;
  BB_HD void put(Index at, PairId of, const KappaParts& parts) const {
    pair[at] = of;
    fixed[at] = parts.fixed;
    if (per_gap_sq) per_gap_sq[at] = parts.per_gap_sq;
  }
};

/// Known pairs move up by the new ones before them.
struct MergeKnown {
  KnownPairs known;
  StiffnessRows rows;
  exec::Places fresh;  // of rows that are not known
  Index n_fresh;
  KnownPlaces to;
  BB_HD void operator()(Index i) const {
    const Index row = exec::first_not_below(rows.pair, Index{0}, rows.n, known.pair[i]);
    to.put(i + (row < rows.n ? fresh.of(row) : n_fresh), known.pair[i], known.parts(i));
  }
};

/// New pairs go behind the known ones before them.
struct MergeFresh {
  KnownPairs known;
  StiffnessRows rows;
  const std::uint8_t* mark;
  exec::Places fresh;
  KnownPlaces to;
  BB_HD void operator()(Index r) const {
    if (mark[r] == 0) return;
    to.put(fresh.of(r) + known.first_not_below(rows.pair[r]), rows.pair[r], rows.parts(r));
  }
};

}  // namespace bb
