// Rods that bend: their columns.
#include "core/energy/families/rods.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"

namespace bb {
namespace {

class RodFamily final : public FamilyOf<Rods> {
 public:
  RodFamily(const FamilyPlace& place, const RodPart& part)
      : FamilyOf(place, "rod vertices", std::span(part.corners)),
        stiffness_(place.executor, "rod stiffness"),
        rest_angle_(place.executor, "rod rest angles") {
    stiffness_.upload(part.stiffness);
    rest_angle_.upload(part.rest_angle);
    elements_.stiffness = stiffness_.data();
    elements_.rest_angle = rest_angle_.data();
  }

 private:
  exec::Buffer<double> stiffness_, rest_angle_;
};

}  // namespace

MadeFamily rod_family(const FamilyPlace& place, const RodPart& part) {
  check_column("rods/stiffness", part.corners.size(), part.stiffness, false);
  check_column("rods/rest_angle", part.corners.size(), part.rest_angle, false);
  return std::make_unique<RodFamily>(place, part);
}

}  // namespace bb
