#include "experiments/start/untangle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/audit/state_audit.hpp"
#include "core/math/error.hpp"
#include "core/math/stop_request.hpp"
#include "experiments/run/audit_verdict.hpp"
#include "experiments/start/contour.hpp"
#include "experiments/start/separation.hpp"

namespace bb {
namespace {

constexpr std::size_t most_ranks = 6;  // shifts of the first pair from which a least motion is sought
constexpr int most_sweeps = 400;
constexpr double shortest_part = 1.0 / 512;  // of the way to the start that is tried
constexpr double enough = 1e-6;              // relative change of the cost at which a least motion is over

void refuse_prescribed(const RunConfig& config, const Tangle& tangle) {
  std::vector<Violation> violations;
  for (const audit::PairName& pair : audit::all_crossings(tangle.mesh, tangle.start())) {
    const std::vector<int> vertices = vertices_of(tangle.mesh, pair);
    const bool held = std::all_of(vertices.begin(), vertices.end(), [&](int v) {
      return tangle.inverse_mass[static_cast<std::size_t>(v)] == 0;
    });
    if (!held) continue;
    violations.push_back({config.source + "#/scene",
                          fmt::format("{}, all of it prescribed", describe(tangle.scene, tangle.mesh, pair)),
                          "crossings that end without a motion of pins"});
  }
  if (!violations.empty()) throw ConfigError(std::move(violations));
}

/// How a state is judged: by its slack as long as that is negative, then by its cost.
struct Merit {
  double slack = 0, cost = 0;
  bool better_than(const Merit& other, double wanted) const {
    if (slack < wanted && other.slack < wanted) return slack > other.slack;
    if (slack < wanted || other.slack < wanted) return slack >= wanted;
    return cost < other.cost;
  }
};

/// Vertices beyond obstacles to their allowed side, lengths kept; the other pairs are not looked at.
Positions out_of_obstacles(Tangle& tangle) {
  Positions x = tangle.start();
  for (int k = 0; k < 8; ++k) {
    std::vector<HalfSpace> sides = tangle.sides(x, x);
    x = nearest_point(tangle.start(), sides, tangle.inverse_mass, 1e-9 * tangle.mean_edge(), most_sweeps);
  }
  return x;
}

void measure(const Tangle& tangle, RepairedStart& out) {
  const Positions u = out.x - tangle.start();
  double sum = 0;
  int n = 0;
  for (Eigen::Index v = 0; v < u.cols(); ++v) {
    if (tangle.inverse_mass[static_cast<std::size_t>(v)] == 0) continue;
    sum += u.col(v).squaredNorm(), ++n;
  }
  out.largest = u.colwise().norm().maxCoeff();
  out.rms = n > 0 ? std::sqrt(sum / n) : 0;
  out.mass_norm = std::sqrt(tangle.cost(out.x));
  out.strain = tangle.strain(out.x);
}

/// Keeps the better of the answer so far and the least motion from a proposal.
void consider(Tangle& tangle, const std::optional<Positions>& proposal, const char* method,
              RepairedStart& out) {
  heed_stop();
  if (!proposal || !tangle.clean(*proposal)) return;
  const Positions x = least_motion(tangle, *proposal, out.iterations);
  if (!tangle.apart(x) || !tangle.clean(x)) return;
  if (out.repaired && tangle.cost(x) >= tangle.cost(out.x)) return;
  out.repaired = true, out.x = x, out.method = method, out.slack = tangle.slack(x);
}

}  // namespace

Positions least_motion(Tangle& tangle, const Positions& from, int& iterations) {
  Positions x = from;
  const double wanted = -1e-6 * tangle.widest_gap();
  Merit best{tangle.slack(x), tangle.cost(x)};
  double part = 1;
  for (int k = 0; k < tangle.options.most_iterations && part >= shortest_part; ++k, ++iterations) {
    heed_stop();
    const Positions target = x + part * (tangle.start() - x);
    const Positions y = nearest_point(target, tangle.sides(x, target), tangle.inverse_mass,
                                      1e-3 * tangle.widest_gap(), most_sweeps);
    const Merit merit{tangle.slack(y), tangle.cost(y)};
    const bool lengths = tangle.strain(y) <= std::max(1.05 * tangle.options.stretch, tangle.strain(x));
    if (!lengths || !merit.better_than(best, wanted) || !tangle.clean(y)) {
      part /= 2;
      continue;
    }
    const bool over = best.slack >= wanted && best.cost - merit.cost <= enough * best.cost;
    x = y, best = merit;
    if (over) break;
    part = std::min(1.0, 2 * part);
  }
  return x;
}

RepairedStart untangle(const RunConfig& config, const Scene& scene, const RepairOptions& options) {
  if (scene.planar) {
    throw ConfigError(config.source + "#/scene/planar", "a planar scene", "a scene in space");
  }
  Tangle tangle(config, scene, options);
  refuse_prescribed(config, tangle);
  RepairedStart out;
  out.x = tangle.start();
  consider(tangle, tangle.start(), "none", out);
  if (!out.repaired) {
    consider(tangle, out_of_obstacles(tangle), "obstacles", out);
    for (std::size_t rank = 0; rank < most_ranks; ++rank) {
      const auto proposal = separate(tangle, rank);
      if (!proposal) break;
      consider(tangle, proposal, "separation", out);
    }
    consider(tangle, shorten_contours(tangle, out.iterations), "contour", out);
    if (!out.repaired) consider(tangle, spread_out(tangle), "spread", out);
  }
  measure(tangle, out);
  if (!out.repaired) out.left = report_start(config, scene, tangle.mesh, out.x);
  return out;
}

}  // namespace bb
