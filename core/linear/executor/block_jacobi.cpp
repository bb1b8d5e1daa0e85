#include "core/linear/executor/block_jacobi.hpp"

#include "core/linear/executor/block_jacobi_kernels.hpp"

namespace bb::exec {

void BlockJacobi::setup(const ExecutorMatrix& matrix, const PcgVectors& v, std::uint64_t,
                        FactorFaults* faults) {
  const Index n = v.partition.n_rows;
  if (inverse_.size() != 6 * n) {
    inverse_.resize(6 * n);
    ++version_;
  }
  executor_.each(n, FactorizeDiagonal{matrix, v.fixed, n, inverse_.data(), faults});
}

void BlockJacobi::apply(const PcgVectors& v) {
  executor_.blocks(v.partition.n_blocks(),
                   ApplyBlockJacobi{v.partition, inverse_.data(), v.r, v.z, v.partial_rz, v.partial_rr});
}

void BlockJacobi::update(const PcgVectors& v, int k) {
  executor_.blocks(v.partition.n_blocks(),
                   UpdateBlockJacobi{v.partition, inverse_.data(), v.p, v.q, v.partial_pq, v.x, v.r, v.z,
                                     v.partial_rz, v.partial_rr, v.scalars, k});
}

}  // namespace bb::exec
