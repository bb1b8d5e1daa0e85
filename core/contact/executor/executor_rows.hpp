// Contact rows in an executor's memory, one a pair: columns, at most 140 B a row.
#pragma once

#include <vector>

#include "core/barrier/stiffness_policy.hpp"
#include "core/contact/contact_table.hpp"
#include "core/contact/stiffness_rows.hpp"
#include "core/exec/buffer.hpp"
#include "core/math/types.hpp"

namespace bb::exec {

/// What kappa is made of, which reports what columns a policy needs.
enum class KappaColumns {
  uniform,    // one number for all rows: none
  kept,       // one number a row
  compared,   // and what it was before
  potential,  // two numbers a row: fixed + per_gap_sq/d^2
};

/// What kernels read and write of rows; number k of a row is column[k * n + row].
struct RowView {
  Index n;
  int* vertex;                         // [4][n] in role order (p t0 t1 t2, ea0 ea1 eb0 eb1), -1 padded
  double* weight;                      // [4][n] w_i, 0 padded
  double* normal;                      // [3][n] unit, grad_i d = w_i n
  double *d, *d_hat;                   // [n] m
  Key* pair;                           // [n] PairId, ascending
  std::uint8_t* kind;                  // [n] ContactKind or mollified_kind
  std::uint8_t* free;                  // [n] bit k: vertex k is free
  double* kappa;                       // [n] N/m, of a potential its fixed part; null: uniform_kappa
  double* kappa_before;                // [n] N/m, 0: the pair was not there; or null
  double* per_gap_sq;                  // [n] N m; or null
  double uniform_kappa;                // N/m
  double *energy, *force, *stiffness;  // [n] kappa b (J, before any mollifier), kappa b' (N), kappa b'' (N/m)

  BB_HD bool is_free(Index r, int k) const { return (free[r] >> k & 1) != 0; }
  BB_HD int n_free(Index r) const {
    const int f = free[r];
    return (f & 1) + (f >> 1 & 1) + (f >> 2 & 1) + (f >> 3 & 1);
  }
  BB_HD Vec3d normal_of(Index r) const { return Vec3d(normal[r], normal[n + r], normal[2 * n + r]); }
  BB_HD KappaParts parts(Index r) const {
    return {kappa ? kappa[r] : uniform_kappa, per_gap_sq ? per_gap_sq[r] : 0.0};
  }
  BB_HD double kappa_of(Index r) const { return parts(r).at(d[r]); }
  BB_HD bool mollified(Index r) const { return kind[r] == mollified_kind; }
};

/// What is read of rows on the host: identity, gap and force.
struct HostRows {
  std::vector<int> vertex;     // [4][n]
  std::vector<double> weight;  // [4][n]
  std::vector<Key> pair;
  std::vector<std::uint8_t> kind;
  std::vector<double> d, d_hat, force;
  std::size_t size() const { return d.size(); }
  ContactKey key(std::size_t r) const { return key_of(pair[r], &vertex[r], &weight[r], size()); }
};

class ExecutorRows {
 public:
  ExecutorRows(Executor& executor, KappaColumns columns)
      : list(executor, "mollified rows"),
        columns_(columns),
        vertex_(executor, "contact vertices"),
        weight_(executor, "contact weights"),
        normal_(executor, "contact normals"),
        d_(executor, "contact gaps"),
        d_hat_(executor, "contact d_hat"),
        pair_(executor, "contact pairs"),
        kind_(executor, "contact kinds"),
        free_(executor, "contact free vertices"),
        kappa_(executor, "contact kappa"),
        kappa_before_(executor, "contact kappa before"),
        per_gap_sq_(executor, "contact kappa per gap"),
        energy_(executor, "contact energies"),
        force_(executor, "contact b'"),
        stiffness_(executor, "contact b''") {}

