// Rods that bend: their columns, and rest angles that move.
#include "core/energy/families/rods.hpp"

#include <fmt/format.h>

#include "core/energy/element_loop.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"

namespace bb {
namespace {

class RodFamily final : public FamilyOf<Rods> {
 public:
  RodFamily(const FamilyPlace& place, const RodPart& part, MovingRest rest)
      : FamilyOf(place, "rod vertices", std::span(part.corners)),
        part_(part),
        rest_(std::move(rest)),
        stiffness_(place.executor, "rod stiffness"),
        rest_angle_(place.executor, "rod rest angles") {
    stiffness_.upload(part.stiffness);
    rest_angle_.upload(part.rest_angle);
    elements_.stiffness = stiffness_.data();
    elements_.rest_angle = rest_angle_.data();
    place_angles(0);
  }
  void change_step(const FamilyStep& step) override { place_angles(step.t_end); }

 private:
  void place_angles(double t) {
    if (!rest_.move(t)) return;
    const Positions& x = rest_.now();
    std::vector<double> angle = part_.rest_angle;
    for (std::size_t e = 0; e < angle.size(); ++e) {
      if (part_.straight[e] != 0) continue;
      const auto& [a, v, b] = part_.corners[e];
      const Vec3d along = x.col(v) - x.col(a), on = x.col(b) - x.col(v);
      if (!can_rest(along, on)) {
        throw ConfigError(
            "rest_film",
            fmt::format("a rod that folds back, or has no length, at the scene's vertex {} at {:g} s", v, t),
            "edges longer than 0 m at less than pi to each other");
      }
      angle[e] = rod_rest_angle(along, on);
    }
    rest_angle_.upload(angle);
  }

  const RodPart& part_;
  MovingRest rest_;
  exec::Buffer<double> stiffness_, rest_angle_;
};

}  // namespace

MadeFamily rod_family(const FamilyPlace& place, const RodPart& part, MovingRest rest) {
  check_column("rods/stiffness", part.corners.size(), part.stiffness, false);
  check_column("rods/rest_angle", part.corners.size(), part.rest_angle, false);
  return std::make_unique<RodFamily>(place, part, std::move(rest));
}

}  // namespace bb
