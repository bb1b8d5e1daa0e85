#include "experiments/run/matrix_dump.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "core/base/record/build_info.hpp"

namespace bb {
namespace {

double value_or_nan(const Number& v) {
  return v.finite() ? v.value : std::numeric_limits<double>::quiet_NaN();
}

/// With "-dirty" when the sources had changed since.
std::string commit() { return std::string(kBuildInfo.git_commit) + (kBuildInfo.git_dirty ? "-dirty" : ""); }

/// Of the clamped, unscaled matrix; one without a cond counts with the largest.
std::optional<double> cond_of(const std::vector<ConditionSample>& samples, MatrixStage stage) {
  for (const ConditionSample& s : samples) {
    if (s.matrix != MatrixForm::clamped || s.stage != stage || s.scaling != Scaling::none) continue;
    return s.cond.finite() ? s.cond.value : largest_known_cond;
  }
  return std::nullopt;
}

}  // namespace

std::string cause_of(const std::vector<ConditionSample>& samples, const std::vector<std::string>& stages) {
  constexpr double much = 10;
  const auto asked = [&](MatrixStage stage) {
    return std::find(stages.begin(), stages.end(), to_string(stage)) != stages.end();
  };
  const bool contact = asked(MatrixStage::without_contact),
             limit = asked(MatrixStage::without_contact_and_limit);
  const std::optional<double> full = cond_of(samples, MatrixStage::full);
  if (!full || (!contact && !limit)) return {};
  const double without_contact = cond_of(samples, MatrixStage::without_contact).value_or(*full);
  const double without_both =
      cond_of(samples, MatrixStage::without_contact_and_limit).value_or(without_contact);
  if (contact && *full > much * without_contact) return "contact";
  if (limit && without_contact > much * without_both)
    return contact ? "strain_limit" : "contact_or_strain_limit";
  return "elasticity_and_inertia";
}

StoredSystem stored_system(Diagnosis& system, const ReducedSystem& matrix, const std::string& form,
                           const RunConfig& config, int step, int iteration,
                           const std::vector<ConditionSample>& samples) {
  StoredSystem out;
  out.system = matrix;
  out.rhs = system.rhs();
  for (const int v : matrix.block_vertex) out.coordinates.push_back(system.x().col(v));
  out.origin = {config.scene.name,
                label_of(config.formulation),
                config.integrator.name,
                commit(),
                config.time.dt,
                step,
                iteration,
                form,
                cause_of(samples, config.diagnose.stages)};
  for (const ConditionSample& s : samples) {
    if (s.stage != MatrixStage::full || to_string(s.matrix) != form) continue;
    out.cond.push_back({s.scaling, s.tier, s.status, value_or_nan(s.cond), value_or_nan(s.lambda_min),
                        value_or_nan(s.lambda_max)});
  }
  return out;
}

}  // namespace bb
