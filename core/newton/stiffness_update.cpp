#include "core/newton/stiffness_update.hpp"

namespace bb {
namespace {

constexpr double unknown = 0;  // as a kappa before: compared with nothing

const std::vector<int>& free_vertices(const ContactTable& table) { return table.vertex; }
const std::vector<int>& free_vertices(const MollifiedTable& table) { return table.free_vertex; }

}  // namespace

StiffnessBatch PolicyColumns::batch(double dt, double c, bool with_hessian) const {
  StiffnessBatch rows;
  rows.n = d.size();
  rows.n_free = n_free.data();
  rows.weight = weight.data();
  rows.normal = normal.data();
  rows.d = d.data();
  rows.d_hat = d_hat.data();
  rows.mass = mass.data();
  rows.hessian = with_hessian ? hessian.data() : nullptr;
  rows.dt = dt;
  rows.c = c;
  return rows;
}

StiffnessUpdate::StiffnessUpdate(StiffnessPolicy& policy, std::span<const double> mass)
    : policy_(policy), mass_(mass) {}

void StiffnessUpdate::set_time(double dt, double c) {
  dt_ = dt;
  c_ = c;
}

template <class Table>
void StiffnessUpdate::gather(const Table& table, std::span<const int> rows, const BlockSystem& blocks,
                             const BlockSystem::Values& elastic, bool at_d_hat, bool with_hessian) {
  const std::size_t n = rows.size();
  columns_.n_free.resize(n);
  columns_.weight.resize(4 * n);
  columns_.mass.resize(4 * n);
  columns_.normal.resize(3 * n);
  columns_.d.resize(n);
  columns_.d_hat.resize(n);
  if (with_hessian) columns_.hessian.resize(144 * n);
  const std::vector<int>& vertices = free_vertices(table);
  for (std::size_t i = 0; i < n; ++i) {
    const auto r = static_cast<std::size_t>(rows[i]);
    columns_.n_free[i] = table.n_free[r];
    for (std::size_t k = 0; k < 4; ++k) {
      const int vertex = vertices[4 * r + k];
      columns_.weight[4 * i + k] = table.weight[4 * r + k];
      columns_.mass[4 * i + k] = vertex < 0 ? 0.0 : mass_[static_cast<std::size_t>(vertex)];
    }
    for (std::size_t k = 0; k < 3; ++k) columns_.normal[3 * i + k] = table.normal[3 * r + k];
    columns_.d_hat[i] = table.d_hat[r];
    columns_.d[i] = at_d_hat ? table.d_hat[r] : table.d[r];
    if (with_hessian) {
      blocks.submatrix(elastic, &vertices[4 * r], table.n_free[r], &columns_.hessian[144 * i]);
    }
  }
}

template <class Table>
void StiffnessUpdate::fill(Table& table, std::span<const int> rows, const BlockSystem& blocks,
                           const BlockSystem::Values& elastic, bool at_d_hat) {
  if (rows.empty()) return;
  const bool with_hessian = policy_.needs_hessian();
  gather(table, rows, blocks, elastic, at_d_hat, with_hessian);
  kappa_.resize(rows.size());
  policy_.fill(columns_.batch(dt_, c_, with_hessian), kappa_.data());
  for (std::size_t i = 0; i < rows.size(); ++i) table.kappa[static_cast<std::size_t>(rows[i])] = kappa_[i];
}

void StiffnessUpdate::fill_missing(ContactTable& rows, MollifiedTable& mollified, const BlockSystem& blocks,
                                   const BlockSystem::Values& elastic, bool at_d_hat) {
  fill(rows, missing_, blocks, elastic, at_d_hat);
  fill(mollified, missing_mollified_, blocks, elastic, at_d_hat);
  memory_.complete(rows, missing_);
}

double StiffnessUpdate::refresh(ContactTable& rows, MollifiedTable& mollified, const BlockSystem& blocks,
                                const BlockSystem::Values& elastic) {
  const bool anew = policy_.refresh() == Refresh::per_iteration;
  before_.clear();
  if (anew && !uniform()) {
    before_.assign(rows.kappa.begin(), rows.kappa.end());
    before_.insert(before_.end(), mollified.kappa.begin(), mollified.kappa.end());
    forget_new(rows.size());
  }
  if (uniform() || anew) memory_.clear();
  memory_.recall(rows, mollified, missing_, missing_mollified_);
  fill_missing(rows, mollified, blocks, elastic, false);
  keep(rows, mollified);
  double change = 0;
  for (std::size_t i = 0; i < before_.size(); ++i) {
    const double now = i < rows.size() ? rows.kappa[i] : mollified.kappa[i - rows.size()];
    change = std::max(change, relative_change(before_[i], now));
  }
  return change;
}

// Rows with a pair that the accepted trial met for the first time had its value at d_hat: no change of
// theirs.
void StiffnessUpdate::forget_new(std::size_t n_rows) {
  for (const int row : missing_) before_[static_cast<std::size_t>(row)] = unknown;
  for (const int row : missing_mollified_) before_[n_rows + static_cast<std::size_t>(row)] = unknown;
}

void StiffnessUpdate::freeze(ContactTable& rows, MollifiedTable& mollified, const BlockSystem& blocks,
                             const BlockSystem::Values& elastic) {
  memory_.recall(rows, mollified, missing_, missing_mollified_);
  fill_missing(rows, mollified, blocks, elastic, true);
}

void StiffnessUpdate::keep(const ContactTable& rows, const MollifiedTable& mollified) {
  if (!uniform()) memory_.store(rows, mollified);
}

PolicyColumns StiffnessUpdate::columns(const ContactTable& rows, int row, const BlockSystem& blocks,
                                       const BlockSystem::Values& elastic) {
  gather(rows, std::span<const int>(&row, 1), blocks, elastic, false, !elastic.empty());
  return columns_;
}

}  // namespace bb