  /// Values are lost. Errors: OutOfMemory.
  void resize(Index n) {
    vertex_.fit(4 * n), weight_.fit(4 * n), normal_.fit(3 * n);
    for (auto* column : {&d_, &d_hat_, &energy_, &force_, &stiffness_}) column->fit(n);
    pair_.fit(n), kind_.fit(n), free_.fit(n);
    if (columns_ != KappaColumns::uniform) kappa_.fit(n);
    if (columns_ == KappaColumns::compared) kappa_before_.fit(n);
    if (columns_ == KappaColumns::potential) per_gap_sq_.fit(n);
  }
  void swap(ExecutorRows& other) noexcept {
    for (auto column :
         {&ExecutorRows::weight_, &ExecutorRows::normal_, &ExecutorRows::d_, &ExecutorRows::d_hat_,
          &ExecutorRows::kappa_, &ExecutorRows::kappa_before_, &ExecutorRows::per_gap_sq_,
          &ExecutorRows::energy_, &ExecutorRows::force_, &ExecutorRows::stiffness_}) {
      (this->*column).swap(other.*column);
    }
    vertex_.swap(other.vertex_), pair_.swap(other.pair_), kind_.swap(other.kind_), free_.swap(other.free_);
    list.swap(other.list);
    std::swap(uniform_kappa, other.uniform_kappa), std::swap(min_gap, other.min_gap);
    std::swap(n_slots, other.n_slots), std::swap(n_contributions, other.n_contributions);
  }
  /// Hands over the columns that only one of two tables needs at a time: those that gradients and matrix read.
  void lend(ExecutorRows& other) noexcept {
    for (auto column :
         {&ExecutorRows::weight_, &ExecutorRows::normal_, &ExecutorRows::force_, &ExecutorRows::stiffness_}) {
      (this->*column).swap(other.*column);
    }
  }
  /// Gives all memory back.
  void free() {
    for (auto* column : {&weight_, &normal_, &d_, &d_hat_, &kappa_, &kappa_before_, &per_gap_sq_, &energy_,
                         &force_, &stiffness_}) {
      column->free();
    }
    vertex_.free(), pair_.free(), kind_.free(), free_.free(), list.free();
  }
  Index size() const { return d_.size(); }
  KappaColumns columns() const { return columns_; }
  RowView view() {
    const auto used = [this](Buffer<double>& column) {
      return column.size() == size() ? column.data() : nullptr;
    };
    return {size(),
            vertex_.data(),
            weight_.data(),
            normal_.data(),
            d_.data(),
            d_hat_.data(),
            pair_.data(),
            kind_.data(),
            free_.data(),
            columns_ == KappaColumns::uniform ? nullptr : used(kappa_),
            columns_ == KappaColumns::compared ? used(kappa_before_) : nullptr,
            columns_ == KappaColumns::potential ? used(per_gap_sq_) : nullptr,
            uniform_kappa,
            energy_.data(),
            force_.data(),
            stiffness_.data()};
  }
  /// Requires columns that are not uniform.
  StiffnessRows stiffness_rows() {
    const RowView rows = view();
    return {rows.n, rows.pair, rows.d, rows.kappa, rows.per_gap_sq, 1, nullptr, rows.kappa_before};
  }
  bool feasible() const { return min_gap > 0; }
  /// Cost: a copy of 81 bytes a row.
  HostRows on_host() const {
    return {vertex_.download(), weight_.download(), pair_.download(), kind_.download(),
            d_.download(),      d_hat_.download(),  force_.download()};
  }

  Buffer<std::uint32_t> list;  // numbers of the mollified rows, ascending
  double uniform_kappa = 0;    // N/m
  double min_gap = 0;          // m; infinity without rows
  Index n_slots = 0;           // free points of all rows
  Index n_contributions = 0;   // and pairs a <= b of them, of one row each

 private:
  KappaColumns columns_;
  Buffer<int> vertex_;
  Buffer<double> weight_, normal_, d_, d_hat_;
  Buffer<Key> pair_;
  Buffer<std::uint8_t> kind_, free_;
  Buffer<double> kappa_, kappa_before_, per_gap_sq_, energy_, force_, stiffness_;
};

}  // namespace bb::exec
