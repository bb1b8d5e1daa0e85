#include "core/linear/preconditioner.hpp"

#include <string>

#include "core/linear/block_scaling.hpp"
#include "core/linear/ic0.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

/// none, jacobi and block_jacobi: M = D = L L^T.
class Scaled final : public Preconditioner {
 public:
  explicit Scaled(Scaling scaling) : kind_(scaling) {}
  LinearStatus setup(const ReducedSystem& system, const SymmetricProduct&) override {
    return scaling_.setup(system, kind_);
  }
  void apply(const VecXd& r, VecXd& z) const override {
    z = r;
    scaling_.solve_lower(z);
    scaling_.solve_upper(z);
  }

 private:
  Scaling kind_;
  BlockScaling scaling_;
};

}  // namespace

const std::vector<std::string_view>& preconditioners() {
  static const std::vector<std::string_view> names = {"none", "jacobi", "block_jacobi", "ic0"};
  return names;
}

std::unique_ptr<Preconditioner> make_preconditioner(std::string_view name) {
  for (const Scaling scaling : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
    if (name == to_string(scaling)) return std::make_unique<Scaled>(scaling);
  }
  if (name == "ic0") return std::make_unique<Ic0>();
  std::string list;
  for (const std::string_view known : preconditioners())
    list += (list.empty() ? "" : ", ") + std::string(known);
  throw ConfigError("/linear_solver/preconditioner", '"' + std::string(name) + '"',
                    "one of " + list + did_you_mean(name, preconditioners()));
}

}  // namespace bb
