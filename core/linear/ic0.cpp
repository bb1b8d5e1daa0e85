#include "core/linear/ic0.hpp"

#include <cmath>

#include "core/linear/block_starts.hpp"
#include "core/math/at.hpp"

namespace bb {
LinearStatus Ic0::setup(const ReducedSystem& system, const SymmetricProduct&) {
  if (!key_.same_as_last(system)) build_rows(system.lower);
  const double* value = system.lower.valuePtr();
  for (std::size_t k = 0; k < a_.size(); ++k) a_[k] = value[source_[k]];
  shifts_ = 0;
  shift_ = 0;
  if (const LinearStatus status = check_diagonal(system); status != LinearStatus::ok) return status;
  work_.assign(at(n_), 0.0);
  while (!factorize(shift_)) {
    if (++shifts_ > 8) return LinearStatus::preconditioner_indefinite;
    shift_ = shift_ > 0 ? 4 * shift_ : 1e-3;
  }
  return LinearStatus::ok;
}

// Columns in ascending order, so that rows are ascending too.
void Ic0::build_rows(const Eigen::SparseMatrix<double>& lower) {
  n_ = static_cast<int>(lower.rows());
  const int *outer = lower.outerIndexPtr(), *inner = lower.innerIndexPtr();
  const auto n_entries = static_cast<std::size_t>(lower.nonZeros());
  start_.assign(at(n_) + 1, 0);
  for (std::size_t k = 0; k < n_entries; ++k) ++start_[at(inner[k]) + 1];
  for (int i = 0; i < n_; ++i) start_[at(i) + 1] += start_[at(i)];
  cursor_.assign(start_.begin(), start_.end() - 1);
  column_.resize(n_entries);
  source_.resize(n_entries);
  a_.resize(n_entries);
  l_.resize(n_entries);
  for (int j = 0; j < n_; ++j) {
    for (int k = outer[j]; k < outer[j + 1]; ++k) {
      const int slot = cursor_[at(inner[k])]++;
      column_[at(slot)] = j;
      source_[at(slot)] = k;
    }
  }
}

LinearStatus Ic0::check_diagonal(const ReducedSystem& system) {
  detail_.clear();
  for (int i = 0; i < n_; ++i) {
    const int last = start_[at(i) + 1] - 1;
    const double diagonal = last >= start_[at(i)] && column_[at(last)] == i ? a_[at(last)] : 0;
    if (diagonal < 0) return LinearStatus::matrix_indefinite;
    if (diagonal == 0 && detail_.empty()) {
      detail_ = bad_diagonal_text(system, i) + "ic0 needs a positive diagonal";
    }
  }
  return detail_.empty() ? LinearStatus::ok : LinearStatus::preconditioner_indefinite;
}

bool Ic0::factorize(double shift) {
  for (int i = 0; i < n_; ++i) {
    const int begin = start_[at(i)], diagonal = start_[at(i) + 1] - 1;
    double pivot = a_[at(diagonal)] * (1 + shift);
    for (int k = begin; k < diagonal; ++k) {
      const int j = column_[at(k)], j_diagonal = start_[at(j) + 1] - 1;
      double sum = a_[at(k)];
      for (int q = start_[at(j)]; q < j_diagonal; ++q) sum -= work_[at(column_[at(q)])] * l_[at(q)];
      sum /= l_[at(j_diagonal)];
      l_[at(k)] = work_[at(j)] = sum;
      pivot -= sum * sum;
    }
    for (int k = begin; k < diagonal; ++k) work_[at(column_[at(k)])] = 0;
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    l_[at(diagonal)] = std::sqrt(pivot);
  }
  return true;
}

void Ic0::apply(const VecXd& r, VecXd& z) const {
  z = r;
  for (int i = 0; i < n_; ++i) {
    const int diagonal = start_[at(i) + 1] - 1;
    double sum = z[i];
    for (int k = start_[at(i)]; k < diagonal; ++k) sum -= l_[at(k)] * z[column_[at(k)]];
    z[i] = sum / l_[at(diagonal)];
  }
  for (int i = n_ - 1; i >= 0; --i) {
    const int diagonal = start_[at(i) + 1] - 1;
    const double zi = z[i] /= l_[at(diagonal)];
    for (int k = start_[at(i)]; k < diagonal; ++k) z[column_[at(k)]] -= l_[at(k)] * zi;
  }
}

PreconditionerEntry preconditioner_ic0() {
  PreconditionerEntry entry;
  entry.make = [](const ParameterMap&) -> std::unique_ptr<Preconditioner> { return std::make_unique<Ic0>(); };
  return entry;
}

}  // namespace bb
