// The scene of a step where pins hold for a time.
#pragma once

#include <optional>
#include <vector>

#include "core/model/scene/scene.hpp"

namespace bb {

/// A scene as it is while some of its pins hold and no other, as if it were so for the whole run: what is held has no mass. Where
/// all pins hold always it is the scene itself, and nothing is copied.
class HeldScene {
 public:
  /// The scene must outlive it. The pins of a step whose middle is at that time (s) hold.
  HeldScene(const Scene& scene, double middle) : scene_(scene) {
    for (const Pin& pin : scene.pins) changes_ = changes_ || !pin.span.always();
    if (changes_) hold(holding_pins(scene, middle));
  }
  HeldScene(const HeldScene&) = delete;
  HeldScene& operator=(const HeldScene&) = delete;

  /// Whether which pins hold depends on the step.
  bool changes() const { return changes_; }
  /// The pins that hold now, as indices into those of the scene, ascending; where it changes() alone.
  const std::vector<int>& holding() const { return holding_; }
  const Scene& now() const { return held_ ? *held_ : scene_; }
  /// Others hold from now on. What refers to now() must be gone. Requires changes().
  void hold(std::vector<int> holding) {
    holding_ = std::move(holding);
    held_ = held_scene(scene_, holding_);
  }

 private:
  const Scene& scene_;
  bool changes_ = false;
  std::vector<int> holding_;
  std::optional<Scene> held_;
};

}  // namespace bb
