// The exact audit of a trajectory: every frame as a state, and the straight line from each frame to the next as a motion.
#pragma once

#include <iosfwd>

#include "experiments/judge/subject.hpp"

namespace bb::judge {

struct Answer {
  bool clean =
      false;  // nothing crosses in any frame, nothing passed between frames, and all of it was judged
};

/// Writes one JSON object a line: one for each frame as soon as it is judged, then one with `total`.
/// Of a frame: crossings, touches and what is beyond obstacles in it, the deepest and the first pair by name, smallest
/// gaps, and of the motion that led to it: certified, passages (proven on the straight line; a program's own path
/// between its frames is not known), unproven; vertices that are inside a closed body, and those that changed sides of
/// one since the frame before: these passed through it on whatever path.
/// Where materials are given: elastic energies, and the work that the given vertices do against elastic forces.
/// Errors: ConfigError from the stream, and when it holds no frame. Cost: a state's audit, a motion's and two gaps a
/// frame; O(vertices + primitives) memory.
Answer judge(const Subject& subject, std::istream& frames, std::ostream& out);

}  // namespace bb::judge
