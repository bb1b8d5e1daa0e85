// Condition numbers of a sparse symmetric matrix, by the estimators of the diagnose pass.
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>

#include "core/base/parameters/registry.hpp"
#include "core/linear/condition.hpp"
#include "core/math/error.hpp"
#include "python/src/bindings.hpp"

namespace bb::python {
namespace {

using Indices = nb::ndarray<const std::int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

/// The lower triangle with diagonal, compressed by columns; rows of a column ascend.
ReducedSystem system_of(const Indices& starts, const Indices& rows, const Column& values) {
  if (starts.shape(0) < 2) throw ConfigError("matrix", "no rows", "a square matrix");
  const auto n = static_cast<Eigen::Index>(starts.shape(0)) - 1;
  const auto nnz = static_cast<Eigen::Index>(values.shape(0));
  for (std::size_t k = 0; k < values.shape(0); ++k) {
    if (!std::isfinite(values(k)))
      throw ConfigError("matrix", "entry " + std::to_string(k) + " is not finite", "finite numbers");
  }
  ReducedSystem system;
  system.lower =
      Eigen::Map<const Eigen::SparseMatrix<double>>(n, n, nnz, starts.data(), rows.data(), values.data());
  for (int i = 0; i < static_cast<int>(n); i += 3) system.block_start.push_back(i);
  system.block_start.push_back(static_cast<int>(n));
  system.pattern_id = 1;
  return system;
}

auto condition(const Indices& starts, const Indices& rows, const Column& values, const std::string& scaling,
               int tier, std::uint64_t seed) {
  const ReducedSystem system = system_of(starts, rows, values);
  ConditionOptions options;
  if (tier < 1 || tier > 4) throw ConfigError("condition tier", std::to_string(tier), "1, 2, 3 or 4");
  options.estimator = static_cast<Estimator>(tier);
  options.seed = seed;
  bool known = false;
  for (const Scaling each : {Scaling::none, Scaling::jacobi, Scaling::block_jacobi}) {
    if (scaling == to_string(each)) options.scaling = each, known = true;
  }
  if (!known) throw unknown_name("scaling", scaling, {"none", "jacobi", "block_jacobi"});
  ConditionEstimate e;
  {
    const nb::gil_scoped_release unlocked;
    e = ConditionEstimator().estimate(system, options);
  }
  return std::make_tuple(e.cond, e.lambda_min, e.lambda_max, std::string(to_string(e.status)), e.method,
                         e.residual);
}

}  // namespace

void bind_condition(nb::module_& m) {
  m.def("condition", &condition, nb::arg("starts"), nb::arg("rows"), nb::arg("values"), nb::arg("scaling"),
        nb::arg("tier"), nb::arg("seed"), "cond, lambda_min, lambda_max, status, method, residual.");
}

}  // namespace bb::python
