// Two-level additive Schwarz: M^-1 = sum R_k^T (R_k A R_k^T)^-1 R_k + P (P^T A P)^-1 P^T. R_k picks the degrees
// of freedom of cluster k, P holds the translations of every cluster. Clusters know contacts, since these are
// in the graph of the matrix. Sources: Toselli, Widlund 2005; multilevel Schwarz for cloth: Wu et al. 2022;
// clusters that contain what touches: Huang et al. 2025 (StiffGIPC).
#include <Eigen/Cholesky>
#include <algorithm>

#include "core/linear/block_starts.hpp"
#include "core/linear/cholmod_factor.hpp"
#include "core/linear/parallel.hpp"
#include "core/linear/pattern_key.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/vertex_clusters.hpp"
#include "core/math/at.hpp"

namespace bb {
namespace {

using Dense = Eigen::Map<Eigen::MatrixXd>;
using ConstDense = Eigen::Map<const Eigen::MatrixXd>;

class Schwarz final : public Preconditioner {
 public:
  explicit Schwarz(int cluster_vertices) : cluster_vertices_(cluster_vertices) {}
  LinearStatus setup(const ReducedSystem& system, const SymmetricProduct& rows) override;
  void apply(const VecXd& r, VecXd& z) const override;
  void keep(Archive& archive) override;
  std::string detail() const override { return detail_; }

 private:
  void build(const ReducedSystem& system, const SymmetricProduct& rows);
  void build_coarse(const ReducedSystem& system, const SymmetricProduct& rows);
  bool factorize_cluster(const SymmetricProduct& rows, int cluster);
  void fill_coarse(const SymmetricProduct& rows);
  int n_local(int cluster) const { return first_[at(cluster) + 1] - first_[at(cluster)]; }

