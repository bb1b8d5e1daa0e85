// Inertia and weight: the masses of their vertices, and gravity at the end of a step.
#include "core/energy/families/loads.hpp"

#include <numeric>

#include "core/energy/families/families.hpp"

namespace bb {
namespace {

std::vector<int> all_vertices(const Scene& scene) {
  std::vector<int> out(scene.mass.size());
  std::iota(out.begin(), out.end(), 0);
  return out;
}

template <class Load>
class LoadFamily final : public FamilyOf<Load> {
  using Base = FamilyOf<Load>;
  using Base::elements_;

 public:
  LoadFamily(const FamilyPlace& place, const Scene& scene)
      : Base(place, "loaded vertices", all_vertices(scene)),
        scene_(scene),
        mass_(place.executor, "masses of loaded vertices") {
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
  return std::make_unique<LoadFamily<InertiaLoads>>(place, scene);
}
MadeFamily weight_family(const FamilyPlace& place, const Scene& scene) {
  return std::make_unique<LoadFamily<WeightLoads>>(place, scene);
}

}  // namespace bb
