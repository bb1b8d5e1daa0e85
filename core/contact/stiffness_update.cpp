#include "core/contact/stiffness_update.hpp"

namespace bb {

StiffnessUpdate::StiffnessUpdate(exec::Executor& executor, const StiffnessPolicy& policy)
    : executor_(executor),
      policy_(policy),
      missing_(executor, "rows without kappa"),
      known_(executor),
      merged_(executor),
      change_(executor) {}

bool StiffnessUpdate::takes_matrix() {
  if (!policy_.needs_hessian() || (policy_.has_potential() && has_matrix_)) return false;
  return has_matrix_ = true;
}

KnownPairs StiffnessUpdate::memory() const {
  return {n_known_, known_.pair.data(), known_.fixed.data(),
          policy_.has_potential() ? known_.per_gap.data() : nullptr};
}

void StiffnessUpdate::refresh(Tables rows, const Compute& compute) {
  compares_ = false;
  rows_have_kappa_ = true;
  if (policy_.uniform()) return;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    const StiffnessRows& of = rows[t];
    if (of.n == 0) continue;
    if (!rows_are_memory()) {
      std::uint8_t* const missing = missing_.counts(of.n);
      executor_.each(of.n, RecallKappa{of, {memory(), {}}, missing});
      compute(t, missing, false);
      keep(of);
      continue;
    }
    compute(t, nullptr, false);
    if (!compares_) change_.fill(0xff);  // no change
    executor_.each(of.n, SettleKappa{of, change_.to_write()});
    compares_ = !executor_.counts_only();
  }
}

double StiffnessUpdate::change() const { return compares_ ? exec::from_ordered_bits(~change_.get()) : 0; }

void StiffnessUpdate::freeze(Tables trial, Tables iterate, const Compute& compute) {
  if (policy_.uniform()) return;
  for (std::size_t t = 0; t < trial.size(); ++t) {
    const StiffnessRows& of = trial[t];
    if (of.n == 0) continue;
    RecallKappa recall{of, {}, missing_.counts(of.n)};
    if (!rows_are_memory()) recall.known[0] = memory();
    for (std::size_t k = 0; rows_are_memory() && rows_have_kappa_ && k < iterate.size(); ++k)
      recall.known[k] = {iterate[k].n, iterate[k].pair, iterate[k].fixed, nullptr, iterate[k].by};
    executor_.each(of.n, recall);
    compute(t, recall.missing, true);
    if (rows_are_memory()) executor_.each(of.n, NoteKappaBefore{of, recall.missing});
    if (policy_.has_potential()) keep(of);
  }
}

void StiffnessUpdate::keep(Tables rows) {
  rows_have_kappa_ = true;
  if (policy_.uniform() || rows_are_memory()) return;
  for (const StiffnessRows& of : rows) keep(of);
}

void StiffnessUpdate::keep(const StiffnessRows& rows) {
  if (rows.n == 0) return;
  const KnownPairs known = memory();
  std::uint8_t* const mark = missing_.counts(rows.n);
  executor_.each(rows.n, MarkUnknown{rows, known, mark});
  const Index n_fresh = missing_.rank(n_known_ == 0 ? rows.n : 0);
  if (n_fresh == 0) return;
  const Index n = n_known_ + n_fresh;
  merged_.pair.fit(n), merged_.fixed.fit(n);
  if (policy_.has_potential()) merged_.per_gap.fit(n);
  const KnownPlaces to{merged_.pair.data(), merged_.fixed.data(),
                       policy_.has_potential() ? merged_.per_gap.data() : nullptr};
  executor_.each(n_known_, MergeKnown{known, rows, missing_.places(), n_fresh, to});
  executor_.each(rows.n, MergeFresh{known, rows, mark, missing_.places(), to});
  known_.pair.swap(merged_.pair), known_.fixed.swap(merged_.fixed), known_.per_gap.swap(merged_.per_gap);
  n_known_ = n;
}

KnownStiffness StiffnessUpdate::known() const {
  KnownStiffness out;
  if (n_known_ == 0) return out;
  const auto n = static_cast<std::size_t>(n_known_);
  out.pair = known_.pair.download();
  out.pair.resize(n);
  const std::vector<double> fixed = known_.fixed.download();
  const std::vector<double> per_gap_sq =
      policy_.has_potential() ? known_.per_gap.download() : std::vector<double>(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) out.parts.push_back({fixed[i], per_gap_sq[i]});
  return out;
}

void StiffnessUpdate::adopt(const KnownStiffness& known) {
  n_known_ = static_cast<Index>(known.pair.size());
  std::vector<double> fixed, per_gap_sq;
  for (const KappaParts& parts : known.parts) {
    fixed.push_back(parts.fixed);
    per_gap_sq.push_back(parts.per_gap_sq);
  }
  known_.pair.upload(known.pair);
  known_.fixed.upload(fixed);
  known_.per_gap.upload(per_gap_sq);
}

}  // namespace bb
