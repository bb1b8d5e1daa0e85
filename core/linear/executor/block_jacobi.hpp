// Block Jacobi on an executor.
#pragma once

#include "core/linear/executor/resident_preconditioner.hpp"

namespace bb::resident {

class BlockJacobi final : public ResidentPreconditioner {
 public:
  explicit BlockJacobi(exec::Executor& executor)
      : executor_(executor), inverse_(executor, "diagonal factors") {}
  void setup(const ResidentMatrix& matrix, const PcgVectors& v, std::uint64_t pattern_id,
             FactorFaults* faults) override;
  void apply(const PcgVectors& v) override;
  void update(const PcgVectors& v, int k) override;
  int version() const override { return version_; }
  std::string fault_text(Index number) const override { return "vertex " + std::to_string(number); }

 private:
  exec::Executor& executor_;
  exec::Buffer<double> inverse_;  // [6 n]
  int version_ = 0;
};

}  // namespace bb::resident
