// Repair of a start in which surfaces cross: a state near it in which nothing crosses and every pair has a gap. It knows
// no earlier state; exact signs alone decide whether a state is clean.
#pragma once

#include <string>

#include "experiments/start/start_report.hpp"
#include "experiments/start/tangle.hpp"

namespace bb {

struct RepairedStart {
  bool repaired = false;        // clean, and every pair has a positive gap
  Positions x;                  // [3 x n] m; the start itself where it could not be repaired
  std::string method;           // that led to it: none, separation, spread, contour, or obstacles
  int iterations = 0;           // of all methods together
  double largest = 0, rms = 0;  // displacement of vertices that can move, m
  double mass_norm = 0;         // sqrt(sum_v m_v |u_v|^2), kg^1/2 m
  double strain = 0;            // largest relative change of an edge
  double slack = 0;             // m, smallest gap over what pairs have to have
  StartReport left;             // what crosses or is near in the start, where it is not repaired
};

/// Methods (separation.hpp, contour.hpp) propose clean states; from each the least motion is sought
/// (least_motion), and of those the one with the least mass_norm is the answer.
/// Errors: ConfigError where prescribed primitives cross each other or an obstacle, naming them; for a planar scene.
RepairedStart untangle(const RunConfig& config, const Scene& scene, const RepairOptions& options);

/// From the clean state x towards the start: sequential quadratic programming, each subproblem
/// min sum_v m_v |y_v - start_v|^2 over the half-spaces of all near pairs and edge lengths at x, a shorter way where its
/// solution is not clean.
Positions least_motion(Tangle& tangle, const Positions& x, int& iterations);

}  // namespace bb
