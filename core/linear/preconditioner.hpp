// Preconditioners of conjugate gradients: z = M^-1 r, M symmetric positive definite or refused.
#pragma once

#include <memory>
#include <string_view>

#include "core/linear/linear_solver.hpp"
#include "core/linear/symmetric_product.hpp"

namespace bb {

class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  /// rows holds the same matrix as system. @return ok, or why there is no M.
  virtual LinearStatus setup(const ReducedSystem& system, const SymmetricProduct& rows) = 0;
  /// z = M^-1 r; z is resized. Deterministic for any thread count.
  virtual void apply(const VecXd& r, VecXd& z) const = 0;
  virtual int shifts() const { return 0; }    // retries after a breakdown
  virtual double shift() const { return 0; }  // relative diagonal shift in use
};

/// Errors: ConfigError for an unknown name, listing the known ones.
std::unique_ptr<Preconditioner> make_preconditioner(std::string_view name);

}  // namespace bb
