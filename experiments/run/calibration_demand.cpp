#include "experiments/run/calibration_demand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/contact/pair_name.hpp"
#include "core/energy/families/limit_family.hpp"
#include "core/exec/host_executor.hpp"
#include "core/math/error.hpp"
#include "core/terms/strain_limit.hpp"
#include "experiments/run/calibration_replay.hpp"

namespace bb {
namespace {

/// Beyond this ratio a policy gives a contact no stiffness of its own: rounding has made its number.
constexpr double largest_demand = 1e9;

bool too_soft(double own, double matched) { return !(own > 0) || !(matched / own <= largest_demand); }

/// The answer of one force of a step; what was left out is counted.
bool is_load(double answer, double load, int step, const std::function<std::string()>& where, Demand& out) {
  if (answer <= largest_load_answer) return true;
  ++out.left_out;
  if (load > out.left_out_load) {
    out.left_out_load = load;
    out.left_out_step = step;
    out.left_out_where = where();
  }
  return false;
}

/// own = 1 without a policy. Returns whether this is the largest demand so far; among equals the larger load.
bool compare(double matched, double own, double load, double width, double answer, int step, Demand& out) {
  ++out.considered;
  const double demand = matched / own;
  if (demand < out.largest || (demand == out.largest && load <= out.load)) return false;
  out.largest = demand;
  out.load = load;
  out.width = width;
  out.answer = answer;
  out.step = step;
  return true;
}

[[noreturn]] void refuse(double own, const char* what, int step, const std::string& where) {
  throw ConfigError("matching",
                    fmt::format("{} = {} at {}, which carries a load in step {} of the calibration run", what,
                                own, where, step),
                    "a stiffness > 0 there, or matching rule as_given");
}

/// kappa of this row by the policy, the smaller of its values at d_hat and at u d_hat.
double own_kappa(const StiffnessPolicy& policy, int row, double u, double dt, double c,
                 CalibrationReplay& replay) {
  static const BlockSystem::Values no_hessian;
  const bool with_hessian = policy.needs_hessian();
  PolicyColumns columns = replay.contact().stiffness().columns(replay.rows(), row, replay.blocks(),
                                                               with_hessian ? replay.elastic() : no_hessian);
  double kappa[2];
  for (int k = 0; k < 2; ++k) {
    columns.d[0] = (k == 0 ? 1 : u) * columns.d_hat[0];
    policy.fill(columns.batch({dt, c}, with_hessian), &kappa[k]);
  }
  return std::min(kappa[0], kappa[1]);
}

void look_up(const RunLimits& limits, const CalibrationRun& calibration_run, int step) {
  limits.look_up("calibration run", fmt::format("while the loads of its step {} of {} were compared", step,
                                                calibration_run.steps()));
}

std::string name_element(const Scene& scene, std::size_t e) {
  std::string out = fmt::format("limited triangle {}", e);
  const char* separator = ": ";
  for (const int v : scene.limit.triangles[e]) {
    const Body& body = scene.bodies[static_cast<std::size_t>(scene.body[static_cast<std::size_t>(v)])];
    out += fmt::format("{}{}[{}]", separator, body.name, v - body.first_vertex);
    separator = ", ";
  }
  return out;
}

/// kappa_e (J) of all elements by the policy of the limit, with w from the start of the step, at these pseudo-gaps.
std::vector<double> own_limit_kappa(const StiffnessPolicy& policy, const Scene& scene, LimitFamily& limit,
                                    std::span<const double> gaps, int step, double dt,
                                    const CalibrationReplay& replay) {
  ElasticMatrix elastic;
  std::vector<double> gathered;
  if (policy.needs_hessian()) elastic = gather_elastic(limit, replay.blocks(), replay.elastic(), gathered);
  return limit.kappa_at(gaps, policy,
                        {{dt, replay.c(step)}, replay.start(step).data(), scene.mass.data(), elastic});
}

/// The pseudo-gaps at which it is evaluated: a frozen number may be that of the step's start.
std::vector<double> softest_gaps(const StiffnessPolicy& policy, const StrainLimitPart& part,
                                 std::span<const double> at_start) {
  std::vector<double> out = part.width;
  if (!policy.frozen_in_step() || policy.has_potential()) return out;
  for (std::size_t e = 0; e < out.size(); ++e) out[e] = std::max(out[e], at_start[e]);
  return out;
}

}  // namespace

Demand contact_demand(const CalibrationRun& calibration_run, const Scene& scene,
                      const MatchedStiffness& matched, const StiffnessPolicy* own, double u,
                      const RunLimits& limits) {
  const BarrierFunction log = log_barrier();
  const double dt = calibration_run.config.time.dt;
  CalibrationReplay replay(calibration_run, scene);
  Demand out;
  for (int step = 0; step < calibration_run.steps(); ++step) {
    look_up(limits, calibration_run, step);
    if (own) {
      replay.find_rows(step, own->refresh());
    } else {
      replay.find_rows(step);
    }
    const ContactTable& rows = replay.rows();
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const double load = -*calibration_run.stiffness.kappa * log.eval(rows.d[r], rows.d_hat[r]).db;
      if (!(load > 0)) continue;
      const auto where = [&] { return pair_name(scene, rows.key(r), rows.kind[r]); };
      const double answer = calibration_run.answers.of_contact(rows, r);
      if (!is_load(answer, load, step, where, out)) continue;
      const double kappa = own ? own_kappa(*own, static_cast<int>(r), u, dt, replay.c(step), replay) : 1;
      const double wanted = matched(load, rows.d_hat[r]);
      if (own && too_soft(kappa, wanted)) refuse(kappa, "kappa", step, where());
      if (compare(wanted, kappa, load, rows.d_hat[r], answer, step, out)) out.where = where();
    }
  }
  return out;
}

Demand limit_demand(const CalibrationRun& calibration_run, const Scene& scene,
                    const MatchedStiffness& matched, const StiffnessPolicy* own, const RunLimits& limits) {
  const BarrierFunction log = log_barrier();
  const StrainLimitPart& part = scene.limit;
  exec::HostExecutor executor;
  const auto limit = limited_triangles({executor}, part, scene.rest, scene.planar);
  const double dt = calibration_run.config.time.dt;
  CalibrationReplay replay(calibration_run, scene);
  Demand out;
  for (int step = 0; step < calibration_run.steps(); ++step) {
    look_up(limits, calibration_run, step);
    std::vector<double> kappa;
    if (own) {
      replay.find_rows(step, own->refresh());
      const std::vector<double> at_start = limit->smallest_gaps(replay.start(step).data());
      kappa = own_limit_kappa(*own, scene, *limit, softest_gaps(*own, part, at_start), step, dt, replay);
    }
    const std::vector<double> at_end = limit->smallest_gaps(replay.end(step).data());
    for (std::size_t e = 0; e < at_end.size(); ++e) {
      const double y = at_end[e], width = part.width[e];
      if (!(y < width)) continue;
      const double area = limit->measure_of(e);
      const double load = -(*calibration_run.stiffness.k_s * area) * log.eval(y, width).db / area;
      if (!(load > 0)) continue;
      const auto where = [&] { return name_element(scene, e); };
      const double answer = calibration_run.answers.of_limit(e);
      if (!is_load(answer, load, step, where, out)) continue;
      double k_s = 1;
      if (own) {
        k_s = kappa[e] / area;
        if (too_soft(k_s, matched(load, width))) refuse(k_s * area, "kappa_e", step, where());
      }
      if (compare(matched(load, width), k_s, load, width, answer, step, out)) out.where = where();
    }
  }
  return out;
}

}  // namespace bb
