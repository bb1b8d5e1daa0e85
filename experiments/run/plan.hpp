// The plan of a config: the scene's needs and the options' together.
#pragma once

#include "core/scene/plan.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

Plan plan_of(const RunConfig& config, const Scene& scene);

}  // namespace bb
