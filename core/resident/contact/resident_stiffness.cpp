#include "core/resident/contact/resident_stiffness.hpp"

#include "core/barrier/launches.hpp"
#include "core/math/error.hpp"

namespace bb::resident {

void require_kernel(const StiffnessPolicy& policy, const std::string& where) {
  if (policy.uniform() || (policy.launches() && policy.launches()->rows)) return;
  throw ConfigError(where, std::string(policy.name()), host_policy_words);
}

ResidentStiffness::ResidentStiffness(exec::Executor& executor, const StiffnessPolicy& policy,
                                     std::span<const double> mass)
    : executor_(executor),
      policy_(policy),
      mass_(executor, "vertex masses"),
      missing_(executor, "rows without kappa"),
      known_pair_(executor, "known pairs"),
      known_kappa_(executor, "known kappa"),
      known_per_gap_(executor, "known kappa per gap"),
      change_(executor) {
  require_kernel(policy, "/formulation/stiffness_policy/name");
  if (!policy.uniform()) mass_.upload(mass);
}

KnownPairs ResidentStiffness::memory() const {
  return {n_known_, known_pair_.data(), known_kappa_.data(),
          policy_.has_potential() ? known_per_gap_.data() : nullptr};
}

void ResidentStiffness::compute(ResidentRows& rows, const std::uint8_t* missing, bool at_d_hat,
                                const MatrixPart& elastic) {
  policy_.launches()->rows(
      executor_, policy_,
      {rows.view(), missing, policy_.needs_hessian(), time_, at_d_hat, mass_.data(), elastic});
}

void ResidentStiffness::recall_and_compute(ResidentRows& rows, const KnownPairs& known, bool at_d_hat,
                                           const MatrixPart& elastic) {
  std::uint8_t* const missing = missing_.counts(rows.size());
  executor_.each(rows.size(), RecallKappa{rows.view(), known, missing});
  compute(rows, missing, at_d_hat, elastic);
}

void ResidentStiffness::refresh(ResidentRows& rows, const MatrixPart& elastic) {
  rows.uniform_kappa = uniform_kappa_;
  compares_ = false;
  if (policy_.uniform() || rows.size() == 0) return;
  if (!rows_are_memory()) {
    recall_and_compute(rows, memory(), false, elastic);
    return keep(rows);
  }
  compute(rows, nullptr, false, elastic);
  change_.fill(0xff);  // no change
  executor_.each(rows.size(), SettleKappa{rows.view(), change_.to_write()});
  compares_ = !executor_.counts_only();
}

double ResidentStiffness::change() const { return compares_ ? exec::from_ordered_bits(~change_.get()) : 0; }

void ResidentStiffness::freeze(ResidentRows& trial, ResidentRows& iterate, const MatrixPart& elastic) {
  trial.uniform_kappa = uniform_kappa_;
  if (policy_.uniform() || trial.size() == 0) return;
  const RowView from = iterate.view();
  recall_and_compute(trial, rows_are_memory() ? KnownPairs{from.n, from.pair, from.kappa, nullptr} : memory(),
                     true, elastic);
  if (rows_are_memory()) {
    executor_.each(trial.size(), NoteKappaBefore{trial.view(), missing_.counts(trial.size())});
  }
  if (policy_.has_potential()) keep(trial);
}

void ResidentStiffness::keep(ResidentRows& rows) {
  if (policy_.uniform() || rows_are_memory() || rows.size() == 0) return;
  const RowView view = rows.view();
  const KnownPairs known = memory();
  std::uint8_t* const mark = missing_.counts(rows.size());
  executor_.each(rows.size(), MarkUnknown{view, known, mark});
  const Index n_fresh = missing_.rank(n_known_ == 0 ? rows.size() : 0);
  if (n_fresh == 0) return;
  const Index n = n_known_ + n_fresh;
  exec::Buffer<Key> pair(executor_, "known pairs", n);
  exec::Buffer<double> kappa(executor_, "known kappa", n), per_gap(executor_, "known kappa per gap");
  if (policy_.has_potential()) per_gap.resize(n);
  double* const per_gap_sq = policy_.has_potential() ? per_gap.data() : nullptr;
  executor_.each(n_known_,
                 MergeKnown{known, view, missing_.places(), n_fresh, pair.data(), kappa.data(), per_gap_sq});
  executor_.each(rows.size(),
                 MergeFresh{known, view, mark, missing_.places(), pair.data(), kappa.data(), per_gap_sq});
  executor_.synchronize();
  known_pair_.swap(pair), known_kappa_.swap(kappa), known_per_gap_.swap(per_gap);
  n_known_ = n;
}

StepEndGaps::StepEndGaps(exec::Executor& executor)
    : executor_(executor),
      pair_(executor, "pairs at the step end"),
      gap_(executor, "gaps at the step end"),
      shrinking_(executor, "shrinking pairs") {}

std::vector<StiffnessPolicy::PairEnd> StepEndGaps::end_step(ResidentRows& rows, double park) {
  const RowView view = rows.view();
  std::vector<StiffnessPolicy::PairEnd> out;
  if (view.n > 0 && pair_.size() > 0) {
    std::uint8_t* const mark = shrinking_.counts(view.n);
    executor_.each(view.n, MarkShrinking{view, pair_.data(), gap_.data(), pair_.size(), mark});
    const Index n = shrinking_.rank(view.n);
    exec::Buffer<double> list(executor_, "shrinking gaps", 3 * n);
    executor_.each(view.n, ListShrinking{view, pair_.data(), gap_.data(), pair_.size(), mark,
                                         shrinking_.places(), list.data()});
    const std::vector<double> numbers = executor_.counts_only() ? std::vector<double>{} : list.download();
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
      out.push_back({numbers[i], numbers[i + 1], park * numbers[i + 2]});
    }
  }
  pair_.resize(view.n), gap_.resize(view.n);
  executor_.copy(pair_.data(), view.pair, static_cast<std::size_t>(view.n) * sizeof(Key));
  executor_.copy(gap_.data(), view.d, static_cast<std::size_t>(view.n) * sizeof(double));
  return out;
}

KnownStiffness ResidentStiffness::known() const {
  KnownStiffness out;
  if (n_known_ == 0 || rows_are_memory()) return out;
  const auto n = static_cast<std::size_t>(n_known_);
  out.pair = known_pair_.download();
  out.pair.resize(n);
  const std::vector<double> fixed = known_kappa_.download();
  const std::vector<double> per_gap_sq =
      policy_.has_potential() ? known_per_gap_.download() : std::vector<double>(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) out.parts.push_back({fixed[i], per_gap_sq[i]});
  return out;
}

void StepEndGaps::download(std::vector<Key>& pair, std::vector<double>& gap) const {
  pair = pair_.download();
  gap = gap_.download();
}

void StepEndGaps::upload(const std::vector<Key>& pair, const std::vector<double>& gap) {
  pair_.upload(pair);
  gap_.upload(gap);
}

}  // namespace bb::resident
