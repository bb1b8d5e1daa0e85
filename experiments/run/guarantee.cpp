#include "experiments/run/guarantee.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/config/enum_words.hpp"
#include "experiments/run/collision_lines.hpp"

namespace bb {
namespace {

/// Of pairs that no motion is bounded for at first. Only solvers with a step bound refuse states by their
/// gaps.
std::string promise_of(CollisionKind kind, const StepSolverEntry& solver) {
  const bool judges_states = solver.needs.step_bound;
  switch (kind) {
    case CollisionKind::audited:
      return "no surface passes through another in the straight motion of a step from its start to its end; "
             "within a step they may, and a step for which that is not proven is done again as if the pair "
             "were ccd";
    case CollisionKind::static_test:
      return judges_states ? "no state of a step has the two surfaces intersect; what passes through as a "
                             "whole from one state "
                             "to the next is not seen"
                           : "none: the step solver accepts states in which they intersect";
    case CollisionKind::proximity:
      return "none: contact pushes where they are near, and they may pass through each other";
    default:
      return "none: contact does nothing between them, and they may pass through each other";
  }
}

std::string pairs_text(long n) { return fmt::format("{} {}", n, n == 1 ? "pair" : "pairs"); }

}  // namespace

namespace {

std::vector<Guarantee> of_pairs(const StepSolverEntry& solver, const Scene& scene) {
  const std::vector<CollisionLine> lines = collision_lines(scene);
  const auto count = [&lines](CollisionKind kind) {
    return std::count_if(lines.begin(), lines.end(),
                         [kind](const CollisionLine& line) { return line.kind == kind; });
  };
  const auto all = static_cast<long>(lines.size()), bounded = static_cast<long>(count(CollisionKind::ccd));
  if (bounded == all) return {{solver.name, solver.guarantee}};
  std::vector<Guarantee> out;
  if (bounded > 0) {
    out.push_back({fmt::format("{}, for {} of {} of bodies (ccd)", solver.name, bounded, pairs_text(all)),
                   solver.guarantee});
  } else {
    out.push_back({solver.name, "of contact what follows, since no pair of bodies collides as ccd"});
  }
  for (const CollisionKind kind :
       {CollisionKind::audited, CollisionKind::static_test, CollisionKind::proximity, CollisionKind::off}) {
    const auto n = static_cast<long>(count(kind));
    if (n > 0)
      out.push_back({fmt::format("{} ({})", pairs_text(n), word_of(kind)), promise_of(kind, solver)});
  }
  return out;
}

}  // namespace

std::vector<Guarantee> guarantees(const StepSolverEntry& solver, const Scene& scene, ContactModel model) {
  std::vector<Guarantee> out = of_pairs(solver, scene);
  if (model == ContactModel::points) {
    out.push_back({"points only",
                   "this holds for vertices at obstacles; edges and triangles between them may be in an "
                   "obstacle (the record reports how deep), and surfaces may pass through each other"});
  }
  return out;
}

}  // namespace bb
