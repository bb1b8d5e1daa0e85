// What files beside the record require of the rest of a config.
#include "core/step_solvers/registry.hpp"
#include "experiments/config/complain.hpp"
#include "experiments/config/enum_words.hpp"

namespace bb {
namespace {

/// Forces are those of the rows that a step solver on the processor solved last.
void check_forces(const RunConfig& config, const std::string& pointer, const Complain& complain) {
  const std::string& solver = config.step_solver.name;
  const StepSolverEntry* entry = step_solvers().find(solver);
  if (entry && !entry->has_forces) {
    complain(pointer, "true with the step solver " + solver + ", whose steps solve no rows with forces",
             "false, or one of the step solvers " + solvers_with_forces());
  }
  if (config.device != Device::cpu) {
    complain(pointer,
             "true with /device \"" + word_of(config.device) + "\", which keeps no rows on the processor",
             "false, or /device cpu");
  }
}

}  // namespace

void check_output(const RunConfig& config, const Complain& complain) {
  const OutputConfig& output = config.output;
  const auto check_frames = [&](const std::string& pointer) {
    if (output.frames_every == 0) complain(pointer, "true", "false without frames (frames_every > 0)");
  };
  if (output.friction_forces.value_or(false)) check_frames("/output/friction_forces");
  if (output.contact_forces.value_or(false)) {
    check_frames("/output/contact_forces");
    check_forces(config, "/output/contact_forces", complain);
  }
  if (output.pair_forces.value_or(false)) check_forces(config, "/output/pair_forces", complain);
  if (output.matrices && !config.passes.diagnose) {
    complain("/output/matrices", "true",
             "false, or passes.diagnose true: matrices are those of diagnosed iterations");
  }
}

}  // namespace bb
