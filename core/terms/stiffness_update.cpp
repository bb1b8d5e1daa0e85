#include "core/terms/stiffness_update.hpp"

#include "core/barrier/gap_stiffness.hpp"

namespace bb {
namespace {

const std::vector<int>& free_vertices(const ContactTable& table) { return table.vertex; }
const std::vector<int>& free_vertices(const MollifiedTable& table) { return table.free_vertex; }

/// Largest relative_change of a row since its iterate was accepted; from now on the rows are compared with
/// what they have now, so that an iterate that is kept has not changed.
template <class Table>
double settle(Table& rows) {
  double change = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    change = std::max(change, relative_change(rows.kappa_before[r], rows.kappa[r]));
  }
  rows.kappa_before = rows.kappa;
  return change;
}

/// A row with a pair that no iterate had before has the value at d_hat: it is compared with nothing.
template <class Table>
void note_before(Table& rows, std::span<const int> missing) {
  rows.kappa_before = rows.kappa;
  for (const int row : missing) rows.kappa_before[static_cast<std::size_t>(row)] = 0;
}

/// kappa of rows whose parts are what a policy with another function of the gap has frozen.
template <class Table>
void fill_kappa(const GapStiffness& of, Table& rows) {
  double slope = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    of.eval(rows.parts[r], rows.d_hat[r], 1, &rows.d[r], &rows.kappa[r], &slope);
  }
}

}  // namespace

StiffnessBatch PolicyColumns::batch(const StiffnessTime& time, bool with_hessian) const {
  StiffnessBatch rows;
  rows.n = d.size();
  rows.n_free = n_free.data();
  rows.weight = weight.data();
  rows.normal = normal.data();
  rows.d = d.data();
  rows.d_hat = d_hat.data();
  rows.mass = mass.data();
  rows.hessian = with_hessian ? hessian.data() : nullptr;
  rows.time = time;
  return rows;
}

StiffnessUpdate::StiffnessUpdate(StiffnessPolicy& policy, std::span<const double> mass)
    : policy_(policy), mass_(mass) {}

void StiffnessUpdate::begin_step() {
  memory_.clear();
  has_step_elastic_ = false;
}

StiffnessUpdate::Hessian StiffnessUpdate::hessian_of(const BlockSystem& blocks,
                                                     const BlockSystem::Values& elastic) {
  if (!policy_.needs_hessian()) return {blocks};
  if (!policy_.has_potential()) return {blocks, &elastic};
  if (!has_step_elastic_) blocks.element_values(elastic, step_elastic_);
  has_step_elastic_ = true;
  return {blocks, &step_elastic_, true};
}

void StiffnessUpdate::Hessian::submatrix(const int* vertices, int k, double* out) const {
  if (of_elements) {
    blocks.element_submatrix(*values, vertices, k, out);
  } else {
    blocks.submatrix(*values, vertices, k, out);
  }
}

template <class Table>
void StiffnessUpdate::gather(const Table& table, std::span<const int> rows, const Hessian& hessian,
                             bool at_d_hat) {
  const std::size_t n = rows.size();
  columns_.n_free.resize(n);
  columns_.weight.resize(4 * n);
  columns_.mass.resize(4 * n);
  columns_.normal.resize(3 * n);
  columns_.d.resize(n);
  columns_.d_hat.resize(n);
  if (hessian.values) columns_.hessian.resize(144 * n);
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
    if (hessian.values) hessian.submatrix(&vertices[4 * r], table.n_free[r], &columns_.hessian[144 * i]);
  }
}

// Parts and kappa of these rows.
template <class Table>
void StiffnessUpdate::fill(Table& table, std::span<const int> rows, const Hessian& hessian, bool at_d_hat) {
  if (rows.empty()) return;
  gather(table, rows, hessian, at_d_hat);
  const StiffnessBatch batch = columns_.batch(time_, hessian.values != nullptr);
  parts_.assign(rows.size(), {});
  if (policy_.has_potential()) {
    policy_.fill_parts(batch, parts_.data());
  } else {
    kappa_.resize(rows.size());
    policy_.fill(batch, kappa_.data());
    for (std::size_t i = 0; i < rows.size(); ++i) parts_[i].fixed = kappa_[i];
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto r = static_cast<std::size_t>(rows[i]);
    if (!table.share.empty()) parts_[i].fixed *= table.share[r];
    table.parts[r] = parts_[i];
    table.kappa[r] = parts_[i].at(table.d[r]);
  }
}

void StiffnessUpdate::fill_missing(ContactTable& rows, MollifiedTable& mollified, const BlockSystem& blocks,
                                   const BlockSystem::Values& elastic, bool at_d_hat) {
  const Hessian hessian = hessian_of(blocks, elastic);
  fill(rows, missing_, hessian, at_d_hat);
  fill(mollified, missing_mollified_, hessian, at_d_hat);
  if (const GapStiffness* of = policy_.gap_stiffness()) {
    fill_kappa(*of, rows);
    fill_kappa(*of, mollified);
  }
}

double StiffnessUpdate::refresh(ContactTable& rows, MollifiedTable& mollified, const BlockSystem& blocks,
                                const BlockSystem::Values& elastic) {
  const bool anew = !policy_.frozen_in_step();
  if (policy_.uniform() || anew) memory_.clear();
  memory_.recall(rows, mollified, missing_, missing_mollified_);
  fill_missing(rows, mollified, blocks, elastic, false);
  keep(rows, mollified);
  if (!anew) return 0;
  return std::max(settle(rows), settle(mollified));
}

void StiffnessUpdate::freeze(ContactTable& rows, MollifiedTable& mollified, const BlockSystem& blocks,
                             const BlockSystem::Values& elastic) {
  memory_.recall(rows, mollified, missing_, missing_mollified_);
  fill_missing(rows, mollified, blocks, elastic, true);
  note_before(rows, missing_);
  note_before(mollified, missing_mollified_);
  if (policy_.has_potential()) keep(rows, mollified);
}

void StiffnessUpdate::keep(const ContactTable& rows, const MollifiedTable& mollified) {
  if (!policy_.uniform()) memory_.store(rows, mollified);
}

PolicyColumns StiffnessUpdate::columns(const ContactTable& rows, int row, const BlockSystem& blocks,
                                       const BlockSystem::Values& elastic) {
  const Hessian hessian{blocks, elastic.empty() ? nullptr : &elastic};
  gather(rows, std::span<const int>(&row, 1), hessian, false);
  return columns_;
}

}  // namespace bb
