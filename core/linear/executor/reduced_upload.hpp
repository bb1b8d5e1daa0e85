// A reduced system of the host as a matrix in the memory of an executor.
#pragma once

#include "core/exec/buffer.hpp"
#include "core/linear/executor/executor_matrix.hpp"
#include "core/linear/symmetric_product.hpp"

namespace bb::exec {

/// One part; a block row is a vertex with 1 to 3 free degrees of freedom, which come first of its three.
class UploadedSystem {
 public:
  explicit UploadedSystem(Executor& executor);
  /// Cost: O(nonzeros); the pattern goes up only when it changed. Errors: ConfigError as SymmetricProduct::update.
  void update(const ReducedSystem& system);
  /// b [n] of the system as [3 n_vertices], and back.
  void upload(const VecXd& b, Buffer<double>& full) const;
  void download(const Buffer<double>& full, VecXd& x) const;

  Index n_vertices() const { return fixed_.size(); }
  const FixedMask* fixed() const { return fixed_.data(); }
  ExecutorMatrix matrix() const {
    return {{{row_begin_.data(), column_.data(), value_.data()}, {nullptr, nullptr, nullptr}}};
  }
  bool all_finite() const { return rows_.all_finite(); }

 private:
  void update_pattern();

  SymmetricProduct rows_;
  PatternKey key_;
  std::vector<double> packed_;  // [value_count(n_blocks)]
  Buffer<Index> row_begin_;
  Buffer<int> column_;
  Buffer<double> value_;
  Buffer<FixedMask> fixed_;
};

}  // namespace bb::exec
