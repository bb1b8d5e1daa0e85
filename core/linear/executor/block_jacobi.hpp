// Block Jacobi on an executor.
#pragma once

#include "core/linear/executor/executor_preconditioner.hpp"

namespace bb::exec {

class BlockJacobi final : public ExecutorPreconditioner {
 public:
  explicit BlockJacobi(Executor& executor) : executor_(executor), inverse_(executor, "diagonal factors") {}
  void setup(const ExecutorMatrix& matrix, const PcgVectors& v, std::uint64_t pattern_id,
             FactorFaults* faults) override;
  void apply(const PcgVectors& v) override;
  void update(const PcgVectors& v, int k) override;
  int version() const override { return version_; }
  std::string fault_text(Index number) const override { return "vertex " + std::to_string(number); }

 private:
  Executor& executor_;
  Buffer<double> inverse_;  // [6 n]
  int version_ = 0;
};

}  // namespace bb::exec
