// Systems of the tests of the linear solver of the device backend in an executor's memory.
#pragma once

#include <memory>
#include <vector>

#include "core/exec/buffer.hpp"
#include "core/exec/host_executor.hpp"
#include "core/linear/executor/executor_pcg.hpp"
#include "tests/linear/systems.hpp"

namespace bb::exec {

/// A part whose buffers live as long as it does.
struct OwnedPart {
  OwnedPart(Executor& executor, const std::vector<Index>& row_begin, const std::vector<int>& column,
            const std::vector<Mat3d>& block);
  MatrixPart view() const { return {row_begin.data(), column.data(), value.data()}; }
  Buffer<Index> row_begin;
  Buffer<int> column;
  Buffer<double> value;
};

/// The matrix of a dense-able system over full degrees of freedom, 3 a vertex, some fixed.
class OwnedSystem {
 public:
  /// split: every block is in a random part or shared among all.
  OwnedSystem(Executor& executor, const ReducedSystem& system, std::vector<FixedMask> fixed, bool split);
  ExecutorMatrix matrix() const;
  Index n() const { return fixed.size(); }

  std::vector<FixedMask> mask;
  Buffer<FixedMask> fixed;

 private:
  std::vector<std::unique_ptr<OwnedPart>> parts_;
};

/// The dense matrix with rows and columns of fixed degrees of freedom those of the identity.
Eigen::MatrixXd restricted(const ReducedSystem& system, const std::vector<FixedMask>& fixed);
VecXd restricted(const VecXd& b, const std::vector<FixedMask>& fixed);

inline std::vector<FixedMask> no_fixed(int n_vertices) {
  return std::vector<FixedMask>(static_cast<std::size_t>(n_vertices), FixedMask{0});
}
/// Every seventh vertex pinned, and single coordinates of others.
std::vector<FixedMask> some_fixed(int n_vertices);

std::vector<double> plain(const VecXd& v);

}  // namespace bb::exec
