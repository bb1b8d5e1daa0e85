// The preconditioners that are a block diagonal: none, jacobi and block_jacobi.
#include "core/linear/block_scaling.hpp"
#include "core/linear/block_starts.hpp"
#include "core/linear/preconditioner.hpp"

namespace bb {
namespace {

/// M = D = L L^T.
class Scaled final : public Preconditioner {
 public:
  explicit Scaled(Scaling scaling) : kind_(scaling) {}
  LinearStatus setup(const ReducedSystem& system, const SymmetricProduct&) override {
    const LinearStatus status = scaling_.setup(system, kind_);
    const bool singular = status == LinearStatus::preconditioner_indefinite;
    detail_ = singular ? bad_diagonal_text(system, scaling_.bad_dof()) + std::string(to_string(kind_)) +
                             " needs positive definite ones"
                       : "";
    return status;
  }
  std::string detail() const override { return detail_; }
  void apply(const VecXd& r, VecXd& z) const override { scaling_.solve(r, z); }

 private:
  Scaling kind_;
  BlockScaling scaling_;
  std::string detail_;
};

template <Scaling scaling>
PreconditionerEntry scaled() {
  PreconditionerEntry entry;
  entry.make = [](const ParameterMap&) -> std::unique_ptr<Preconditioner> {
    return std::make_unique<Scaled>(scaling);
  };
  return entry;
}

}  // namespace

PreconditionerEntry preconditioner_none() { return scaled<Scaling::none>(); }
PreconditionerEntry preconditioner_jacobi() { return scaled<Scaling::jacobi>(); }
PreconditionerEntry preconditioner_block_jacobi() { return scaled<Scaling::block_jacobi>(); }

}  // namespace bb
