#include "core/linear/ic0.hpp"

#include <cmath>

namespace bb {
namespace {
std::size_t at(int i) { return static_cast<std::size_t>(i); }
}  // namespace

LinearStatus Ic0::setup(const ReducedSystem&, const SymmetricProduct& rows) {
  n_ = rows.n();
  start_.assign(1, 0);
  column_.clear();
  a_.clear();
  for (int i = 0; i < n_; ++i) {
    for (int k = rows.row_start()[at(i)]; k < rows.row_start()[at(i) + 1]; ++k) {
      if (rows.column()[at(k)] > i) break;
      column_.push_back(rows.column()[at(k)]);
      a_.push_back(rows.value()[at(k)]);
    }
    const bool has_diagonal = static_cast<int>(column_.size()) > start_.back() && column_.back() == i;
    if (!has_diagonal || !(a_.back() > 0)) return LinearStatus::matrix_indefinite;
    start_.push_back(static_cast<int>(column_.size()));
  }
  l_.resize(a_.size());
  work_.assign(at(n_), 0.0);
  shifts_ = 0;
  shift_ = 0;
  while (!factorize(shift_)) {
    if (++shifts_ > 8) return LinearStatus::preconditioner_indefinite;
    shift_ = shift_ > 0 ? 4 * shift_ : 1e-3;
  }
  return LinearStatus::ok;
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
