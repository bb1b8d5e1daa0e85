// A preconditioner whose data and kernels are the executor's: z = M^-1 r, M symmetric positive definite or refused.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/base/parameters/parameter.hpp"
#include "core/exec/buffer.hpp"
#include "core/linear/executor/pcg_scalars.hpp"

namespace bb::exec {

/// The vectors and sums of an iteration that a preconditioner reads and writes.
struct PcgVectors {
  Partition partition;
  const FixedMask* fixed;
  double *x, *r, *z, *p, *q;                     // [3 n]
  double *partial_pq, *partial_rz, *partial_rr;  // [n_blocks]
  PcgScalars* scalars;
  bool operator==(const PcgVectors&) const = default;
};

class ExecutorPreconditioner {
 public:
  virtual ~ExecutorPreconditioner() = default;
  /// Makes M; what has no factor is written to faults. pattern_id changes when the pattern of the matrix or what is fixed
  /// does; 0: unknown.
  virtual void setup(const ExecutorMatrix& matrix, const PcgVectors& v, std::uint64_t pattern_id,
                     FactorFaults* faults) = 0;
  /// z = M^-1 r and the partial sums of r^T z; those of r^T r are there.
  virtual void apply(const PcgVectors& v) = 0;
  /// x += alpha p, r -= alpha q, then as apply(); nothing where the run is over. k: number in the graph.
  virtual void update(const PcgVectors& v, int k) = 0;
  /// Changes when arguments of launches do: a graph of them is void then.
  virtual int version() const = 0;
  /// What earlier matrices decide of M for later ones.
  virtual void keep(Archive&) {}
  /// "vertex 17", or what else FactorFaults counts.
  virtual std::string fault_text(Index number) const = 0;
};

/// resident_preconditioner and resident_cluster_vertices.
std::vector<Parameter> preconditioner_parameters();
/// Of complete parameters. Where nothing is computed block Jacobi stands for all: clusters are made from the matrix.
std::unique_ptr<ExecutorPreconditioner> make_preconditioner(Executor& executor,
                                                            const ParameterMap& parameters);

}  // namespace bb::exec
