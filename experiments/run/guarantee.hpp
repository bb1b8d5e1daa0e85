// What a run's step solver guarantees against surfaces that pass through each other, pair of bodies by pair of bodies.
#pragma once

#include <string>
#include <vector>

#include "core/contact/offset_blocks.hpp"
#include "core/model/scene/scene.hpp"
#include "core/newton/step_solver.hpp"

namespace bb {

struct Guarantee {
  std::string of;    // the step solver, or pairs of one kind
  std::string text;  // what holds of them
};

/// One entry where every pair of bodies collides as `ccd`; else the step solver's of those that do, then one a kind that bounds less.
/// Of the contact model points an entry more, which reports what is not constrained. Cost: O(owners^2) where the scene chooses.
std::vector<Guarantee> guarantees(const StepSolverEntry& solver, const Scene& scene, ContactModel model);

}  // namespace bb
