// Preconditioners of conjugate gradients: z = M^-1 r, M symmetric positive definite or refused.
#pragma once

#include <memory>
#include <string>
#include <vector>

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
  /// Whether setup() reads ReducedSystem::mesh where there is one.
  virtual bool wants_mesh() const { return false; }
  /// What earlier matrices decide of M for later ones.
  virtual void keep(Archive&) {}
  /// What about the matrix made setup() fail, where that is known.
  virtual std::string detail() const { return {}; }
  virtual int shifts() const { return 0; }    // retries after a breakdown
  virtual double shift() const { return 0; }  // relative diagonal shift in use
};

struct PreconditionerEntry {
  std::string name, doc;
  std::vector<Parameter> parameters;  // its own, with defaults
  std::unique_ptr<Preconditioner> (*make)(const ParameterMap& complete) = nullptr;
};
const Registry<PreconditionerEntry>& preconditioners();
/// Errors: ConfigError for an unknown name and for what own_parameters refuses.
std::unique_ptr<Preconditioner> make_preconditioner(const std::string& name,
                                                    const ParameterMap& parameters = {});

}  // namespace bb