  int cluster_vertices_;
  std::string detail_;
  PatternKey key_;
  VertexClusters clusters_;
  bool built_ = false;               // what follows is of these clusters
  std::vector<int> first_;           // [n_clusters + 1] degrees of freedom before a cluster
  std::vector<int> dof_;             // [n] degree of freedom of the matrix, by cluster
  std::vector<int> place_;           // [n_blocks] of a vertex in the local matrix of its cluster
  std::vector<std::size_t> offset_;  // [n_clusters] of a local matrix in local_
  std::vector<double> local_;        // L of every cluster, column-major
  std::vector<std::uint8_t> failed_;
  ReducedSystem coarse_;
  std::vector<int> coarse_slot_;  // [9 blocks] where a fine entry is summed; -1: above the diagonal or none
  std::vector<int> axis_;         // [n] coarse degree of freedom of each, in the order of dof_
  mutable CholmodFactor coarse_factor_;
  mutable VecXd work_, coarse_r_, coarse_z_;
};

void Schwarz::keep(Archive& archive) {
  archive(key_, clusters_.of, clusters_.start, clusters_.member);
  coarse_factor_.keep(archive);
  if (archive.reads()) built_ = false;
}

// Clusters stay while the pattern stays: couplings of the matrix that came first with it decide.
void Schwarz::build(const ReducedSystem& system, const SymmetricProduct& rows) {
  built_ = true;
  first_.assign(1, 0);
  dof_.clear();
  place_.resize(at(rows.n_blocks()));
  offset_.clear();
  std::size_t n_numbers = 0;
  for (int k = 0; k < clusters_.size(); ++k) {
    for (int m = clusters_.start[at(k)]; m < clusters_.start[at(k) + 1]; ++m) {
      const int v = clusters_.member[at(m)];
      place_[at(v)] = static_cast<int>(dof_.size()) - first_.back();
      for (int i = rows.start()[at(v)]; i < rows.start()[at(v) + 1]; ++i) dof_.push_back(i);
    }
    first_.push_back(static_cast<int>(dof_.size()));
    offset_.push_back(n_numbers);
    n_numbers += at(n_local(k)) * at(n_local(k));
  }
  local_.resize(n_numbers);
  failed_.assign(at(clusters_.size()), 0);
  build_coarse(system, rows);
}

// P^T A P on the translations of the clusters. A cluster has as many as its vertices have degrees of freedom:
// two in a planar scene.
void Schwarz::build_coarse(const ReducedSystem& system, const SymmetricProduct& rows) {
  const int n = clusters_.size();
  std::vector<int> width(at(n), 0);
  const auto size_of = [&rows](int v) { return rows.start()[at(v) + 1] - rows.start()[at(v)]; };
  for (int v = 0; v < rows.n_blocks(); ++v) {
    width[at(clusters_.of[at(v)])] = std::max(width[at(clusters_.of[at(v)])], size_of(v));
  }
  coarse_.block_start.assign(1, 0);
  for (const int w : width) coarse_.block_start.push_back(coarse_.block_start.back() + w);
  const std::vector<int>& begin = coarse_.block_start;
  std::vector<Eigen::Triplet<double>> entries;
  const auto for_entries = [&](const auto& f) {  // f(fine index, coarse row, coarse column) of the lower part
    for (int r = 0; r < rows.n_blocks(); ++r) {
      for (int k = rows.row_start()[at(r)]; k < rows.row_start()[at(r) + 1]; ++k) {
        const int c = rows.column()[at(k)];
        for (int i = 0; i < size_of(r); ++i) {
          for (int j = 0; j < size_of(c); ++j) {
            const int row = begin[at(clusters_.of[at(r)])] + i, column = begin[at(clusters_.of[at(c)])] + j;
            if (row >= column) f(9 * at(k) + at(3 * i + j), row, column);
          }
        }
      }
    }
  };
  for_entries([&](std::size_t, int row, int column) { entries.emplace_back(row, column, 1.0); });
  coarse_.lower.resize(begin.back(), begin.back());
  coarse_.lower.setFromTriplets(entries.begin(), entries.end());
  coarse_.pattern_id = system.pattern_id;  // a change of one is a change of the other
  coarse_slot_.assign(9 * rows.column().size(), -1);
  const int *outer = coarse_.lower.outerIndexPtr(), *inner = coarse_.lower.innerIndexPtr();
  for_entries([&](std::size_t fine, int row, int column) {
    const int* found = std::lower_bound(inner + outer[column], inner + outer[column + 1], row);
    coarse_slot_[fine] = static_cast<int>(found - inner);
  });
  axis_.clear();
  for (const int v : clusters_.member) {
    for (int i = 0; i < size_of(v); ++i) axis_.push_back(begin[at(clusters_.of[at(v)])] + i);
  }
}

bool Schwarz::factorize_cluster(const SymmetricProduct& rows, int cluster) {
  const int n = n_local(cluster);
  Dense a(local_.data() + offset_[at(cluster)], n, n);
  a.setZero();
  for (int m = clusters_.start[at(cluster)]; m < clusters_.start[at(cluster) + 1]; ++m) {
    const int r = clusters_.member[at(m)], rows_of_r = rows.start()[at(r) + 1] - rows.start()[at(r)];
    for (int k = rows.row_start()[at(r)]; k < rows.row_start()[at(r) + 1]; ++k) {
      const int c = rows.column()[at(k)];
      if (clusters_.of[at(c)] != cluster || place_[at(c)] > place_[at(r)]) continue;
      const int columns_of_c = rows.start()[at(c) + 1] - rows.start()[at(c)];
      for (int i = 0; i < rows_of_r; ++i) {
        for (int j = 0; j < columns_of_c; ++j)
          a(place_[at(r)] + i, place_[at(c)] + j) = rows.block(k)[3 * i + j];
      }
    }
  }
  Eigen::Ref<Eigen::MatrixXd> in_place(a);
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(in_place).info() == Eigen::Success;
}

void Schwarz::fill_coarse(const SymmetricProduct& rows) {
  double* value = coarse_.lower.valuePtr();
  std::fill_n(value, coarse_.lower.nonZeros(), 0.0);
  const double* fine = rows.block(0);
  for (std::size_t k = 0; k < coarse_slot_.size(); ++k) {
    if (coarse_slot_[k] >= 0) value[coarse_slot_[k]] += fine[k];
  }
}

LinearStatus Schwarz::setup(const ReducedSystem& system, const SymmetricProduct& rows) {
  detail_ = zero_diagonal_text(system);
  if (!detail_.empty()) {
    detail_ += "schwarz needs positive definite ones";
    return LinearStatus::preconditioner_indefinite;
  }
  const bool known = key_.same_as_last(system);
  if (!known) clusters_ = cluster_vertices(rows, cluster_vertices_);
  if (!known || !built_) build(system, rows);
  parallel_items(clusters_.size(), 1, [&](int k) { failed_[at(k)] = factorize_cluster(rows, k) ? 0 : 1; });
  // R_k A R_k^T and P^T A P are positive definite where A is
  if (std::count(failed_.begin(), failed_.end(), 1) > 0) return LinearStatus::matrix_indefinite;
  fill_coarse(rows);
  return coarse_factor_.factorize(coarse_);
}

void Schwarz::apply(const VecXd& r, VecXd& z) const {
  work_.resize(r.size());
  z.resize(r.size());
  coarse_r_.setZero(coarse_.lower.rows());
  parallel_items(clusters_.size(), 4, [&](int k) {
    const int n = n_local(k), begin = first_[at(k)];
    auto x = work_.segment(begin, n);
    for (int i = 0; i < n; ++i) {
      x[i] = r[dof_[at(begin + i)]];
      coarse_r_[axis_[at(begin + i)]] += x[i];  // of this cluster alone
    }
    const ConstDense l(local_.data() + offset_[at(k)], n, n);
    l.triangularView<Eigen::Lower>().solveInPlace(x);
    l.transpose().triangularView<Eigen::Upper>().solveInPlace(x);
  });
  coarse_factor_.solve(coarse_r_, coarse_z_);
  parallel_items(static_cast<int>(dof_.size()), 4096,
                 [&](int i) { z[dof_[at(i)]] = work_[i] + coarse_z_[axis_[at(i)]]; });
}

}  // namespace

PreconditionerEntry preconditioner_schwarz() {
  PreconditionerEntry entry;
  entry.parameters = {{"cluster_vertices", count(1, 1000), 8,
                       "vertices of a cluster; 16 and 32 save no iterations and cost more"}};
  entry.make = [](const ParameterMap& complete) -> std::unique_ptr<Preconditioner> {
    return std::make_unique<Schwarz>(integer(complete, "cluster_vertices"));
  };
  return entry;
}

}  // namespace bb
