// Inertia and weight: the masses of their vertices, and gravity at the end of a step.
#include "core/energy/families/loads.hpp"

#include <numeric>

#include "core/energy/families/families.hpp"
#include "core/energy/families/family_of.hpp"
#include "core/energy/families/inertia_weights.hpp"

namespace bb {
namespace {

std::vector<int> all_vertices(const Scene& scene) {
  std::vector<int> out(scene.mass.size());
  std::iota(out.begin(), out.end(), 0);
  return out;
}

class InertiaFamily final : public FamilyOf<InertiaOf<StoredWeight>> {
 public:
  InertiaFamily(const FamilyPlace& place, const Scene& scene)
      : FamilyOf(place, "inertia vertices", all_vertices(scene)), weights_(place.executor, scene.mass) {}
  void change_step(const FamilyStep& step) override {
    elements_.weight.of = weights_.of(step);
    elements_.x_tilde = step.x_tilde;
  }

 private:
  InertiaWeights weights_;
};

class WeightFamily final : public FamilyOf<WeightLoads> {
 public:
  WeightFamily(const FamilyPlace& place, const Scene& scene)
      : FamilyOf(place, "weight vertices", all_vertices(scene)),
        scene_(scene),
        mass_(place.executor, "weight masses") {
    mass_.upload(scene.mass);
    elements_.mass = mass_.data();
  }
  void change_step(const FamilyStep& step) override {
    elements_.set_step(step, gravity_at(scene_, step.t_end));
  }

 private:
  const Scene& scene_;
  exec::Buffer<double> mass_;
};

}  // namespace

MadeFamily inertia_family(const FamilyPlace& place, const Scene& scene) {
  return std::make_unique<InertiaFamily>(place, scene);
}
MadeFamily weight_family(const FamilyPlace& place, const Scene& scene) {
  return std::make_unique<WeightFamily>(place, scene);
}

}  // namespace bb
