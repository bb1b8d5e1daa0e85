// Where prescribed primitives cross each other along their motions, whatever the solver does.
#pragma once

#include <string>
#include <vector>

#include "core/model/scene/scene.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/run/run_limits.hpp"

namespace bb {

struct PrescribedCrossing {
  int step = 0;           // in which they cross
  double t0 = 0, t1 = 0;  // s, of its start and end
  std::string pair;       // "edge arm[3 4] crosses triangle body[0 1 2]"
};

/// Up to `most` of them: the first pair of every step that has one, of steps next to each other with the same pair the first. Motions are
/// followed as a run follows them, straight from the pose at the start of a step to that at its end, for `steps` steps or until the
/// last motion has ended.
/// Errors: Interrupted; TimeOver.
/// Cost: one audit of the prescribed surface a step, where prescribed bodies change shape, or move relative to each other or to an
/// obstacle; of rigid bodies only what comes near another is looked at.
std::vector<PrescribedCrossing> prescribed_crossings(const RunConfig& config, const Scene& scene, int steps,
                                                     std::size_t most, const RunLimits& limits = {});

/// So many steps until the last motion has ended, no motion without an end counted.
int steps_of_motions(const Scene& scene, double dt);

}  // namespace bb
