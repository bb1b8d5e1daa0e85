// What a run needs of a device's memory, counted by the code that would allocate it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/model/scene/scene.hpp"
#include "core/terms/plan.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// How many contacts are expected of a scene; 0 contacts: those of the start where they are at least one a
/// vertex, else estimated. What each of them has beside it was measured on eight layers of cloth with a mesh of
/// half d_hat (results/gpu_model_inputs.json, dense_patch).
struct ContactDemand {
  double contacts = 0;
  double upper_blocks_a_contact = 1.738;
  double candidates_a_contact = 6.145;
};

struct DeviceMemory {
  double contacts = 0;
  std::string source;                                        // where their number is from
  std::vector<std::pair<std::string, std::size_t>> buffers;  // at the peak, largest first
  std::size_t total = 0;
  double bytes_a_row = 0;  // of one table of contact rows
  double bytes_a_contact() const { return contacts > 0 ? static_cast<double>(total) / contacts : 0; }
};

/// Rows of every surface vertex when each sheet lies on one other at half its activation distance: triangles in
/// reach of the vertices of both, and edges in reach of the edges.
double estimated_contacts(const Scene& scene);

/// Runs the stages of a step on an executor that counts buffers. Errors: ConfigError for what has no device form.
/// Cost: what a run does before its first step.
DeviceMemory count_device_memory(const RunConfig& config, const Scene& scene, const Plan& plan,
                                 const ContactDemand& demand);

}  // namespace bb
