#include "core/linear/mas_level.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

#include "core/linear/node_blocks.hpp"
#include "core/linear/parallel.hpp"

namespace bb {
namespace {

using Dense = Eigen::Map<Eigen::MatrixXd>;
using ConstDense = Eigen::Map<const Eigen::MatrixXd>;

}  // namespace

MasLevel::MasLevel(const SymmetricProduct& rows, VertexClusters blocks)
    : start_(rows.start()), row_start_(rows.row_start()), column_(rows.column()), blocks_(std::move(blocks)) {
  place_members();
  find_components();
  make_coarse_graph();
}

MasLevel::MasLevel(const MasLevel& below, int size)
    : start_(below.above_start_),
      row_start_(below.above_row_start_),
      column_(below.above_column_),
      blocks_(consecutive_blocks(below.n_above_, size)) {
  place_members();
  find_components();
  make_coarse_graph();
}

void MasLevel::place_members() {
  place_.resize(at(n_nodes()));
  std::size_t n_numbers = 0;
  block_first_.push_back(0);
  for (int k = 0; k < n_blocks(); ++k) {
    int dofs = 0;
    for (int m = blocks_.start[at(k)]; m < blocks_.start[at(k) + 1]; ++m) {
      const int node = blocks_.member[at(m)];
      place_[at(node)] = dofs;
      dofs += width(node);
    }
    block_first_.push_back(block_first_.back() + dofs);
    offset_.push_back(n_numbers);
    n_numbers += at(dofs) * at(dofs);
  }
  factor_.resize(n_numbers);
  failed_.resize(at(n_blocks()));
  solution_.resize(at(start_.back()));
  work_.resize(at(start_.back()));
}

void MasLevel::find_components() {
  above_.assign(at(n_nodes()), -1);
  std::vector<int> found;
  for (const int seed : blocks_.member) {
    if (above_[at(seed)] >= 0) continue;
    found.assign(1, seed);
    above_[at(seed)] = n_above_;
    for (std::size_t next = 0; next < found.size(); ++next) {
      const int v = found[next];
      for (int k = row_start_[at(v)]; k < row_start_[at(v) + 1]; ++k) {
        const int u = column_[at(k)];
        if (above_[at(u)] >= 0 || blocks_.of[at(u)] != blocks_.of[at(v)]) continue;
        above_[at(u)] = n_above_;
        found.push_back(u);
      }
    }
    ++n_above_;
  }
  std::vector<int> widths(at(n_above_), 0);
  for (int v = 0; v < n_nodes(); ++v) {
    widths[at(above_[at(v)])] = std::max(widths[at(above_[at(v)])], width(v));
  }
  above_start_.assign(1, 0);
  for (const int w : widths) above_start_.push_back(above_start_.back() + w);
  residual_above_.resize(at(above_start_.back()));
}

void MasLevel::make_coarse_graph() {
  std::vector<std::pair<std::int64_t, int>> entries;  // row and column above, block of this matrix
  for (int r = 0; r < n_nodes(); ++r) {
    for (int k = row_start_[at(r)]; k < row_start_[at(r) + 1]; ++k) {
      const std::int64_t row = above_[at(r)], column = above_[at(column_[at(k)])];
      entries.emplace_back(row * n_above_ + column, k);
    }
  }
  std::sort(entries.begin(), entries.end());
  above_row_start_.assign(at(n_above_) + 1, 0);
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const auto [place, k] = entries[e];
    if (e == 0 || place != entries[e - 1].first) {
      ++above_row_start_[at(place / n_above_) + 1];
      above_column_.push_back(static_cast<int>(place % n_above_));
      gather_start_.push_back(static_cast<int>(gather_.size()));
    }
    gather_.push_back(k);
  }
  gather_start_.push_back(static_cast<int>(gather_.size()));
  for (int r = 0; r < n_above_; ++r) above_row_start_[at(r) + 1] += above_row_start_[at(r)];
  coarse_.resize(9 * above_column_.size());
}

bool MasLevel::factorize_block(int block, const double* values) {
  const int n = n_dofs(block);
  Dense a(factor_.data() + offset_[at(block)], n, n);
  a.setZero();
  for (int m = blocks_.start[at(block)]; m < blocks_.start[at(block) + 1]; ++m) {
    const int r = blocks_.member[at(m)];
    for (int k = row_start_[at(r)]; k < row_start_[at(r) + 1]; ++k) {
      const int c = column_[at(k)];
      if (blocks_.of[at(c)] != block || place_[at(c)] > place_[at(r)]) continue;
      const double* v = values + 9 * at(k);
      for (int i = 0; i < width(r); ++i) {
        for (int j = 0; j < width(c); ++j) a(place_[at(r)] + i, place_[at(c)] + j) = v[3 * i + j];
      }
    }
  }
  Eigen::Ref<Eigen::MatrixXd> in_place(a);
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(in_place).info() == Eigen::Success;
}

bool MasLevel::factorize(const double* values) {
  parallel_items(n_blocks(), 1, [&](int k) { failed_[at(k)] = factorize_block(k, values) ? 0 : 1; });
  if (std::count(failed_.begin(), failed_.end(), 1) > 0) return false;
  parallel_items(static_cast<int>(above_column_.size()), 64, [&](int entry) {
    double* sum = coarse_.data() + 9 * at(entry);
    std::fill_n(sum, 9, 0.0);
    for (int g = gather_start_[at(entry)]; g < gather_start_[at(entry) + 1]; ++g) {
      const double* v = values + 9 * at(gather_[at(g)]);
      for (int i = 0; i < 9; ++i) sum[i] += v[i];
    }
  });
  return true;
}

const double* MasLevel::solve(const double* residual) {
  std::fill(residual_above_.begin(), residual_above_.end(), 0.0);
  parallel_items(n_blocks(), 4, [&](int block) {
    const int n = n_dofs(block), first = blocks_.start[at(block)], last = blocks_.start[at(block) + 1];
    Eigen::Map<VecXd> x(work_.data() + block_first_[at(block)], n);
    for (int m = first; m < last; ++m) {
      const int node = blocks_.member[at(m)];
      for (int i = 0; i < width(node); ++i) {
        const double r = residual[start_[at(node)] + i];
        x[place_[at(node)] + i] = r;
        residual_above_[at(above_start_[at(above_[at(node)])] + i)] +=
            r;  // its members are all in this block
      }
    }
    const ConstDense l(factor_.data() + offset_[at(block)], n, n);
    l.triangularView<Eigen::Lower>().solveInPlace(x);
    l.transpose().triangularView<Eigen::Upper>().solveInPlace(x);
    for (int m = first; m < last; ++m) {
      const int node = blocks_.member[at(m)];
      for (int i = 0; i < width(node); ++i) solution_[at(start_[at(node)] + i)] = x[place_[at(node)] + i];
    }
  });
  return residual_above_.data();
}

const double* MasLevel::add(const double* above) {
  if (above != nullptr) {
    parallel_items(n_nodes(), 1024, [&](int node) {
      for (int i = 0; i < width(node); ++i) {
        solution_[at(start_[at(node)] + i)] += above[above_start_[at(above_[at(node)])] + i];
      }
    });
  }
  return solution_.data();
}

}  // namespace bb
