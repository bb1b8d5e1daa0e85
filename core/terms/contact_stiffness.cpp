#include "core/terms/contact_stiffness.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>

#include "core/barrier/gap_stiffness.hpp"

namespace bb {
namespace {

const std::vector<int>& free_vertices(const ContactTable& table) { return table.vertex; }
const std::vector<int>& free_vertices(const MollifiedTable& table) { return table.free_vertex; }

template <class Table>
void set_parts(Table& rows, std::size_t r, const KappaParts& parts) {
  rows.parts[r] = parts;
  rows.kappa[r] = parts.at(rows.d[r]);
}

std::array<StiffnessRows, 2> stiffness_rows(const ContactTables& of) {
  return {stiffness_rows(of.rows), stiffness_rows(of.mollified)};
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

ContactStiffness::Hessian ContactStiffness::hessian_of(const BlockSystem& blocks,
                                                       const BlockSystem::Values& elastic) {
  if (!policy_.needs_hessian()) return {blocks};
  const bool takes = update_.takes_matrix();
  if (!policy_.has_potential()) return {blocks, &elastic};
  if (takes) blocks.element_values(elastic, step_elastic_);
  return {blocks, &step_elastic_, true};
}

void ContactStiffness::Hessian::submatrix(const int* vertices, int k, double* out) const {
  if (of_elements) {
    blocks.element_submatrix(*values, vertices, k, out);
  } else {
    blocks.submatrix(*values, vertices, k, out);
  }
}

template <class Table>
void ContactStiffness::gather(const Table& table, std::span<const int> rows, const Hessian& hessian,
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

// Parts and kappa of the rows that are marked, or of all.
template <class Table>
void ContactStiffness::fill(Table& table, const std::uint8_t* missing, const Hessian& hessian,
                            bool at_d_hat) {
  listed_.clear();
  for (std::size_t r = 0; r < table.size(); ++r) {
    if (!missing || missing[r] != 0) listed_.push_back(static_cast<int>(r));
  }
  if (listed_.empty()) return;
  gather(table, listed_, hessian, at_d_hat);
  const StiffnessBatch batch = columns_.batch(time_, hessian.values != nullptr);
  parts_.assign(listed_.size(), {});
  if (policy_.has_potential()) {
    policy_.fill_parts(batch, parts_.data());
  } else {
    kappa_.resize(listed_.size());
    policy_.fill(batch, kappa_.data());
    for (std::size_t i = 0; i < listed_.size(); ++i) parts_[i].fixed = kappa_[i];
  }
  for (std::size_t i = 0; i < listed_.size(); ++i) {
    const auto r = static_cast<std::size_t>(listed_[i]);
    if (!table.share.empty()) parts_[i].fixed *= table.share[r];
    set_parts(table, r, parts_[i]);
  }
}

void ContactStiffness::Fill::operator()(std::size_t table, const std::uint8_t* missing, bool at_d_hat) const {
  table == 0 ? of.fill(rows.rows, missing, hessian, at_d_hat)
             : of.fill(rows.mollified, missing, hessian, at_d_hat);
}

void ContactStiffness::fill_kappa(const ContactTables& rows) const {
  const GapStiffness* const of_gap = policy_.gap_stiffness();
  const double one = policy_.uniform() ? policy_.state().kappa : 0;
  const auto fill_table = [&](auto& of) {
    double slope = 0;
    for (std::size_t r = 0; r < of.size(); ++r) {
      if (of_gap) of_gap->eval(of.parts[r], of.d_hat[r], 1, &of.d[r], &of.kappa[r], &slope);
      if (policy_.uniform()) set_parts(of, r, {of.share.empty() ? one : one * of.share[r], 0});
    }
  };
  if (!of_gap && !policy_.uniform()) return;
  fill_table(rows.rows);
  fill_table(rows.mollified);
}

double ContactStiffness::refresh(const ContactTables& rows, const BlockSystem& blocks,
                                 const BlockSystem::Values& elastic) {
  const Fill fill{*this, rows, hessian_of(blocks, elastic)};
  update_.refresh(stiffness_rows(rows), std::cref(fill));
  fill_kappa(rows);
  return update_.change();
}

void ContactStiffness::freeze(const ContactTables& trial, const ContactTables& iterate,
                              const BlockSystem& blocks, const BlockSystem::Values& elastic) {
  const Fill fill{*this, trial, hessian_of(blocks, elastic)};
  update_.freeze(stiffness_rows(trial), stiffness_rows(iterate), std::cref(fill));
  fill_kappa(trial);
}

void ContactStiffness::keep(const ContactTables& rows) { update_.keep(stiffness_rows(rows)); }

PolicyColumns ContactStiffness::columns(const ContactTable& rows, int row, const BlockSystem& blocks,
                                        const BlockSystem::Values& elastic) {
  const Hessian hessian{blocks, elastic.empty() ? nullptr : &elastic};
  gather(rows, std::span<const int>(&row, 1), hessian, false);
  return columns_;
}

}  // namespace bb
